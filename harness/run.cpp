#include "harness/run.h"

#include <fmt/format.h>
#include <omp.h>

#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "harness/apple_analytic.h"
#include "harness/backend.h"
#include "harness/calibration.h"
#include "harness/film.h"
#include "harness/filtered_truth.h"
#include "harness/guide.h"
#include "harness/image_io.h"
#include "harness/metrics.h"
#include "harness/reconstruction.h"
#include "harness/rows.h"
#include "harness/sample_sharing.h"
#include "harness/scenes.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

class Stopwatch {
 public:
  /// Seconds since the last call.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

constexpr std::string_view kScenePrefix = "scene:";

bool is_box(const PixelFilter& filter) { return filter.words().starts_with("box"); }

/// 0 = exact, else the samples per pixel of the Monte Carlo truth.
std::uint32_t truth_spp(const std::string& word) {
  if (word == "exact") return 0;
  constexpr std::string_view kPrefix = "monte_carlo:";
  std::uint32_t spp = 0;
  if (word.starts_with(kPrefix)) {
    const char* begin = word.data() + kPrefix.size();
    const char* end = word.data() + word.size();
    const auto [rest, error] = std::from_chars(begin, end, spp);
    if (error == std::errc{} && rest == end && spp >= 2) return spp;
  }
  throw ConfigError(
      fmt::format("--truth is '{}'; give exact, or monte_carlo:SPP with SPP >= 2, e.g. monte_carlo:1000", word));
}

void validate(const SubjectSpec& spec) {
  if (spec.scene.empty()) throw ConfigError("no image is given; name an image file or scene:NAME (abn list scenes)");
  const bool is_scene = spec.scene.starts_with(kScenePrefix);
  if (is_scene) find_scene(spec.scene.substr(kScenePrefix.size()));
  if (is_scene && !spec.channels.empty()) {
    throw ConfigError(fmt::format("--channels {}: {} is no file with channels to choose from; leave it out",
                                  spec.channels, spec.scene));
  }
  const std::uint32_t spp = truth_spp(spec.truth);
  static_cast<void>(parse_on_nonfinite(spec.on_nonfinite));
  if (!is_box(*make_filter(spec.filter)) && spp > 0) {
    throw ConfigError(
        fmt::format("--filter {} with --truth {}: only the box has a Monte Carlo truth; use --truth exact", spec.filter,
                    spec.truth));
  }
  if (spec.integrand == "analytic") {
    if (spec.scene != "scene:apple_analytic") {
      throw ConfigError(
          fmt::format("--integrand analytic: {} has no formula between its texels; use scene:apple_analytic, or "
                      "nearest or bilinear",
                      spec.scene));
    }
    if (spp == 0)
      throw ConfigError("--integrand analytic has no exact truth; give --truth monte_carlo:SPP, e.g. monte_carlo:1000");
  } else if (spec.integrand != "nearest" && spec.integrand != "bilinear") {
    throw ConfigError(fmt::format("--integrand is '{}'; known: nearest bilinear analytic", spec.integrand));
  }
}

}  // namespace

Extent parse_extent(const std::string& word, const std::string& what) {
  Extent extent;
  const char* end = word.data() + word.size();
  const auto [middle, width_error] = std::from_chars(word.data(), end, extent.width);
  if (width_error == std::errc{} && middle != end && *middle == 'x') {
    const auto [rest, height_error] = std::from_chars(middle + 1, end, extent.height);
    if (height_error == std::errc{} && rest == end && extent.width >= 1 && extent.height >= 1 &&
        extent.width <= 65536 && extent.height <= 65536) {
      return extent;
    }
  }
  throw ConfigError(fmt::format("{} is '{}'; give WIDTHxHEIGHT with both in [1, 65536], e.g. 200x200", what, word));
}

