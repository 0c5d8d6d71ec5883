// Particles sorted into cells of a torus, and the search for neighbours in them.
//
// Two levels: equal tiles over the whole plane, and in every tile its own rows and columns, as fine as the particles
// there are dense. So the number of cells is about that of the particles whatever the size field (a uniform plane is
// one tile), and a search visits rows of cells, each of them one run of memory.
//
// Which images interact: ALL of them within reach, not only the nearest. The plane is a torus, that is an infinite
// tiling, and where it is narrower than the support a particle meets several copies of another one and of itself. This
// keeps the mean density at 1 and the forces symmetric for any plane and any N, and it needs no special case.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sampling/hd.h"
#include "sampling/sph/model.h"

namespace abn::sph {

/// The cells of one tile, stored row by row from cell `first` on. Lengths in d.
template <class Real>
struct Tile {
  Real x = 0, y = 0;                           // its corner
  Real inverse_width = 1, inverse_height = 1;  // of a cell
  Real height = 1;                             // of a cell
  std::int32_t columns = 1, rows = 1;
  std::uint32_t first = 0;      // cell
  std::uint32_t first_row = 0;  // among the rows of all tiles
};

/// What a search needs to know of the cells: plain pointers, for host and device.
template <class Real>
struct CellView {
  const Tile<Real>* tiles = nullptr;      // [tiles_x*tiles_y], row by row
  Real length_x = 1, length_y = 1;        // of the torus [d]
  Real tiles_per_x = 1, tiles_per_y = 1;  // tiles per d
  std::int32_t tiles_x = 1, tiles_y = 1;

  /// The cell of a particle; 0 <= x < length_x, 0 <= y < length_y.
  ABN_HD std::uint32_t cell(Real x, Real y) const {
    const std::int32_t column = at_most(static_cast<std::int32_t>(x * tiles_per_x), tiles_x - 1);
    const std::int32_t row = at_most(static_cast<std::int32_t>(y * tiles_per_y), tiles_y - 1);
    const Tile<Real>& tile = tiles[row * tiles_x + column];
    return tile.first + static_cast<std::uint32_t>(row_in(tile, y)) * static_cast<std::uint32_t>(tile.columns) +
           static_cast<std::uint32_t>(column_in(tile, x));
  }
  /// The row and column of a coordinate in a tile, the nearest one if it lies outside. Never falls as y or x grow.
  ABN_HD static std::int32_t row_in(const Tile<Real>& tile, Real y) {
    return inside((y - tile.y) * tile.inverse_height, tile.rows);
  }
  ABN_HD static std::int32_t column_in(const Tile<Real>& tile, Real x) {
    return inside((x - tile.x) * tile.inverse_width, tile.columns);
  }

  /// A bound on what rounding may shift a coordinate against the cell borders: a search of radius r must look
  /// r + rounding(r) far to be exact.
  ABN_HD Real rounding(Real radius) const {
    const Real longest = length_x > length_y ? length_x : length_y;
    return 8 * std::numeric_limits<Real>::epsilon() * (longest + radius);
  }

 private:
  ABN_HD static std::int32_t at_most(std::int32_t value, std::int32_t limit) { return value < limit ? value : limit; }
  ABN_HD static std::int32_t inside(Real scaled, std::int32_t count) {
    return scaled < Real(1) ? 0 : scaled < static_cast<Real>(count) ? static_cast<std::int32_t>(scaled) : count - 1;
  }
};

/// Owns the tiles.
template <class Real>
class Cells {
 public:
  /// One tile: cells at least as high as the support radius [d] and a quarter as wide, but never many more cells than
  /// particles (area [d^2]).
  Cells(double length_x, double length_y, double support);
  /// Tiles of about `tile_length` [d] with cells for `density` [tiles_x*tiles_y], the mean of s^-2 in every tile.
  /// tiles_x and tiles_y as tile_count() gives them.
  Cells(double length_x, double length_y, double support, std::int32_t tiles_x, std::int32_t tiles_y,
        std::span<const double> density);
  static std::int32_t tile_count(double length, double tile_length = 16);

  CellView<Real> view() const {
    CellView<Real> copy = view_;
    copy.tiles = tiles_.data();
    return copy;
  }
  std::span<const Tile<Real>> tiles() const { return tiles_; }
  std::size_t size() const { return size_; }  // number of cells
  std::size_t rows() const { return rows_; }  // of all tiles

