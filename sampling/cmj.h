// Correlated multi-jittered sampling for any number of points.
#pragma once

#include "sampling/strategy.h"
#include "sampling/unit_square_sampler.h"

namespace abn {

/// n points with one in each of n rows and at most one in each of columns * ceil(n / columns) >= n columns of strata,
/// columns = floor(sqrt(n)) (Kensler 2013, section 3.5, with our own permutation). The paper's shuffle of the order of
/// points is left out: it does not change the set.
class Cmj final : public UnitSquareSampler {
 public:
  static const StrategyInfo info;
  struct Params {
    std::string domain = "pixel";
  };
  static std::vector<Field<Params>> fields() { return {domain_field<Params>()}; }
  Cmj(const SamplingTask& task, const Params& parameters)
      : UnitSquareSampler(task, info.name, domain_of(parameters.domain)) {}

 protected:
  void points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const override;
  Strata strata(std::uint64_t n) const override;
};

}  // namespace abn
