// Adaptive sampling as renderers do it: more samples for the pixels whose estimated error is above a threshold.
#pragma once

#include <cstdint>
#include <vector>

#include "sampling/sampler.h"
#include "sampling/strategy.h"
#include "sampling/unit_square_sampler.h"

namespace abn {

/// The honest competitor of the particle loops. Every pixel first gets the same number of stratified samples; then, in
/// rounds, those pixels get more whose standard error of the mean, sqrt(V / n), is above a threshold, V being the
/// largest variance among the pixel and its neighbours, so that an edge that the few samples of one pixel missed is
/// found from the next one. Threshold-driven sampling is Mitchell 1987; a threshold on the standard error and the
/// spreading to neighbours are what production renderers do (Dammertz et al. 2010; Cycles, Arnold). The threshold is
/// not given but found: the one that spends the round's budget exactly. It equalises V / n, so that n ~ V.
///
/// A jittered grid cannot be extended, so the samples of a pixel are those of an Owen-scrambled Sobol sequence of its
/// own: 2^m in a row are a (0,m,2)-net whenever the pixel stops there. `most_samples_per_pixel` bounds what a firefly
/// can take; a variance that overflowed counts as the largest float.
class AdaptiveJitter final : public Sampler {
 public:
  struct Params {
    double base_share = 0.5;
    int rounds = 4;
    int most_samples_per_pixel = 0;
    int neighbourhood = 1;
  };
  static const StrategyInfo info;
  static std::vector<Field<Params>> fields();

  /// Throws ConfigError if most_samples_per_pixel does not hold the budget, or for 2^31 pixels or samples per pixel.
  AdaptiveJitter(const SamplingTask& task, const Params& params);
  SampleBatch next(const Feedback& seen) override;
  std::vector<Diagnostic> diagnostics() const override;

 private:
  void plan_base();
  void plan_round(const Feedback& seen, std::uint64_t samples);
  void spread(std::vector<std::uint32_t>& eligible, std::uint64_t samples);
  void emit();

  SamplingTask task_;
  Params params_;
  std::uint32_t cap_ = 0;       // samples of a pixel at most
  std::uint64_t base_ = 0;      // samples of the base
  int round_ = 0;               // rounds planned; 0 = not even the base
  Grid<std::uint32_t> wanted_;  // samples that each pixel shall have after this round
  Grid<std::uint32_t> count_;   // and has been given
  std::size_t at_ = 0;          // all pixels before have what they want
  std::uint64_t emitted_ = 0;
  double threshold_ = 0;  // of the last round: V / n
  std::vector<Vec2f> batch_;
  std::vector<UnitPoint> points_;
};

}  // namespace abn
