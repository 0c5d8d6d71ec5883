#include "harness/record.h"

#include <fmt/format.h>
#include <Eigen/Core>
#include <boost/version.hpp>
#include <opencv2/core/version.hpp>

#include <cmath>
#include <fstream>

#include "abn_revision.h"
#include "harness/backend.h"
#include "harness/image_io.h"
#include "harness/reliability.h"

namespace abn::harness {
namespace {

std::string cpu_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const auto colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

}  // namespace

const Json& reproducibility_record() {
  static const Json record = {
      {"version", ABN_VERSION},
      {"revision", ABN_REVISION},
      {"build_type", ABN_BUILD_TYPE},
      {"compiler", fmt::format("g++ {}", __VERSION__)},
      {"cpu", cpu_name()},
      {"gpu", describe_gpu()},
      {"libraries",
       {{"openimageio", openimageio_version()},
        {"opencv", CV_VERSION},
        {"eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
        {"boost", fmt::format("{}.{}", BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000)},
        {"fmt", fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100)}}},
  };
  return record;
}

Json to_json(const std::vector<Diagnostic>& diagnostics) {
  Json json = Json::array();
  for (const auto& diagnostic : diagnostics) {
    Json item = {{"name", diagnostic.name}, {"value", number(diagnostic.value)}};
    if (!diagnostic.text.empty()) item["text"] = diagnostic.text;
    if (diagnostic.warning) item["warning"] = true;
    json.push_back(std::move(item));
  }
  return json;
}

Json to_json(const Reliability& curve) {
  return {{"rmse_ratio", number(curve.rmse_ratio())},
          {"worst_bin_factor", number(curve.worst_bin_factor())},
          {"log2_deviation", number(curve.log2_deviation())}};
}

Json to_json(const RunResult& result) {
  const RunSpec& spec = result.spec;
  const Extent to = spec.subject.to;
  Json json;
  json["strategy"] = spec.strategy;
  json["label"] = spec.label.empty() ? spec.strategy : spec.label;
  json["scene"] = spec.subject.scene;
  json["width"] = to.width;
  json["height"] = to.height;
  json["seed"] = spec.seed;
  json["samples"] = result.samples;
  json["spp"] = static_cast<double>(result.samples) / static_cast<double>(to.area());
  json["filter"] = spec.subject.filter;
  json["reconstruction"] = result.reconstruction;
  if (!spec.subject.guide.empty()) json["guide"] = spec.subject.guide;
  if (spec.target_error > 0) {
    json["target_error"] = spec.target_error;
    json["budget"] = spec.samples;
  }
  json["integrand"] = spec.subject.integrand;
  json["truth"] = spec.subject.truth;
  json["truth_standard_error"] = result.truth_standard_error;
  json["backend"] = result.backend;
  json["threads"] = result.threads;
  json["params"] = Json::object();
  for (const auto& [key, value] : result.parameters) json["params"][key] = value;
  json["scores"] = Json::object();
  for (const auto& score : result.scores) json["scores"][score.metric] = number(score.value);
  json["estimated_rmse"] = number(result.estimated_rmse);
  json["time"] = {{"generate_s", result.time.generate_s},
                  {"evaluate_s", result.time.evaluate_s},
                  {"reconstruct_s", result.time.reconstruct_s},
                  {"total_s", result.time.total_s},
                  {"cached", result.time.cached}};
  json["passes"] = result.passes;
  json["empty_pixels"] = result.empty_pixels;
  json["max_samples_per_pixel"] = result.max_samples_per_pixel;
  json["diagnostics"] = to_json(result.diagnostics);
  return json;
}

namespace {

void flatten_into(const Json& json, const std::string& prefix, std::map<std::string, std::string>& cells) {
  for (const auto& [key, value] : json.items()) {
    const std::string name = prefix.empty() ? key : prefix + "." + key;
    if (value.is_object()) {
      flatten_into(value, name, cells);
    } else if (value.is_string()) {
      cells[name] = value.get<std::string>();
    } else {
      cells[name] = value.is_null() ? "" : value.dump();
    }
  }
}

}  // namespace

std::map<std::string, std::string> flatten(const Json& json) {
  std::map<std::string, std::string> cells;
  flatten_into(json, "", cells);
  return cells;
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace abn::harness
