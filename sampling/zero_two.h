// The (0,2)-sequence with random digit scrambling.
#pragma once

#include "sampling/strategy.h"
#include "sampling/unit_square_sampler.h"

namespace abn {

/// The first two Sobol dimensions with one random word xor-ed to each coordinate: still a (0,2)-sequence, and the
/// cheapest scrambling; unlike Owen's it leaves the correlations between points as they are.
class ZeroTwo final : public UnitSquareSampler {
 public:
  static const StrategyInfo info;
  struct Params {
    std::string domain = "pixel";
  };
  static std::vector<Field<Params>> fields() { return {domain_field<Params>()}; }
  ZeroTwo(const SamplingTask& task, const Params& parameters)
      : UnitSquareSampler(task, info.name, domain_of(parameters.domain)) {}

 protected:
  void points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const override;
};

}  // namespace abn
