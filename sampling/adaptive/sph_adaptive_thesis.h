// The adaptive blue noise of the thesis, section 4.1, as written, with every suspect of its failure as a switch.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sampling/sampler.h"
#include "sampling/sph/solver.h"
#include "sampling/strategy.h"

namespace abn {

/// Russell 2018, section 4.1: all samples are particles of one fluid from the start. In each pass one random particle
/// that is still free is frozen in every pixel that has one, and evaluated; the variance V of what a pixel has received
/// sets the size field by eq. 4.1, s = 1 / (a V + c) with a V + c = (c_max - c_min) min(1, V / 0.25) + c_min (V <= 0.25
/// for data in [0,1], so s is bounded for every V), and the free particles relax in it, the frozen ones held, until all
/// are frozen. A pixel without free particles is passed over.
///
/// Whether it loses to sph_blue_noise, as in the thesis (4.1 % more error), depends on image and mapping: on the apple
/// at 6 samples per pixel 4 % less error with c = [1, 2], 10 % more with its author's [1/8, 1]. The parameters are the
/// suspects (experiments/ablation.toml): the mapping (c_min, c_max, exponent), V itself (variance, blur, map_cells),
/// freezing, and that pressure cannot carry particles over many spacings (redraw: `all` draws every free particle anew
/// at the density that is still missing, which costs blue noise, 9 % of error on a flat target; `surplus` only those
/// that are too many where they are). Deviations: the engine's Wendland kernel, exact neighbour search and relaxed
/// ghost ring; `first_iterations` instead of "until converged" before the first pass; after `most_passes` passes the
/// particles left are emitted at once, so that thousands of samples in a pixel end too.
class SphAdaptiveThesis final : public Sampler {
 public:
  struct Params {
    double c_min = 1;
    double c_max = 2;
    double exponent = 0;
    std::string variance = "estimated";
    int blur = 0;
    int map_cells = 1;
    bool freezing = true;
    std::string redraw = "never";
    int iterations = 12;
    int first_iterations = 25;
    std::string start = "white";
    std::string boundary = "ghost";
    std::string kernel = "wendland";
    double delta = 0.3;
    bool background = false;
    int most_passes = 100;
  };
  static const StrategyInfo info;
  static std::vector<Field<Params>> fields();

  /// Throws ConfigError for a budget above 2^32-1 and for variance=true without SamplingTask::guide.
  SphAdaptiveThesis(const SamplingTask& task, const Params& params);
  SampleBatch next(const Feedback& seen) override;
  std::vector<Diagnostic> diagnostics() const override;
  /// The last ring of ghost particles [px].
  std::span<const Vec2f> ghosts() const override { return ghosts_; }

 private:
  void keep_values(const Feedback& seen);
  Grid<float> variance(const Feedback& seen) const;
  void set_density(const Grid<float>& variance);
  std::unique_ptr<sph::Solver> make_solver() const;
  struct FreeParticles {
    std::vector<std::uint64_t> begin;  // of every pixel in `id`, and the end
    std::vector<std::uint32_t> id;
  };
  FreeParticles free_by_pixel() const;
  void redraw_all();
  void redraw_surplus();
  void simulate(int steps);
  void freeze_pass();

  SamplingTask task_;
  Params params_;
  std::unique_ptr<sph::Solver> solver_;  // empty before the first next() and after the last sample
  std::vector<Vec2f> position_;          // of every particle by id [px]
  std::vector<std::uint8_t> evaluated_;  // by id
  Grid<float> density_;                  // n of the last pass by map cell, relative; empty = uniform
  Grid<std::uint32_t> count_;            // evaluated samples of every pixel
  std::vector<Vec2f> batch_;             // [px]
  std::vector<Vec2f> sample_;            // all batches so far [px]; only if map_cells > 1
  std::vector<float> value_;             // their luminances
  std::vector<Vec2f> ghosts_;
  std::uint64_t emitted_ = 0;
  int passes_ = 0;
  std::uint64_t at_once_ = 0;     // emitted after most_passes
  std::uint64_t non_finite_ = 0;  // steps of particles
  std::string backend_;
};

}  // namespace abn
