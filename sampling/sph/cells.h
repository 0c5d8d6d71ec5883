// Particles sorted into the cells of a torus, and the search for neighbours in them.
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

namespace abn::sph {

/// A grid of cells over the torus [0,length_x) x [0,length_y), stored row by row. All lengths in d.
template <class Real>
struct CellGrid {
  Real length_x = 1, length_y = 1;
  Real inverse_width = 1, inverse_height = 1;  // of a cell
  std::int32_t columns = 1, rows = 1;

  CellGrid() = default;
  /// Cells at least `height` high and height/4 wide: with height = the support, a search visits three rows, each of
  /// them one run of memory, and narrow cells cut the runs close. Never more cells than the area [d^2], one per
  /// particle.
  CellGrid(Real box_x, Real box_y, Real least_height) : length_x(box_x), length_y(box_y) {
    const Real height = std::max(least_height + rounding(least_height), 1 / box_x);
    const Real width = std::max(height / 4, 1 / std::min(height, box_y));
    columns = fit(box_x / width);
    rows = fit(box_y / height);
    inverse_width = static_cast<Real>(columns) / box_x;
    inverse_height = static_cast<Real>(rows) / box_y;
  }

  std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }

  /// The cell of a particle; 0 <= x < length_x, 0 <= y < length_y.
  ABN_HD std::uint32_t cell(Real x, Real y) const {
    std::int32_t column = static_cast<std::int32_t>(x * inverse_width);
    std::int32_t row = static_cast<std::int32_t>(y * inverse_height);
    column = column < columns ? column : columns - 1;  // the product may round up to the border
    row = row < rows ? row : rows - 1;
    return static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(columns) + static_cast<std::uint32_t>(column);
  }

  /// A bound on what rounding may shift a coordinate against the cell borders: a search of radius r must look
  /// r + rounding(r) far to be exact.
  ABN_HD Real rounding(Real radius) const {
    const Real longest = length_x > length_y ? length_x : length_y;
    return 8 * std::numeric_limits<Real>::epsilon() * (longest + radius);
  }

 private:
  static std::int32_t fit(Real count) { return static_cast<std::int32_t>(std::clamp(count, Real(1), Real(1 << 30))); }
};

namespace detail {
/// Calls f(first, last, image) for the maximal runs of [first, last] that lie in one image of [0, count).
template <class F>
void split_by_image(std::int64_t first, std::int64_t last, std::int64_t count, F&& f) {
  std::int64_t image = first >= 0 ? first / count : -((count - 1 - first) / count);
  for (std::int64_t begin = first; begin <= last; ++image) {
    const std::int64_t end = std::min(last, image * count + count - 1);
    f(static_cast<std::size_t>(begin - image * count), static_cast<std::size_t>(end - image * count), image);
    begin = end + 1;
  }
}
}  // namespace detail

/// Calls f(begin, end, shift_x, shift_y) for runs [begin, end) of sorted particles, so that every particle image inside
/// the rectangle [x0,x1] x [y0,y1] (unwrapped, in d) is met exactly once; images are at particle + shift. Meets some
/// images outside the rectangle too. Order: rows upward, columns rightward, so sums over it have a fixed order.
template <class Real, class F>
inline void for_each_run(const CellGrid<Real>& grid, const std::uint32_t* cell_start, Real x0, Real x1, Real y0,
                         Real y1, F&& f) {
  const auto index = [](Real scaled) { return static_cast<std::int64_t>(std::floor(scaled)); };
  const std::int64_t column0 = index(x0 * grid.inverse_width);
  const std::int64_t column1 = index(x1 * grid.inverse_width);
  const std::int64_t row0 = index(y0 * grid.inverse_height);
  const std::int64_t row1 = index(y1 * grid.inverse_height);
  detail::split_by_image(row0, row1, grid.rows, [&](std::size_t first_row, std::size_t last_row, std::int64_t tile_y) {
    const Real shift_y = static_cast<Real>(tile_y) * grid.length_y;
    for (std::size_t row = first_row; row <= last_row; ++row) {
      const std::uint32_t* start = cell_start + row * static_cast<std::size_t>(grid.columns);
      detail::split_by_image(column0, column1, grid.columns, [&](std::size_t first, std::size_t last, std::int64_t t) {
        if (start[first] < start[last + 1]) {
          f(start[first], start[last + 1], static_cast<Real>(t) * grid.length_x, shift_y);
        }
      });
    }
  });
}

/// A stable counting sort of particles into cells. The result does not depend on the number of threads.
class CellSort {
 public:
  /// `cell` [n] holds each particle's cell and becomes its place in the sorted order; cell_start [cells+1] becomes the
  /// first place of every cell, with n at the end. Works in `parts` >= 1 parallel parts; 4 B per cell and part.
  void sort(std::span<std::uint32_t> cell, std::size_t cells, int parts, std::vector<std::uint32_t>& cell_start);

 private:
  std::vector<std::uint32_t> count_;  // [parts*cells]
};

}  // namespace abn::sph
