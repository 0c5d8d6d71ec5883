#include "sampling/nrooks.h"

#include "sampling/permutation.h"

namespace abn {

const StrategyInfo NRooks::info{
    .name = "nrooks",
    .family = "stratified",
    .summary = "One point in every one of n columns and n rows, paired at random (Latin hypercube in 2-D).",
    .cite = "Shirley 1991, Discrepancy as a quality measure; McKay, Beckman, Conover 1979 (Latin hypercube)",
    .advice = "Where the integrand is nearly a sum of functions of x and of y; otherwise multijitter.",
    .aliases = {"lhs"},
};

void NRooks::points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const {
  const Permutation rows(static_cast<std::uint32_t>(n), key);
  random_points(key, first, out);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const std::uint64_t i = first + k;
    const UnitPoint offset = out[k];
    out[k] = {stratum_place(i, offset.x, n), stratum_place(rows(static_cast<std::uint32_t>(i)), offset.y, n)};
  }
}

}  // namespace abn
