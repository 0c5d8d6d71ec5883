// abn downscale: one image, one strategy, one picture.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>

#include "harness/metrics.h"
#include "harness/output.h"
#include "harness/progress.h"
#include "harness/record.h"
#include "harness/run.h"
#include "harness/verbs.h"
#include "sampling/error.h"
#include "sampling/points_io.h"

namespace abn::harness {
namespace {

void print_result(const RunResult& result) {
  fmt::print("{} on {}, {}x{}, {} samples ({:g} per pixel), seed {}, reconstruction {}\n", result.spec.strategy,
             result.spec.subject.scene, result.spec.subject.to.width, result.spec.subject.to.height, result.samples,
             static_cast<double>(result.samples) / static_cast<double>(result.spec.subject.to.area()), result.spec.seed,
             result.reconstruction);
  for (const auto& score : result.scores) {
    const Metric& metric = find_metric(score.metric);
    fmt::print("  {:<16} {:>12}  {}\n", score.metric,
               std::isfinite(score.value) ? fmt::format("{:.6g}", score.value) : "–", metric.summary);
  }
  fmt::print(
      "  time             generate {:.1f} ms, evaluate {:.1f} ms, reconstruct {:.1f} ms, total {:.1f} ms ({} "
      "thread{})\n",
      1e3 * result.time.generate_s, 1e3 * result.time.evaluate_s, 1e3 * result.time.reconstruct_s,
      1e3 * result.time.total_s, result.threads, result.threads == 1 ? "" : "s");
}

/// Outputs are checked before the work: a wrong name must not cost minutes.
void check_outputs(const DownscaleOptions& options) {
  std::map<std::filesystem::path, std::string> flags;
  for (const auto& [flag, path] : {std::pair{"-o", options.output}, std::pair{"--error-map", options.error_map},
                                   std::pair{"--points", options.points}}) {
    if (path.empty()) continue;
    const auto [other, is_new] = flags.emplace(std::filesystem::path(path).lexically_normal(), flag);
    if (!is_new)
      throw ConfigError(fmt::format("{} and {} name the same file '{}'; give two", other->second, flag, path));
    if (std::string_view(flag) == "--points") {
      require_writable(path);
    } else {
      require_writable_image(path);
    }
  }
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

std::uint64_t parse_budget(const std::string& spp, std::uint64_t samples, std::uint64_t area) {
  if (samples > 0) return samples;
  double value = 6;
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
  spec.samples = parse_budget(options.spp, options.samples, spec.subject.to.area());
  spec.seed = options.seed;
  spec.reconstruction = options.reconstruction;
  spec.backend = global.backend;
  validate(spec);
  check_outputs(options);
  require_sampler(spec);

  Progress progress("downscale", spec.samples, global.quiet);
  progress.update(0, "loading " + options.image);
  const auto subject = load_subject(spec.subject);
  progress.clear();
  stop_if_interrupted();
  if (!global.quiet) {
    for (const auto& notice : subject->notices) fmt::print(stderr, "abn: {}: {}\n", options.image, notice);
  }
  std::vector<std::string> names;
  for (const auto& metric : metrics()) names.push_back(metric.name);
  PointSet points;
  const RunResult result = run(spec, *subject, names, options.points.empty() ? nullptr : &points, &progress);
  progress.clear();
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
  if (!options.points.empty()) {
    const std::string notice = write_points(options.points, points.view(), spec.subject.to, format_for(options.points));
    if (!notice.empty() && !global.quiet) fmt::print(stderr, "abn: {}: {}\n", options.points, notice);
  }

  if (global.json) {
    Json json = to_json(result);
    json["input_hash"] = result.source_hash;
    json["build"] = reproducibility_record();
    fmt::print("{}\n", json.dump());
  } else {
    print_result(result);
    for (const auto& path : {options.output, options.error_map, options.points}) {
      if (!path.empty()) fmt::print("  wrote {}\n", path);
    }
  }
  return 0;
}

}  // namespace abn::harness
