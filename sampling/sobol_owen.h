// The first two Sobol dimensions with Owen scrambling.
#pragma once

#include "sampling/strategy.h"
#include "sampling/unit_square_sampler.h"

namespace abn {

/// Points [first, first + out.size()) of the (0,2)-sequence, Owen-scrambled by hash with one seed per coordinate.
void sobol_owen_points(std::uint32_t first, std::uint32_t seed_x, std::uint32_t seed_y, std::span<UnitPoint> out);

/// Owen-scrambled Sobol points: any 2^m in a row from a multiple of 2^m on are a (0,m,2)-net.
class SobolOwen final : public UnitSquareSampler {
 public:
  static const StrategyInfo info;
  struct Params {
    std::string domain = "pixel";
  };
  static std::vector<Field<Params>> fields() { return {domain_field<Params>()}; }
  SobolOwen(const SamplingTask& task, const Params& parameters)
      : UnitSquareSampler(task, info.name, domain_of(parameters.domain)) {}

 protected:
  void points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const override;
};

}  // namespace abn
