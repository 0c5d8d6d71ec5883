// SPH blue noise over the whole plane (thesis 2.5, 2.6; Jiang et al. 2015).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sampling/sampler.h"
#include "sampling/sph/solver.h"
#include "sampling/strategy.h"

namespace abn {

/// Relaxes all samples together on a torus once, before the first batch, and emits them row by row of the plane.
/// Any budget from 1 to 2^32-1 and any plane. Deviations from the thesis, each measured in the design notes: Wendland
/// kernel instead of poly6 (no pairing), dimensionless parameters, opposite sides joined instead of walls, and a start
/// that is white only inside coarse cells, because relaxation cannot move mass over long distances.
class SphBlueNoise final : public Sampler {
 public:
  struct Params {
    double delta = 0.3;
    double support_radius = 2.0;
    double step = 1.2;
    double damping = 0.6;
    double velocity_cap = 0.3;
    int iterations = 25;
    double tolerance = 0;
    std::string start = "coarse_cells";
  };
  static const StrategyInfo info;
  static std::vector<Field<Params>> fields();

  /// Throws ConfigError for a budget of 0 or above 2^32-1. Nothing is computed before the first next().
  SphBlueNoise(const SamplingTask& task, const Params& params);
  SampleBatch next(const Feedback& seen) override;
  std::vector<Diagnostic> diagnostics() const override;

 private:
  void relax();

  SamplingTask task_;
  Params params_;
  std::vector<Vec2f> samples_;  // sorted by pixel; empty until the first next()
  std::uint64_t emitted_ = 0;
  sph::RelaxReport report_;
  std::string backend_;
};

/// `count` points, white inside coarse cells of about `per_cell` points each: roughly square cells, their counts by
/// running rounding along a boustrophedon path, so that every cell and every row of cells has its share of points
/// within one. Keeps long waves out of the start without leaving a lattice in it. Positions [px], inside the plane.
std::vector<Vec2f> coarse_cell_positions(Extent plane, std::uint64_t count, std::uint64_t seed, double per_cell = 16);

}  // namespace abn