std::unique_ptr<Subject> load_subject(const SubjectSpec& spec, bool with_truth) {
  validate(spec);
  auto subject = std::make_unique<Subject>();
  subject->spec = spec;
  if (spec.scene.starts_with(kScenePrefix)) {
    const Scene& scene = find_scene(spec.scene.substr(kScenePrefix.size()));
    // The formula is sampled itself; a small rendering only identifies it in records.
    constexpr Extent kIdentifying{300, 300};
    subject->source = spec.integrand == "analytic" ? render_scene(scene, kIdentifying) : render_scene(scene);
    subject->high_dynamic_range = scene.high_dynamic_range;
  } else {
    LoadedImage loaded =
        load_image(spec.scene, {.channels = spec.channels, .on_nonfinite = parse_on_nonfinite(spec.on_nonfinite)});
    subject->source = std::move(loaded.image);
    subject->high_dynamic_range = loaded.floating_point;
    subject->notices = std::move(loaded.notices);
  }
  subject->source_hash = pixel_hash(subject->source);
  const Interpolation interpolation = spec.integrand == "bilinear" ? Interpolation::bilinear : Interpolation::nearest;
  if (spec.integrand == "analytic") {
    subject->integrand = std::make_unique<AppleAnalytic>(spec.to);
  } else {
    subject->integrand = std::make_unique<ImageIntegrand>(subject->source, spec.to, interpolation);
  }
  subject->filter = make_filter(spec.filter);
  if (!spec.guide.empty()) subject->guide = load_guide(spec.guide, subject->source, spec.to);
  if (with_truth) {
    const std::uint32_t spp = truth_spp(spec.truth);
    constexpr std::uint64_t kTruthSeed = 0x7275746874727574U;  // never shared with a strategy's seed 1, 2, 3, …
    if (spp != 0) {
      subject->truth = monte_carlo_truth(*subject->integrand, spp, kTruthSeed);
    } else if (is_box(*subject->filter)) {
      subject->truth = exact_truth(subject->source, spec.to, interpolation);
    } else {
      subject->truth = filtered_truth(subject->source, spec.to, *subject->filter, interpolation);
    }
  }
  return subject;
}

void validate(const RunSpec& spec) {
  validate(spec.subject);
  ParameterWords words = spec.parameters;
  const Strategy& strategy = find_strategy(spec.strategy, words);
  static_cast<void>(strategy.resolve(words));
  if (spec.samples == 0)
    throw ConfigError("the budget is 0 samples; give --spp or --samples so that there is at least one");
  if (spec.samples > (std::uint64_t{1} << 36))
    throw ConfigError(fmt::format("the budget is {} samples; at most 2^36 can be asked for", spec.samples));
  const bool filtered = !is_box(*make_filter(spec.subject.filter));
  if (spec.reconstruction != "auto") {
    find_reconstruction(spec.reconstruction);
    if (filtered && spec.reconstruction != "mean") {
      throw ConfigError(fmt::format("--reconstruction {} with --filter {}: only mean goes with a filter other than box",
                                    spec.reconstruction, spec.subject.filter));
    }
  }
  if (!(spec.target_error >= 0 && std::isfinite(spec.target_error))) {
    throw ConfigError(
        fmt::format("--target-error is {}; give an RMSE > 0 in linear light, e.g. 0.01", spec.target_error));
  }
  if (spec.target_error > 0 && !strategy.info.adaptive) {
    std::string stepping;
    for (const auto& row : strategies()) {
      if (row.info.adaptive) stepping += (stepping.empty() ? "" : ", ") + row.info.name;
    }
    throw ConfigError(fmt::format("--target-error with {}: it places all samples before it sees one; use one of {}",
                                  strategy.info.name, stepping));
  }
  if (spec.target_error > 0 && filtered) {
    throw ConfigError(
        fmt::format("--target-error with --filter {}: errors are estimated for the box only", spec.subject.filter));
  }
  resolve_backend(spec.backend);
}

void require_sampler(const RunSpec& spec) {
  ParameterWords words = spec.parameters;
  const Strategy& strategy = find_strategy(spec.strategy, words);
  SamplingTask task{.plane = spec.subject.to, .budget = spec.samples, .seed = spec.seed};
  task.filter = make_filter(spec.subject.filter);
  // A stand-in: whoever needs a guide asks whether there is one, and looks at it later.
  if (!spec.subject.guide.empty()) task.guide = std::make_shared<const Grid<float>>(Extent{1, 1}, 1.0F);
  static_cast<void>(strategy.make(task, words));
}

