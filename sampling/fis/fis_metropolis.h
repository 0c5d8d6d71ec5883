// Filter importance sampling by a Markov chain.
#pragma once

#include "sampling/fis/filter_sampler.h"
#include "sampling/strategy.h"

namespace abn {

/// One chain per pixel over f (Metropolis et al. 1953; thesis 2.4.3): from a point drawn uniformly from the filter's
/// square, a step to a uniform point of a square around the present one, taken with probability min(1, f' / f). The
/// first `burn_in` states are dropped; the rest are the samples. They follow f, but neighbours in the chain are
/// correlated and often equal, so the error is larger than that of independent samples.
class FisMetropolis final : public FilterSampler {
 public:
  static const StrategyInfo info;
  struct Params {
    int burn_in = 64;
    double step = 0.7;
    int thinning = 1;
  };
  static std::vector<Field<Params>> fields();
  FisMetropolis(const SamplingTask& task, const Params& params);
  std::vector<Diagnostic> diagnostics() const override;

 private:
  void offsets(std::uint32_t pixel, std::span<Vec2f> out, std::span<float> weight) const override;

  Params params_;
};

}  // namespace abn
