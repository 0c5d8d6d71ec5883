#include "sampling/multijitter.h"

#include "sampling/permutation.h"

namespace abn {

const StrategyInfo MultiJitter::info{
    .name = "multijitter",
    .family = "stratified",
    .summary = "Jitter and N-rooks at once: one point per cell of a grid and one per fine column and fine row.",
    .cite = "Chiu, Shirley, Wang 1994, Multi-jittered sampling (Graphics Gems IV); orthogonal array: Owen 1992",
    .advice = "The best of the stratified family at small counts per pixel; for primes it is only nrooks.",
    .aliases = {"oa"},
};

MultiJitter::MultiJitter(const SamplingTask& task, const Params& parameters)
    : UnitSquareSampler(task, info.name, domain_of(parameters.domain)) {
  if (smaller_set() > 0) cells_[0] = most_square_factors(smaller_set());
  cells_[1] = most_square_factors(smaller_set() + 1);
}

void MultiJitter::points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const {
  const auto [columns, rows] = cells_[n - smaller_set()];
  const auto shuffle_of_column = [&, rows = rows](std::uint64_t column) {
    return Permutation(static_cast<std::uint32_t>(rows), mix64(key ^ (2 * column)));
  };
  const auto shuffle_of_row = [&, columns = columns](std::uint64_t row) {
    return Permutation(static_cast<std::uint32_t>(columns), mix64(key ^ (2 * row + 1)));
  };
  std::uint64_t row = first / columns;
  std::uint64_t column = first % columns;
  Permutation y_strata = shuffle_of_row(row);
  random_points(key, first, out);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const UnitPoint offset = out[k];
    const std::uint64_t x = column * rows + shuffle_of_column(column)(static_cast<std::uint32_t>(row));
    const std::uint64_t y = row * columns + y_strata(static_cast<std::uint32_t>(column));
    out[k] = {stratum_place(x, offset.x, n), stratum_place(y, offset.y, n)};
    if (++column == columns) {
      column = 0;
      y_strata = shuffle_of_row(++row);
    }
  }
}

}  // namespace abn