std::string canonical(const RunSpec& spec) {
  ParameterWords words = spec.parameters;
  const Strategy& strategy = find_strategy(spec.strategy, words);
  nlohmann::json json;
  json["strategy"] = strategy.info.name;
  json["params"] = strategy.resolve(words);
  json["scene"] = spec.subject.scene;
  json["to"] = {spec.subject.to.width, spec.subject.to.height};
  json["integrand"] = spec.subject.integrand;
  json["truth"] = spec.subject.truth;
  json["filter"] = make_filter(spec.subject.filter)->words();
  json["channels"] = spec.subject.channels;
  json["on_nonfinite"] = spec.subject.on_nonfinite;
  if (!spec.subject.guide.empty()) json["guide"] = spec.subject.guide;
  if (spec.target_error > 0) json["target_error"] = spec.target_error;
  json["samples"] = spec.samples;
  json["seed"] = spec.seed;
  json["reconstruction"] = spec.reconstruction == "auto"
                               ? strategy.info.reconstruction + strategy.info.reconstruction_hdr
                               : spec.reconstruction;
  json["backend"] = resolve_backend(spec.backend).name;
  return json.dump();
}

std::string run_key(const RunSpec& spec) { return hash_key(canonical(spec)); }

SampleBatch next_batch(Sampler& sampler, const Feedback& seen) {
  try {
    return sampler.next(seen);
  } catch (const IoError&) {
    stop_if_interrupted();
    throw;
  }
}

namespace {

/// What `auto` means for a strategy on a subject. A box apart, every filter goes with the mean only.
std::string resolved_reconstruction(const RunSpec& spec, const StrategyInfo& info, const Sampler& sampler,
                                    const Subject& subject) {
  if (spec.reconstruction != "auto") return spec.reconstruction;
  if (!is_box(*subject.filter)) return "mean";
  if (!sampler.reconstruction().empty()) return std::string(sampler.reconstruction());
  return subject.high_dynamic_range && !info.reconstruction_hdr.empty() ? info.reconstruction_hdr : info.reconstruction;
}

/// Root mean square of the estimated errors; NaN without any.
double estimated_rmse(const Grid<float>& standard_error) {
  if (standard_error.cells().empty()) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0;
  for (const float e : standard_error.cells()) sum += double{e} * double{e};
  return std::sqrt(sum / static_cast<double>(standard_error.cells().size()));
}

}  // namespace

