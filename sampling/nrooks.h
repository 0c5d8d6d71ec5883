// N-rooks sampling, in two dimensions the same as Latin hypercube sampling.
#pragma once

#include "sampling/strategy.h"
#include "sampling/unit_square_sampler.h"

namespace abn {

/// n points, one in each of the n columns and one in each of the n rows. Points are emitted column by column: only the
/// order differs from two independent permutations, not the set.
class NRooks final : public UnitSquareSampler {
 public:
  static const StrategyInfo info;
  struct Params {
    std::string domain = "pixel";
  };
  static std::vector<Field<Params>> fields() { return {domain_field<Params>()}; }
  NRooks(const SamplingTask& task, const Params& parameters)
      : UnitSquareSampler(task, info.name, domain_of(parameters.domain)) {}

 protected:
  void points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const override;
  Strata strata(std::uint64_t n) const override { return {n, n}; }
};

}  // namespace abn
