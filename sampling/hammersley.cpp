#include "sampling/hammersley.h"

#include "sampling/sobol2d.h"

namespace abn {

const StrategyInfo Hammersley::info{
    .name = "hammersley",
    .family = "low discrepancy",
    .summary = "Points (i/n, radical inverse of i in base 2) of known number, shifted at random modulo 1.",
    .cite = "Hammersley 1960; shift: Cranley and Patterson 1976",
    .advice = "Lowest discrepancy of the simple sets when n is fixed beforehand; sobol_owen converges faster.",
};

std::vector<Field<Hammersley::Params>> Hammersley::fields() {
  Field<Params> shift{"shift", &Params::shift, "shift modulo 1: random, or none (same points for every seed)"};
  shift.choices = {"random", "none"};
  return {domain_field<Params>(), shift};
}

void Hammersley::points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const {
  UnitPoint shift{};
  if (shifted_) random_points(key, 0, {&shift, 1});
  for (std::size_t k = 0; k < out.size(); ++k) {
    const std::uint64_t i = first + k;
    out[k] = {stratum_place(i, 0, n) + shift.x, reverse_bits(static_cast<std::uint32_t>(i)) + shift.y};
  }
}

}  // namespace abn
