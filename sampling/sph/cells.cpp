#include "sampling/sph/cells.h"

#include <array>
#include <cassert>

namespace abn::sph {
namespace {

std::int32_t fit(double count) { return static_cast<std::int32_t>(std::clamp(count, 1.0, double{1 << 30})); }

}  // namespace

template <class Real>
std::int32_t Cells<Real>::tile_count(double length, double tile_length) {
  return fit(std::round(length / tile_length));
}

template <class Real>
Cells<Real>::Cells(double length_x, double length_y, double support)
    : Cells(length_x, length_y, support, 1, 1, std::array{1.0}) {}

template <class Real>
Cells<Real>::Cells(double length_x, double length_y, double support, std::int32_t tiles_x, std::int32_t tiles_y,
                   std::span<const double> density) {
  view_.length_x = static_cast<Real>(length_x);
  view_.length_y = static_cast<Real>(length_y);
  view_.tiles_x = tiles_x;
  view_.tiles_y = tiles_y;
  view_.tiles_per_x = static_cast<Real>(tiles_x / length_x);
  view_.tiles_per_y = static_cast<Real>(tiles_y / length_y);
  const double tile_width = length_x / tiles_x;
  const double tile_height = length_y / tiles_y;
  for (std::int32_t row = 0; row < tiles_y; ++row) {
    for (std::int32_t column = 0; column < tiles_x; ++column) {
      const double spacing = 1 / std::sqrt(density[tiles_.size()]);
      Tile<Real> tile;
      tile.x = static_cast<Real>(column * tile_width);
      tile.y = static_cast<Real>(row * tile_height);
      // A search visits three rows; narrow cells cut its runs close. Height and width are bounded below so that a cell
      // holds half a particle or more, also on a plane narrower than a cell.
      const double height = std::max(std::max(support, 1.5) * spacing * (1 + 1e-6), spacing * spacing / length_x);
      const double width = std::max(height / 4, spacing * spacing / std::min(height, tile_height));
      tile.rows = fit(tile_height / height);
      tile.columns = fit(tile_width / width);
      tile.inverse_height = static_cast<Real>(tile.rows / tile_height);
      tile.inverse_width = static_cast<Real>(tile.columns / tile_width);
      tile.height = static_cast<Real>(tile_height / tile.rows);
      tile.first = static_cast<std::uint32_t>(size_);
      tile.first_row = static_cast<std::uint32_t>(rows_);
      rows_ += static_cast<std::size_t>(tile.rows);
      size_ += static_cast<std::size_t>(tile.rows) * static_cast<std::size_t>(tile.columns);
      tiles_.push_back(tile);
    }
  }
}

template class Cells<float>;
template class Cells<double>;

void CellSort::sort(std::span<const std::uint32_t> cell, std::span<const std::uint32_t> id, std::size_t cells,
                    int parts, std::vector<std::uint32_t>& order, std::vector<std::uint32_t>& cell_start) {
  assert(cell.size() == id.size());
  const auto n = static_cast<std::uint64_t>(cell.size());
  const auto part_count = static_cast<std::uint64_t>(parts);
  const auto share = [part_count](std::uint64_t total, std::uint64_t part) {
    return static_cast<std::size_t>(total * part / part_count);
  };
  count_.resize(cells * part_count);
  cell_start.resize(cells + 1);
  order.resize(cell.size());
#pragma omp parallel for schedule(static, 1) num_threads(parts) if (parts > 1)
  for (int p = 0; p < parts; ++p) {
    const auto part = static_cast<std::uint64_t>(p);
    std::uint32_t* count = count_.data() + part * cells;
    std::fill(count, count + cells, 0U);
    for (std::size_t i = share(n, part); i < share(n, part + 1); ++i) ++count[cell[i]];
  }
  // A particle's place: all earlier cells, then the same cell in earlier parts.
  std::uint32_t sum = 0;
  for (std::size_t c = 0; c < cells; ++c) {
    cell_start[c] = sum;
    for (std::size_t part = 0; part < part_count; ++part) {
      const std::uint32_t here = count_[part * cells + c];
      count_[part * cells + c] = sum;
      sum += here;
    }
  }
  cell_start[cells] = sum;
#pragma omp parallel num_threads(parts) if (parts > 1)
  {
#pragma omp for schedule(static, 1)
    for (int p = 0; p < parts; ++p) {
      const auto part = static_cast<std::uint64_t>(p);
      std::uint32_t* next = count_.data() + part * cells;
      for (std::size_t i = share(n, part); i < share(n, part + 1); ++i) {
        order[next[cell[i]]++] = static_cast<std::uint32_t>(i);
      }
    }
    // Inside a cell by id: insertion, because the particles come nearly in order from the last step.
#pragma omp for schedule(static, 1)
    for (int p = 0; p < parts; ++p) {
      const auto part = static_cast<std::uint64_t>(p);
      for (std::size_t c = share(cells, part); c < share(cells, part + 1); ++c) {
        if (cell_start[c + 1] - cell_start[c] > 32) {  // many at one place: insertion would be quadratic
          std::sort(order.begin() + cell_start[c], order.begin() + cell_start[c + 1],
                    [id](std::uint32_t a, std::uint32_t b) { return id[a] < id[b]; });
          continue;
        }
        for (std::uint32_t k = cell_start[c] + 1; k < cell_start[c + 1]; ++k) {
          const std::uint32_t moving = order[k];
          std::uint32_t place = k;
          for (; place > cell_start[c] && id[order[place - 1]] > id[moving]; --place) order[place] = order[place - 1];
          order[place] = moving;
        }
      }
    }
  }
}

}  // namespace abn::sph
