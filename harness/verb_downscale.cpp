// abn downscale: one image, one strategy, one picture.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>

#include "harness/backend.h"
#include "harness/image_io.h"
#include "harness/metrics.h"
#include "harness/output.h"
#include "harness/progress.h"
#include "harness/record.h"
#include "harness/reliability.h"
#include "harness/run.h"
#include "harness/sample_picture.h"
#include "harness/verbs.h"
#include "sampling/atomic_file.h"
#include "sampling/error.h"
#include "sampling/points_io.h"

namespace abn::harness {
namespace {

void print_result(const RunResult& result, const std::optional<Reliability>& calibration) {
  fmt::print("{} on {}, {}x{}, {} samples ({:g} per pixel), seed {}, reconstruction {}\n", result.spec.strategy,
             result.spec.subject.scene, result.spec.subject.to.width, result.spec.subject.to.height, result.samples,
             static_cast<double>(result.samples) / static_cast<double>(result.spec.subject.to.area()), result.spec.seed,
             result.reconstruction);
  for (const auto& score : result.scores) {
    const Metric& metric = find_metric(score.metric);
    fmt::print("  {:<16} {:>12}  {}\n", score.metric,
               std::isfinite(score.value) ? fmt::format("{:.6g}", score.value) : "–", metric.summary);
  }
  if (calibration) {
    fmt::print("  {:<16} {:>12.6g}  RMSE of luminance as estimated without the truth; the true one is {:.6g}\n",
               "estimated RMSE", result.estimated_rmse, calibration->true_rmse);
  }
  fmt::print(
      "  time             generate {:.1f} ms, evaluate {:.1f} ms, reconstruct {:.1f} ms, total {:.1f} ms ({} "
      "thread{})\n",
      1e3 * result.time.generate_s, 1e3 * result.time.evaluate_s, 1e3 * result.time.reconstruct_s,
      1e3 * result.time.total_s, result.threads, result.threads == 1 ? "" : "s");
}

/// A file to write.
struct Output {
  enum class Kind { image, picture, numbers };  // any image format, one of 8 bits, or any file
  std::string flag;
  std::string path;
  Kind kind;
};

/// The files asked for, in the order of the help.
std::vector<Output> outputs_of(const DownscaleOptions& options) {
  using Kind = Output::Kind;
  const Kind estimated = options.estimated_error.ends_with(".exr") ? Kind::image : Kind::picture;
  const Kind reliability = options.reliability.ends_with(".csv") ? Kind::numbers : Kind::picture;
  std::vector<Output> outputs;
  for (const Output& output : {Output{"-o", options.output, Kind::image},
                               {"--error-map", options.error_map, Kind::image},
                               {"--estimated-error", options.estimated_error, estimated},
                               {"--reliability", options.reliability, reliability},
                               {"--points", options.points, Kind::numbers},
                               {"--points-picture", options.points_picture, Kind::picture}}) {
    if (!output.path.empty()) outputs.push_back(output);
  }
  return outputs;
}

/// Outputs are checked before the work: a wrong name must not cost minutes.
void check_outputs(const std::vector<Output>& outputs) {
  std::map<std::filesystem::path, std::string> flags;
  for (const auto& [flag, path, kind] : outputs) {
    const auto [other, is_new] = flags.emplace(std::filesystem::path(path).lexically_normal(), flag);
    if (!is_new)
      throw ConfigError(fmt::format("{} and {} name the same file '{}'; give two", other->second, flag, path));
    if (kind == Output::Kind::picture && is_linear_format(path))
      throw ConfigError(fmt::format("{} {}: this is drawn as an 8-bit picture; give a .png", flag, path));
    if (kind == Output::Kind::numbers) {
      require_writable(path);
    } else {
      require_writable_image(path);
    }
  }
}

const StrategyInfo& strategy_info(const RunSpec& spec) {
  ParameterWords words = spec.parameters;
  return find_strategy(spec.strategy, words).info;
}

/// Throws ConfigError if nothing in the strategy, as set, would look at a guide.
void require_guide_matters(const RunSpec& spec) {
  const StrategyInfo& info = strategy_info(spec);
  RunSpec without = spec;
  without.subject.guide.clear();
  try {
    require_sampler(without);
  } catch (const ConfigError&) {
    return;  // it wants one
  }
  throw ConfigError(
      fmt::format("--guide {}: {} as it is set looks at no guide; leave it out{}", spec.subject.guide, info.name,
                  info.adaptive ? fmt::format(", or set the parameter that does (abn list strategies {})", info.name)
                                : ", or use sph_adaptive --set driver=guide"));
}

/// What flag wants errors that are estimated without the truth; empty = none.
std::string estimate_wanted_by(const DownscaleOptions& options) {
  if (options.target_error > 0) return "--target-error";
  if (!options.estimated_error.empty()) return "--estimated-error";
  return options.reliability.empty() ? "" : "--reliability";
}

[[noreturn]] void refuse_estimate(const std::string& flag, const std::string& reconstruction) {
  std::string known;
  for (const auto& row : reconstructions()) {
    if (estimates_errors(row)) known += (known.empty() ? "" : " or ") + row.name;
  }
  throw ConfigError(fmt::format("{}: the reconstruction {} estimates no errors; {}", flag, reconstruction,
                                known.empty() ? "leave it out" : "use --filter box --reconstruction " + known));
}

/// Before the run, as far as it can be known then: an adaptive strategy may choose its reconstruction later.
void require_estimate(const std::string& flag, const RunSpec& spec) {
  const StrategyInfo& info = strategy_info(spec);
  if (flag.empty() || (spec.reconstruction == "auto" && info.adaptive)) return;
  const std::string name = spec.reconstruction == "auto" ? info.reconstruction : spec.reconstruction;
  if (!estimates_errors(find_reconstruction(name))) refuse_estimate(flag, name);
}

void write_reliability(const std::string& path, const Reliability& curve, const RunResult& result) {
  if (path.ends_with(".csv")) {
    write_atomically(path, reliability_csv(curve));
  } else {
    const Picture picture = draw_reliability(
        curve, fmt::format("{} on {}, {} samples", result.spec.strategy, result.spec.subject.scene, result.samples));
    save_rgb8(path, picture.size(), picture.rgb);
  }
}

void write_points_picture(const std::string& path, const std::string& region_word, const PointSet& points,
                          const RunResult& result) {
  const Extent plane = result.spec.subject.to;
  const PlaneRegion region = region_word.empty() ? region_around(plane, result.ghosts)
                                                 : parse_plane_region(region_word, "--points-region", plane);
  const Picture picture = draw_samples(points.position, result.ghosts, plane, region);
  save_rgb8(path, picture.size(), picture.rgb);
}

}  // namespace

std::map<std::string, std::string> parse_assignments(const std::vector<std::string>& words) {
  std::map<std::string, std::string> values;
  for (const auto& word : words) {
    const auto equals = word.find('=');
    if (equals == std::string::npos || equals == 0)
      throw ConfigError(fmt::format("--set is '{}'; give KEY=VALUE, e.g. --set iterations=50", word));
    values[word.substr(0, equals)] = word.substr(equals + 1);
  }
  return values;
}

std::uint64_t parse_budget(const std::string& spp, std::uint64_t samples, std::uint64_t area, double default_spp) {
  if (samples > 0) return samples;
  double value = default_spp;
  if (!spp.empty()) {
    const auto [end, error] = std::from_chars(spp.data(), spp.data() + spp.size(), value);
    if (error != std::errc{} || end != spp.data() + spp.size() || !(value > 0) || value > 1e9) {
      throw ConfigError(fmt::format("--spp is '{}'; give a number > 0 of samples per pixel, or --samples N", spp));
    }
  }
  const double budget = value * static_cast<double>(area);
  if (budget != std::floor(budget) || budget < 1) {
    throw ConfigError(fmt::format("--spp {} gives {} samples on {} pixels, which is not whole; give --samples {}", spp,
                                  budget, area, std::max(1LL, std::llround(budget))));
  }
  return static_cast<std::uint64_t>(budget);
}

int downscale(const GlobalOptions& global, const DownscaleOptions& options) {
  RunSpec spec;
  spec.strategy = options.strategy;
  spec.parameters = parse_assignments(options.set);
  spec.subject = {.scene = options.image,
                  .to = parse_extent(options.to, "--to"),
                  .integrand = options.integrand,
                  .truth = options.truth,
                  .filter = options.filter,
                  .channels = options.channels,
                  .on_nonfinite = options.on_nonfinite};
  spec.subject.guide = options.guide;
  constexpr double kMostSpp = 64;  // of a run that stops by its error
  spec.samples = options.target_error > 0 ? parse_budget(options.spp, options.samples, spec.subject.to.area(), kMostSpp)
                                          : parse_budget(options.spp, options.samples, spec.subject.to.area());
  spec.seed = options.seed;
  spec.reconstruction = options.reconstruction;
  spec.backend = global.backend;
  spec.target_error = options.target_error;
  spec.cache = !global.no_cache;
  validate(spec);
  const std::vector<Output> outputs = outputs_of(options);
  check_outputs(outputs);
  if (!options.points_region.empty())
    static_cast<void>(parse_plane_region(options.points_region, "--points-region", spec.subject.to));
  const std::string estimate_flag = estimate_wanted_by(options);
  require_estimate(estimate_flag, spec);
  if (!options.guide.empty()) require_guide_matters(spec);
  require_sampler(spec);

  Progress progress("downscale", spec.samples, global.quiet);
  progress.update(0, "loading " + options.image);
  const auto subject = load_subject(spec.subject);
  progress.clear();
  stop_if_interrupted();
  if (!global.quiet) {
    for (const auto& notice : subject->notices) fmt::print(stderr, "abn: {}: {}\n", options.image, notice);
    tell_fallback(spec.backend, strategy_info(spec), spec.reconstruction);
  }
  std::vector<std::string> names;
  for (const auto& metric : metrics()) names.push_back(metric.name);
  PointSet points;
  const bool keep_points = !options.points.empty() || !options.points_picture.empty();
  const RunResult result = run(spec, *subject, names, keep_points ? &points : nullptr, &progress);
  progress.clear();
  const bool estimated = !result.standard_error.cells().empty();
  if (!estimated && !estimate_flag.empty()) refuse_estimate(estimate_flag, result.reconstruction);
  std::optional<Reliability> calibration;
  if (estimated) calibration = reliability(result.standard_error, result.picture, subject->truth.image);
  if (!global.quiet) {
    for (const auto& diagnostic : result.diagnostics) {
      if (diagnostic.warning)
        fmt::print(stderr, "abn: {}: {}\n", options.strategy,
                   diagnostic.text.empty() ? diagnostic.name : diagnostic.text);
    }
  }

  if (!options.output.empty()) write_picture(options.output, result.picture, subject->high_dynamic_range);
  if (!options.error_map.empty())
    write_error_map(options.error_map, result.picture, subject->truth.image, options.gain);
  if (!options.estimated_error.empty())
    write_estimated_error(options.estimated_error, result.standard_error, options.gain);
  if (!options.reliability.empty()) write_reliability(options.reliability, *calibration, result);
  if (!options.points.empty()) {
    const std::string notice = write_points(options.points, points.view(), spec.subject.to, format_for(options.points));
    if (!notice.empty() && !global.quiet) fmt::print(stderr, "abn: {}: {}\n", options.points, notice);
  }
  if (!options.points_picture.empty())
    write_points_picture(options.points_picture, options.points_region, points, result);

  if (global.json) {
    Json json = to_json(result);
    if (calibration) json["calibration"] = to_json(*calibration);
    json["input_hash"] = result.source_hash;
    json["build"] = reproducibility_record();
    fmt::print("{}\n", json.dump());
  } else {
    print_result(result, calibration);
    for (const auto& output : outputs) fmt::print("  wrote {}\n", output.path);
  }
  return 0;
}

}  // namespace abn::harness
