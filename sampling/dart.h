// Dart throwing on the torus, to an exact count.
#pragma once

#include <vector>

#include "sampling/params.h"
#include "sampling/sampler.h"
#include "sampling/strategy.h"

namespace abn {

/// Uniform random darts on the torus; one that lands closer than a radius to an earlier one is thrown away (Cook 1986,
/// "Stochastic sampling in computer graphics"). When too many miss, the radius is lowered by 1 % and throwing goes on
/// (McCool & Fiume 1992, "Hierarchical Poisson disk sampling distributions"), so every budget is met exactly. A dart
/// falls anywhere with equal chance, so stopping at the budget leaves no region unfilled.
/// The distance kept is the diagnostic `min_distance` [px]. Deviation from Cook: cells instead of all pairs.
class Dart final : public Sampler {
 public:
  struct Params {
    double radius = 0.74;  // relative to reference_radius()
    int throws = 100;      // darts per point at one radius
  };
  static const StrategyInfo info;
  static std::vector<Field<Params>> fields();

  /// Throws ConfigError for a budget that would not fit into memory.
  Dart(const SamplingTask& task, const Params& params);
  SampleBatch next(const Feedback& seen) override;
  std::vector<Diagnostic> diagnostics() const override;

 private:
  void generate();

  SamplingTask task_;
  Params params_;
  std::vector<Vec2f> points_;  // [px]
  std::size_t emitted_ = 0;
  double radius_ = 0;        // kept [px]
  std::uint64_t darts_ = 0;  // thrown
};

}  // namespace abn
