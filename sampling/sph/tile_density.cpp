#include "sampling/sph/tile_density.h"

#include <algorithm>
#include <cassert>

#include "sampling/sph/cells.h"

namespace abn::sph {

TileLayout lay_out_tiles(const SizeField& field) {
  assert(!field.uniform);
  const auto along = [](double length, std::uint32_t cells, std::vector<std::uint32_t>& tile_of) {
    const auto tiles = static_cast<std::uint32_t>(Cells<float>::tile_count(length));
    const std::uint32_t count = cells * std::max(1U, (4 * tiles + cells - 1) / cells);
    tile_of.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      tile_of[i] = static_cast<std::uint32_t>(wrap((i + 0.5) / count + 0.5 / cells, 1.0) * tiles);
    }
    return tiles;
  };
  TileLayout layout;
  layout.tiles_x = along(field.length_x, field.width, layout.tile_of_column);
  layout.tiles_y = along(field.length_y, field.height, layout.tile_of_row);
  return layout;
}

std::vector<double> tile_densities(const SizeField& field) {
  const TileLayout layout = lay_out_tiles(field);
  const auto width = static_cast<std::uint32_t>(layout.tile_of_column.size());
  const auto height = static_cast<std::uint32_t>(layout.tile_of_row.size());
  const TileRectangles rectangles{field.view<double>(), width, height};
  std::vector<double> density(std::size_t{layout.tiles_x} * layout.tiles_y, 0);
  std::vector<double> samples(density.size(), 0);
  std::vector<double> above(width + 1, 0);  // s along the upper sides of a row of rectangles
  std::vector<double> below(width + 1, 0);
  for (std::uint32_t x = 0; x <= width; ++x) above[x] = rectangles.corner(x, 0);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x <= width; ++x) below[x] = rectangles.corner(x, y + 1);
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::size_t tile = std::size_t{layout.tile_of_row[y]} * layout.tiles_x + layout.tile_of_column[x];
      density[tile] += mean_inverse_square(above[x], above[x + 1], below[x], below[x + 1]);
      samples[tile] += 1;
    }
    above.swap(below);
  }
  for (std::size_t t = 0; t < density.size(); ++t) density[t] /= samples[t];
  return density;
}

}  // namespace abn::sph
