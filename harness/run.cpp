#include "harness/run.h"

#include <fmt/format.h>
#include <omp.h>

#include <charconv>
#include <chrono>
#include <limits>
#include <nlohmann/json.hpp>

#include "harness/apple_analytic.h"
#include "harness/backend.h"
#include "harness/film.h"
#include "harness/filter.h"
#include "harness/image_io.h"
#include "harness/metrics.h"
#include "harness/reconstruction.h"
#include "harness/rows.h"
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
  find_filter(spec.filter);
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
  if (with_truth) {
    const std::uint32_t spp = truth_spp(spec.truth);
    constexpr std::uint64_t kTruthSeed = 0x7275746874727574U;  // never shared with a strategy's seed 1, 2, 3, …
    subject->truth = spp == 0 ? exact_truth(subject->source, spec.to, interpolation)
                              : monte_carlo_truth(*subject->integrand, spp, kTruthSeed);
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
  if (spec.reconstruction != "auto") find_reconstruction(spec.reconstruction);
  resolve_backend(spec.backend);
}

void require_sampler(const RunSpec& spec) {
  ParameterWords words = spec.parameters;
  const Strategy& strategy = find_strategy(spec.strategy, words);
  static_cast<void>(
      strategy.make({.plane = spec.subject.to, .budget = spec.samples, .seed = spec.seed, .solver = nullptr}, words));
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
  json["filter"] = spec.subject.filter;
  json["channels"] = spec.subject.channels;
  json["on_nonfinite"] = spec.subject.on_nonfinite;
  json["samples"] = spec.samples;
  json["seed"] = spec.seed;
  json["reconstruction"] = spec.reconstruction == "auto" ? strategy.info.reconstruction : spec.reconstruction;
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

RunResult run(const RunSpec& spec, const Subject& subject, const std::vector<std::string>& metric_names,
              PointSet* points, Progress* progress) {
  validate(spec);
  RunResult result;
  result.spec = spec;
  ParameterWords words = spec.parameters;
  const Strategy& strategy = find_strategy(spec.strategy, words);
  result.parameters = strategy.resolve(words);
  result.reconstruction = spec.reconstruction == "auto" ? strategy.info.reconstruction : spec.reconstruction;
  const Reconstruction& reconstruction = find_reconstruction(result.reconstruction);
  const Backend backend = resolve_backend(spec.backend);
  result.backend = backend.name;
  result.threads = omp_get_max_threads();
  result.source_hash = subject.source_hash;
  result.truth_standard_error = standard_error_rms(subject.truth);

  // The one loop: generate -> evaluate -> accumulate -> feed back.
  const Integrand& integrand = *subject.integrand;
  const std::uint32_t channels = integrand.channels();
  Film film(subject.spec.to, channels);
  std::vector<float> values;
  std::vector<float> luminances;
  Stopwatch watch;
  const auto sampler = strategy.make(
      {.plane = subject.spec.to, .budget = spec.samples, .seed = spec.seed, .solver = backend.factory}, words);
  std::uint64_t done = 0;
  for (;;) {
    if (progress != nullptr) progress->update(done, "sampling");
    const SampleBatch batch = next_batch(*sampler, {film.stats(), luminances});
    result.time.generate_s += watch.lap();
    if (batch.empty()) break;
    values.resize(batch.position.size() * channels);
    integrand.evaluate(batch.position, values);
    result.time.evaluate_s += watch.lap();
    film.add(batch, values);
    if (strategy.info.adaptive) {
      luminances.resize(batch.position.size());
      for (std::size_t i = 0; i < luminances.size(); ++i) luminances[i] = luminance(&values[i * channels], channels);
    }
    if (points != nullptr) {
      points->position.insert(points->position.end(), batch.position.begin(), batch.position.end());
      points->weight.insert(points->weight.end(), batch.weight.begin(), batch.weight.end());
      points->pixel.insert(points->pixel.end(), batch.pixel.begin(), batch.pixel.end());
    }
    ++result.passes;
    done += batch.position.size();
    result.time.reconstruct_s += watch.lap();
    stop_if_interrupted();
  }
  Developed developed = reconstruction.develop(film);
  result.time.reconstruct_s += watch.lap();
  result.time.total_s = result.time.generate_s + result.time.evaluate_s + result.time.reconstruct_s;

  result.picture = std::move(developed.image);
  result.samples = developed.samples;
  result.empty_pixels = developed.empty_pixels;
  result.max_samples_per_pixel = developed.max_samples_per_pixel;
  result.diagnostics = sampler->diagnostics();
  if (developed.empty_pixels > 0) {
    result.diagnostics.push_back(
        {.name = "empty_pixels",
         .value = static_cast<double>(developed.empty_pixels),
         .text = fmt::format("{} pixels got no sample and were filled from their neighbours", developed.empty_pixels),
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
