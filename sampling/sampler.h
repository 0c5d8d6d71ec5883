// The strategy interface: a Sampler answers "where next?" until its budget is spent.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sampling/adaptive/adaptive_plane.h"
#include "sampling/grid.h"
#include "sampling/pixel_filter.h"
#include "sampling/sph/solver.h"
#include "sampling/vec.h"

namespace abn {

/// What a strategy is asked for. Two equal tasks give the same samples, whatever the number of threads.
struct SamplingTask {
  Extent plane;              // [px], both sides >= 1
  std::uint64_t budget = 0;  // exact number of samples, >= 1
  std::uint64_t seed = 1;
  sph::SolverFactory solver = nullptr;  // backend of the SPH strategies; null = CPU
  /// Likewise of the passes of sph_adaptive; null = CPU, but for the relaxation, which is the solver's.
  AdaptivePlaneFactory adaptive_plane = nullptr;
  /// Relative density wanted over the plane, cell by cell (any resolution), >= 0; null = uniform. Only strategies whose
  /// StrategyInfo says `density` look at it.
  std::shared_ptr<const Grid<float>> density = nullptr;
  /// What the filter importance strategies draw their samples from; null = the box, the pixel itself.
  std::shared_ptr<const PixelFilter> filter = nullptr;
  /// Where it matters, by the user's guide image (albedo, edges): values >= 0 over the plane; null = none is given.
  std::shared_ptr<const Grid<float>> guide = nullptr;
  bool high_dynamic_range = false;  // values may be far above 1
  bool small_steps = false;         // somebody watches the error: an adaptive strategy spends the budget in more passes
  bool cache = true;                // stages that depend on no value may come from the disk cache
};

/// A view of samples, valid until the sampler's next call.
struct SampleBatch {
  std::span<const Vec2f> position;            // [px]; outside the plane only if `pixel` is given
  std::span<const float> weight = {};         // importance weight or inverse density; empty = all 1
  std::span<const std::uint32_t> pixel = {};  // owner y*width+x; empty = the pixel that contains position
  bool empty() const { return position.empty(); }
};

/// The same three as vectors, owned.
struct PointSet {
  std::vector<Vec2f> position;
  std::vector<float> weight;
  std::vector<std::uint32_t> pixel;
  SampleBatch view() const { return {position, weight, pixel}; }
};

/// Running statistics of one pixel's samples (Welford 1962); values are luminances of linear light.
struct PixelStats {
  float count = 0;
  float mean = 0;
  float m2 = 0;  // sum of squared deviations from the mean

  void add(float value) {
    count += 1.0F;
    const float delta = value - mean;
    mean += delta / count;
    m2 += delta * (value - mean);
  }
  /// With fewer than two samples the variance is unknown, not 0.
  bool known() const { return count >= 2.0F; }
  /// Unbiased variance of one sample; NaN if not known().
  float variance() const { return known() ? m2 / (count - 1.0F) : std::nanf(""); }
};

/// What a strategy may look at before it answers: nothing else couples the integrand back to the samples.
struct Feedback {
  const Grid<PixelStats>& pixels;           // all batches so far
  std::span<const float> last_values = {};  // of the last batch, in its order [batch size * channels]
  std::uint32_t channels = 1;               // of last_values: 1, or 3 of linear light
};

/// A number or a note about how a run went: a column of the result row, and a warning line if it is one.
struct Diagnostic {
  std::string name;  // column name, e.g. "iterations"
  double value = 0;
  std::string text = {};  // empty, or one sentence for a person
  bool warning = false;
};

class Sampler {
 public:
  virtual ~Sampler() = default;
  /// The next samples; the batch size is the strategy's choice (at most 2^20 where it ignores feedback); empty once
  /// the budget is emitted, and ever after.
  virtual SampleBatch next(const Feedback& seen) = 0;
  virtual std::vector<Diagnostic> diagnostics() const { return {}; }
  /// Particles outside the plane [px] that hold the samples in it, for pictures (thesis fig. 4.1); valid until the next
  /// call.
  virtual std::span<const Vec2f> ghosts() const { return {}; }
  /// The reconstruction to use where the parameters ask for another one than StrategyInfo says; empty = that one.
  virtual std::string_view reconstruction() const { return {}; }
  /// How many of the samples emitted first cover the plane evenly, placed before a value had been seen, when later ones
  /// were placed by what was seen: their mean has no bias. 0 = there is no such difference between samples.
  virtual std::uint64_t uniform_samples() const { return 0; }
  /// Whether a stage came from the disk cache.
  virtual bool cached() const { return false; }
};

}  // namespace abn