RunResult run(const RunSpec& spec, const Subject& subject, const std::vector<std::string>& metric_names,
              PointSet* points, Progress* progress) {
  validate(spec);
  RunResult result;
  result.spec = spec;
  ParameterWords words = spec.parameters;
  const Strategy& strategy = find_strategy(spec.strategy, words);
  result.parameters = strategy.resolve(words);
  const Backend backend = resolve_backend(spec.backend);
  result.backend = backend.name;
  result.threads = omp_get_max_threads();
  result.source_hash = subject.source_hash;
  result.truth_standard_error = standard_error_rms(subject.truth);

  Stopwatch watch;
  const auto sampler = strategy.make({.plane = subject.spec.to,
                                      .budget = spec.samples,
                                      .seed = spec.seed,
                                      .solver = backend.factory,
                                      .adaptive_plane = backend.adaptive_plane,
                                      .filter = subject.filter,
                                      .guide = subject.guide,
                                      .high_dynamic_range = subject.high_dynamic_range,
                                      .small_steps = spec.target_error > 0,
                                      .cache = spec.cache},
                                     words);
  result.reconstruction = resolved_reconstruction(spec, strategy.info, *sampler, subject);
  const Reconstruction& reconstruction = find_reconstruction(result.reconstruction);
  // The samples of a filter importance strategy are distributed as the filter: their plain mean is filtered already.
  const bool shares = !is_box(*subject.filter) && !strategy.info.filter;
  double calibrated = 0;
  const auto develop = [&](const Film& film) {
    if (shares) return share_samples(film, *subject.filter, strategy.info.adaptive);
    Developed picture = harness::develop(film, reconstruction, backend);
    calibrated = reconstruction.needs_samples ? calibrate(picture, film, sampler->uniform_samples()) : 0;
    return picture;
  };

  // The one loop: generate -> evaluate -> accumulate -> feed back.
  const Integrand& integrand = *subject.integrand;
  const std::uint32_t channels = integrand.channels();
  const bool film_keeps_samples = shares || reconstruction.needs_samples;
  Film film(subject.spec.to, channels, film_keeps_samples);
  std::vector<float> values;
  std::optional<Developed> developed;
  std::uint64_t done = 0;
  for (;;) {
    if (progress != nullptr) progress->update(done, "sampling");
    const SampleBatch batch = next_batch(*sampler, {film.stats(), values, channels});
    result.time.generate_s += watch.lap();
    if (batch.empty()) break;
    values.resize(batch.position.size() * channels);
    integrand.evaluate(batch.position, values);
    result.time.evaluate_s += watch.lap();
    film.add(batch, values);
    if (points != nullptr) {
      points->position.insert(points->position.end(), batch.position.begin(), batch.position.end());
      points->weight.insert(points->weight.end(), batch.weight.begin(), batch.weight.end());
      points->pixel.insert(points->pixel.end(), batch.pixel.begin(), batch.pixel.end());
    }
    ++result.passes;
    done += batch.position.size();
    if (spec.target_error > 0) {
      developed = develop(film);
      if (developed->standard_error.cells().empty()) {
        throw ConfigError(fmt::format("--target-error: reconstruction {} estimates no errors; use kriging or edge",
                                      result.reconstruction));
      }
      if (estimated_rmse(developed->standard_error) <= spec.target_error) break;
      if (done < spec.samples) developed.reset();
    }
    result.time.reconstruct_s += watch.lap();
    stop_if_interrupted();
  }
  if (!developed) developed = develop(film);
  result.time.reconstruct_s += watch.lap();
  result.time.total_s = result.time.generate_s + result.time.evaluate_s + result.time.reconstruct_s;
  result.time.cached = sampler->cached();
  result.ghosts.assign(sampler->ghosts().begin(), sampler->ghosts().end());
  result.standard_error = std::move(developed->standard_error);
  result.estimated_rmse = estimated_rmse(result.standard_error);

  result.picture = std::move(developed->image);
  result.samples = developed->samples;
  result.empty_pixels = developed->empty_pixels;
  result.max_samples_per_pixel = developed->max_samples_per_pixel;
  result.diagnostics = sampler->diagnostics();
  if (calibrated != 0) result.diagnostics.push_back({.name = "calibration", .value = calibrated});
  if (developed->empty_pixels > 0) {
    // The reconstructions that look at the samples estimate such a pixel from those around it.
    const bool filled = !film_keeps_samples;
    result.diagnostics.push_back(
        {.name = "empty_pixels",
         .value = static_cast<double>(developed->empty_pixels),
         .text = fmt::format("{} pixels got no sample and were {}", developed->empty_pixels,
                             filled ? "filled from their neighbours" : "estimated from the samples around them"),
         .warning = filled});
  }
  if (spec.target_error > 0 && !(result.estimated_rmse <= spec.target_error)) {
    result.diagnostics.push_back(
        {.name = "target_missed",
         .value = result.estimated_rmse,
         .text =
             fmt::format("the budget of {} samples ended at an estimated RMSE of {:.4g}, above --target-error {:g}; "
                         "give more samples",
                         spec.samples, result.estimated_rmse, spec.target_error),
         .warning = true});
  }
  for (const auto& name : metric_names) {
    stop_if_interrupted();
    if (progress != nullptr) progress->update(done, "score " + name);
    const Metric& metric = find_metric(name);
    const double score = subject.truth.image.texels.empty()
                             ? std::numeric_limits<double>::quiet_NaN()
                             : metric.score({result.picture, subject.truth.image, subject.high_dynamic_range});
    result.scores.push_back({name, score});
  }
  return result;
}

}  // namespace abn::harness
