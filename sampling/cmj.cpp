#include "sampling/cmj.h"

#include <cmath>

#include "sampling/factors.h"
#include "sampling/permutation.h"

namespace abn {

const StrategyInfo Cmj::info{
    .name = "cmj",
    .family = "stratified",
    .summary = "Multi-jitter whose rows and columns share one shuffle each; works for any n, primes too.",
    .cite = "Kensler 2013, Correlated multi-jittered sampling (Pixar technical memo 13-01)",
    .advice = "At edges better than multijitter, on smooth integrands worse; the choice for odd counts.",
};

namespace {

CellCounts cells_of(std::uint64_t n) {
  // n < 2^31, so that the root in double is exact enough for its floor.
  const auto columns = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(n)));
  return {columns, (n + columns - 1) / columns};
}

}  // namespace

Strata Cmj::strata(std::uint64_t n) const {
  const auto [columns, rows] = cells_of(n);
  return {columns * rows, n};
}

void Cmj::points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const {
  const auto [columns, rows] = cells_of(n);
  const Permutation shuffle_columns(static_cast<std::uint32_t>(columns), mix64(key ^ 1));
  const Permutation shuffle_rows(static_cast<std::uint32_t>(rows), mix64(key ^ 2));
  std::uint64_t row = first / columns;
  std::uint64_t column = first % columns;
  std::uint64_t x_stratum = shuffle_rows(static_cast<std::uint32_t>(row));
  random_points(key, first, out);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const UnitPoint offset = out[k];
    const std::uint64_t x = shuffle_columns(static_cast<std::uint32_t>(column)) * rows + x_stratum;
    out[k] = {stratum_place(x, offset.x, columns * rows), stratum_place(first + k, offset.y, n)};
    if (++column == columns) {
      column = 0;
      if (++row < rows) x_stratum = shuffle_rows(static_cast<std::uint32_t>(row));
    }
  }
}

}  // namespace abn
