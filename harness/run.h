// One run: a strategy spends its budget on a subject, and the result is one row.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "harness/image.h"
#include "harness/integrand.h"
#include "harness/progress.h"
#include "harness/truth.h"
#include "sampling/strategy.h"

namespace abn::harness {

/// What is sampled: an image or scene, seen as a function on the plane of output pixels, and the truth it is measured
/// against.
struct SubjectSpec {
  std::string scene;                    // "scene:NAME" or the path of an image file
  Extent to = {200, 200};               // output size [px]
  std::string integrand = "nearest";    // nearest | bilinear | analytic (procedural scenes that have one)
  std::string truth = "exact";          // exact | monte_carlo:SPP
  std::string filter = "box";           // "NAME" or "NAME:KEY=VALUE,…" of filters()
  std::string channels;                 // as LoadOptions::channels
  std::string on_nonfinite = "refuse";  // refuse | zero | clamp
  std::string guide = {};               // "" | an image file | true_variance: what SamplingTask::guide is made of
  friend bool operator==(const SubjectSpec&, const SubjectSpec&) = default;
};

/// A loaded subject: made once, used by every run on it. Not copyable: the integrand refers to the source.
struct Subject {
  SubjectSpec spec;
  Image source;
  std::string source_hash;  // pixel_hash(source)
  bool high_dynamic_range = false;
  std::vector<std::string> notices;
  std::unique_ptr<Integrand> integrand;
  GroundTruth truth;
  std::shared_ptr<const PixelFilter> filter;
  std::shared_ptr<const Grid<float>> guide;  // null = none
};

/// Throws ConfigError, IoError. `with_truth` false leaves the truth empty.
std::unique_ptr<Subject> load_subject(const SubjectSpec& spec, bool with_truth = true);

/// Everything that decides a run's samples and picture.
struct RunSpec {
  std::string label;          // how tables call it
  std::string strategy;       // as typed: a name, an alias, file:PATH, command:CMD
  ParameterWords parameters;  // overrides of the strategy's defaults
  SubjectSpec subject;
  std::uint64_t samples = 0;
  std::uint64_t seed = 1;
  std::string reconstruction = "auto";  // a row of reconstructions(), or auto = what the strategy recommends
  std::string backend = "auto";         // auto | cpu | cuda
  double target_error = 0;              // stop once the estimated RMSE is at most this; 0 = spend the budget
  bool cache = true;                    // stages that depend on no image may come from the disk cache
};

/// Checks every word of a spec that can be checked without loading or running anything. Throws ConfigError or
/// DeviceError.
void validate(const RunSpec& spec);

/// Builds the sampler of a spec once, without running it: throws ConfigError if the strategy cannot meet the budget,
/// IoError for a file of points.
void require_sampler(const RunSpec& spec);

/// The canonical form of a spec (every parameter spelled out) and its 64-bit hash: the key of `--resume`.
std::string canonical(const RunSpec& spec);
std::string run_key(const RunSpec& spec);

struct Timings {
  double generate_s = 0;     // sample generation including relaxation, never integrand evaluations
  double evaluate_s = 0;     // integrand evaluations
  double reconstruct_s = 0;  // accumulation and development of the picture
  double total_s = 0;        // of the three; loading, truth and metrics are not part of a strategy's cost
  bool cached = false;       // a stage came from the cache
};

struct Score {
  std::string metric;
  double value = 0;  // NaN where the metric is undefined
};

struct RunResult {
  RunSpec spec;
  ParameterWords parameters;   // every parameter, defaults included
  std::string reconstruction;  // resolved
  std::string backend;         // resolved
  int threads = 1;
  Image picture;
  std::vector<Score> scores;
  Timings time;
  std::uint64_t samples = 0;  // exact number of integrand evaluations
  std::uint64_t passes = 0;   // batches the strategy asked for
  std::uint64_t empty_pixels = 0;
  std::uint64_t max_samples_per_pixel = 0;
  std::vector<Diagnostic> diagnostics;
  std::vector<Vec2f> ghosts;   // particles outside the plane [px], for pictures
  Grid<float> standard_error;  // of every pixel, estimated without the truth; empty = the reconstruction makes none
  double estimated_rmse = std::numeric_limits<double>::quiet_NaN();  // of standard_error; NaN = none
  double truth_standard_error = 0;  // standard_error_rms() of the truth it was measured against; 0 = exact
  std::string source_hash;
};

/// The sampler's next batch. Throws what it throws, and Interrupted instead of the failure of a command that the user's
/// Ctrl-C cut off.
SampleBatch next_batch(Sampler& sampler, const Feedback& seen);

/// Samples, reconstructs and scores. `points`, if given, receives every sample; `progress`, if given, is told of every
/// batch, one step per sample. Throws Interrupted between batches.
RunResult run(const RunSpec& spec, const Subject& subject, const std::vector<std::string>& metric_names,
              PointSet* points = nullptr, Progress* progress = nullptr);

/// "200x200" -> Extent; throws ConfigError naming `what`.
Extent parse_extent(const std::string& word, const std::string& what);

}  // namespace abn::harness
