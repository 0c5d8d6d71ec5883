// The Hammersley point set.
#pragma once

#include "sampling/strategy.h"
#include "sampling/unit_square_sampler.h"

namespace abn {

/// Points (i / n, radical inverse of i in base 2), by default moved by one random shift modulo 1 per set.
class Hammersley final : public UnitSquareSampler {
 public:
  static const StrategyInfo info;
  struct Params {
    std::string domain = "plane";
    std::string shift = "random";
  };
  static std::vector<Field<Params>> fields();
  Hammersley(const SamplingTask& task, const Params& parameters)
      : UnitSquareSampler(task, info.name, domain_of(parameters.domain)), shifted_(parameters.shift == "random") {}

 protected:
  void points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const override;

 private:
  bool shifted_;
};

}  // namespace abn
