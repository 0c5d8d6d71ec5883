// Splitting a count into columns and rows of cells.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "sampling/vec.h"

namespace abn {

/// A grid of columns * rows cells.
struct CellCounts {
  std::uint64_t columns = 1;
  std::uint64_t rows = 1;
  friend constexpr bool operator==(CellCounts, CellCounts) = default;
};

/// columns * rows = n with columns the largest divisor of n that is at most sqrt(n); {1, n} for a prime.
inline CellCounts most_square_factors(std::uint64_t n) {
  auto columns = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(n)));
  while (columns * columns > n) --columns;
  while ((columns + 1) * (columns + 1) <= n) ++columns;
  while (n % columns != 0) --columns;
  return {columns, n / columns};
}

/// Ratio of the sides of a cell, >= 1, when `area` is cut into columns * rows cells.
inline double cell_aspect(CellCounts cells, Extent area) {
  const double a = static_cast<double>(area.width) * static_cast<double>(cells.rows);
  const double b = static_cast<double>(area.height) * static_cast<double>(cells.columns);
  return std::max(a, b) / std::min(a, b);
}

/// The grid of exactly n cells on `area` whose cells are nearest to squares, if their sides differ by at most a factor
/// of 2; of two equals the one with more rows, so 6 cells of a square area are 2 columns by 3 rows. Nothing if there
/// is none (n = 5, 7, ... on a square).
inline std::optional<CellCounts> near_square_cells(std::uint64_t n, Extent area) {
  const double square_rows = std::sqrt(static_cast<double>(n) * area.height / area.width);
  const auto first = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(square_rows / std::sqrt(2.0)));
  const auto last = std::min(n, static_cast<std::uint64_t>(square_rows * std::sqrt(2.0)) + 1);
  std::optional<CellCounts> best;
  for (std::uint64_t rows = last; rows >= first; --rows) {
    if (n % rows != 0) continue;
    const CellCounts cells{n / rows, rows};
    const double aspect = cell_aspect(cells, area);
    if (aspect <= 2 && (!best || aspect < cell_aspect(*best, area))) best = cells;
  }
  return best;
}

}  // namespace abn
