// SPH blue noise over the whole plane (thesis 2.5, 2.6; Jiang et al. 2015).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sampling/emit_by_pixel.h"
#include "sampling/sampler.h"
#include "sampling/sph/solver.h"
#include "sampling/strategy.h"

namespace abn {

/// Relaxes all samples together once, before the first batch, and emits them row by row of the plane. Any budget from 1
/// to 2^32-1 and any plane; with SamplingTask::density, at that density (size field s = density^-1/2, eq. 2.22).
/// Deviations from the thesis, each measured in the design notes: Wendland kernel instead of poly6 and spiky (no
/// pairing), dimensionless parameters, opposite sides joined instead of walls, a start that is white only inside coarse
/// cells, because relaxation cannot move mass over long distances, and a background force, without which the density
/// misses its target.
class SphBlueNoise final : public Sampler {
 public:
  struct Params {
    double delta = 0.3;
    std::string kernel = "wendland";
    std::string boundary = "periodic";
    std::string start = "coarse_cells";
    int iterations = 25;
    double support_radius = 2.0;
    double step = 1.2;
    bool adaptive_step = true;
    double damping = 0.6;
    double velocity_cap = 0.3;
    double tolerance = 0;
    std::string criterion = "mean";
    int classes = 1;
    double least_density = 0.01;
    double gradient_limit = 1;
    bool background = true;
    std::string search = "exact";
  };
  static const StrategyInfo info;
  static std::vector<Field<Params>> fields();

  /// Throws ConfigError for a budget of 0 or above 2^32-1 (above 20000 for search=thesis_cells), a start that is none,
  /// classes beside ghosts or a density, IoError for a start file that cannot be read or has not `budget` points.
  /// Nothing is computed before the first next().
  SphBlueNoise(const SamplingTask& task, const Params& params);
  SampleBatch next(const Feedback& seen) override;
  std::vector<Diagnostic> diagnostics() const override;
  /// The ring of ghost particles around the plane [px]; empty before the first next() and without ghosts.
  std::span<const Vec2f> ghosts() const override { return ghosts_; }

 private:
  std::vector<Vec2f> start() const;
  void relax();

  SamplingTask task_;
  Params params_;
  Grid<float> size_;                  // s from the task's density; empty = uniform
  std::vector<Vec2f> start_file_;     // [px]; of start=file:PATH
  std::vector<EmitByPixel> classes_;  // one after the other; empty until the first next()
  std::size_t class_at_ = 0;
  std::vector<Vec2f> ghosts_;
  sph::RelaxReport report_;
  std::string backend_;
};

/// `count` points, white inside coarse cells of about `per_cell` points each: roughly square cells, their counts by
/// running rounding along a boustrophedon path, so that every cell and every row of cells has its share of points
/// within one. Keeps long waves out of the start without leaving a lattice in it. Positions [px], inside the plane.
std::vector<Vec2f> coarse_cell_positions(Extent plane, std::uint64_t count, std::uint64_t seed, double per_cell = 16);

}  // namespace abn
