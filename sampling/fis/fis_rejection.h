// Filter importance sampling by rejection.
#pragma once

#include "sampling/fis/filter_sampler.h"
#include "sampling/strategy.h"

namespace abn {

/// Uniform points of the filter's square, each kept with probability f / max f (von Neumann 1951; thesis 2.4.2): exact
/// for every filter, but the samples are independent, so without any of the evenness of the others.
class FisRejection final : public FilterSampler {
 public:
  static const StrategyInfo info;
  struct Params {};
  static std::vector<Field<Params>> fields() { return {}; }
  FisRejection(const SamplingTask& task, const Params&);

 private:
  void offsets(std::uint32_t pixel, std::span<Vec2f> out, std::span<float> weight) const override;

  float highest_;  // max f
};

}  // namespace abn