 private:
  CellView<Real> view_;
  std::vector<Tile<Real>> tiles_;
  std::size_t size_ = 0, rows_ = 0;
};

/// Consecutive sorted particles [begin, end), seen in the image of the plane that lies image_x widths to the right and
/// image_y heights below.
struct Run {
  std::uint32_t begin = 0, end = 0;
  std::int16_t image_x = 0, image_y = 0;
};

/// Calls f(tile, image_x, image_y) for the indices of all tiles' images that meet the rectangle [x0,x1] x [y0,y1]
/// (unwrapped, in d), each once.
template <class Real, class F>
ABN_HD inline void for_each_tile(const CellView<Real>& grid, Real x0, Real x1, Real y0, Real y1, F&& f) {
  const std::int64_t first_x = floor_to_integer(x0 * grid.tiles_per_x);
  const std::int64_t last_x = floor_to_integer(x1 * grid.tiles_per_x);
  const std::int64_t first_y = floor_to_integer(y0 * grid.tiles_per_y);
  const std::int64_t last_y = floor_to_integer(y1 * grid.tiles_per_y);
  const auto image_of = [](std::int64_t tile, std::int64_t count) -> std::int64_t {
    if (tile >= 0 && tile < count) return 0;  // mostly; a division is slow
    return tile >= 0 ? tile / count : -((count - 1 - tile) / count);
  };
  for (std::int64_t tile_y = first_y; tile_y <= last_y; ++tile_y) {
    const std::int64_t image_y = image_of(tile_y, grid.tiles_y);
    for (std::int64_t tile_x = first_x; tile_x <= last_x; ++tile_x) {
      const std::int64_t image_x = image_of(tile_x, grid.tiles_x);
      const std::int64_t tile = (tile_y - image_y * grid.tiles_y) * grid.tiles_x + tile_x - image_x * grid.tiles_x;
      f(static_cast<std::size_t>(tile), static_cast<std::int16_t>(image_x), static_cast<std::int16_t>(image_y));
    }
  }
}

/// Calls f(run) for runs of particles, so that every particle image inside the rectangle [x0,x1] x [y0,y1] (unwrapped,
/// in d) is met exactly once. Meets some images outside the rectangle too. The order of any two images does not depend
/// on the rectangle, so that sums over them are the same whoever shares the search.
template <class Real, class F>
ABN_HD inline void for_each_run(const CellView<Real>& grid, const std::uint32_t* cell_start, Real x0, Real x1, Real y0,
                                Real y1, F&& f) {
  for_each_tile(grid, x0, x1, y0, y1, [&](std::size_t index, std::int16_t image_x, std::int16_t image_y) {
    const Tile<Real>& tile = grid.tiles[index];
    const Real shift_x = static_cast<Real>(image_x) * grid.length_x;
    const Real shift_y = static_cast<Real>(image_y) * grid.length_y;
    const std::int32_t last_row = grid.row_in(tile, y1 - shift_y);
    const std::int32_t column0 = grid.column_in(tile, x0 - shift_x);
    const std::int32_t column1 = grid.column_in(tile, x1 - shift_x);
    for (std::int32_t row = grid.row_in(tile, y0 - shift_y); row <= last_row; ++row) {
      const std::uint32_t* start = cell_start + tile.first + static_cast<std::uint32_t>(row * tile.columns);
      const std::uint32_t begin = start[column0];
      const std::uint32_t end = start[column1 + 1];
      if (begin < end) f(Run{begin, end, image_x, image_y});
    }
  });
}

/// Particles in the order of their cells, and inside a cell by id: an order that depends on the state alone, not on its
/// history or on the number of threads.
class CellSort {
 public:
  /// cell [n]: each particle's cell; id [n]: distinct. Leaves in `order` [n] the particles' indices in sorted order and
  /// in `cell_start` [cells+1] the first place of every cell, with n at the end. Works in `parts` >= 1 parallel parts.
  void sort(std::span<const std::uint32_t> cell, std::span<const std::uint32_t> id, std::size_t cells, int parts,
            std::vector<std::uint32_t>& order, std::vector<std::uint32_t>& cell_start);

 private:
  std::vector<std::uint32_t> count_;  // [parts*cells]
};

}  // namespace abn::sph
