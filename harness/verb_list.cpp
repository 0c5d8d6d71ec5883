// abn list and abn info: what there is.
#include <fmt/format.h>
#include <omp.h>

#include <cmath>
#include <functional>

#include "harness/data_path.h"
#include "harness/metrics.h"
#include "harness/point_metrics.h"
#include "harness/reconstruction.h"
#include "harness/record.h"
#include "harness/scenes.h"
#include "harness/verbs.h"
#include "sampling/disk_cache.h"
#include "sampling/error.h"
#include "sampling/pixel_filter.h"
#include "sampling/strategy.h"

namespace abn::harness {
namespace {

/// One kind of choice: how many rows, and each row as JSON with at least "name" and "summary".
struct Kind {
  std::string name;
  std::function<Json()> rows;
  std::function<void(Json&)> add_details = {};  // of the one row that is shown in full
};

std::string range_text(const FieldDescription& field) {
  if (!field.choices.empty()) return fmt::format("{}", fmt::join(field.choices, " | "));
  if (field.type != "number" && field.type != "integer") return field.type;
  const auto bound = [](double value) {
    return std::isinf(value) ? std::string(value < 0 ? "-inf" : "inf") : fmt::format("{:g}", value);
  };
  return fmt::format("{} in [{}, {}]", field.type, bound(field.lo), bound(field.hi));
}

Json strategy_rows() {
  Json rows = Json::array();
  for (const auto& strategy : strategies()) {
    const auto& info = strategy.info;
    Json parameters = Json::array();
    for (const auto& field : strategy.parameters) {
      parameters.push_back({{"name", field.name},
                            {"type", field.type},
                            {"default", field.default_value},
                            {"range", range_text(field)},
                            {"help", field.help}});
    }
    rows.push_back({{"name", info.name},
                    {"family", info.family},
                    {"summary", info.summary},
                    {"cite", info.cite},
                    {"advice", info.advice},
                    {"aliases", info.aliases},
                    {"adaptive", info.adaptive},
                    {"random", info.random},
                    {"reconstruction", info.reconstruction},
                    {"parameters", parameters}});
  }
  return rows;
}

Json scene_rows() {
  Json rows = Json::array();
  for (const auto& scene : scenes()) {
    rows.push_back({{"name", scene.name},
                    {"family", scene.kind},
                    {"summary", scene.summary},
                    {"cite", scene.cite},
                    {"channels", scene.channels},
                    {"high_dynamic_range", scene.high_dynamic_range}});
  }
  return rows;
}

/// The named crops of a scene: read from a file, so only for the one that is asked for.
void add_regions(Json& row) {
  row["regions"] = Json::array();
  for (const auto& region : regions(find_scene(row["name"].get<std::string>()))) row["regions"].push_back(region.name);
}

template <class Table>
Json plain_rows(const Table& table) {
  Json rows = Json::array();
  for (const auto& row : table) rows.push_back({{"name", row.name}, {"summary", row.summary}});
  return rows;
}

Json filter_rows() {
  Json rows = Json::array();
  for (const auto& row : filters()) {
    rows.push_back({{"name", row.name}, {"summary", row.summary}, {"defaults", row.parameters}});
  }
  return rows;
}

Json metric_rows() {
  Json rows = Json::array();
  for (const auto& metric : metrics()) {
    rows.push_back({{"name", metric.name},
                    {"summary", metric.summary},
                    {"unit", metric.unit},
                    {"cite", metric.cite},
                    {"smaller_is_better", metric.smaller_is_better}});
  }
  return rows;
}

/// Numbers of point sets: their group heads them in the list.
Json point_metric_rows() {
  Json rows = Json::array();
  for (const auto& metric : point_metrics()) {
    rows.push_back({{"name", metric.name}, {"family", metric.group}, {"summary", metric.good}, {"unit", metric.unit}});
  }
  return rows;
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> table = {
      {"strategies", strategy_rows}, {"scenes", scene_rows, add_regions},
      {"filters", filter_rows},      {"reconstructions", [] { return plain_rows(reconstructions()); }},
      {"metrics", metric_rows},      {"point_metrics", point_metric_rows},
  };
  return table;
}

void print_rows(const Json& rows) {
  std::string family;
  for (const auto& row : rows) {
    const std::string group = row.value("family", "");
    if (group != family) fmt::print("{}{}\n", family.empty() ? "" : "\n", group);
    family = group;
    fmt::print("  {:<18} {}\n", row["name"].get<std::string>(), row["summary"].get<std::string>());
  }
}

void print_one(const Json& row) {
  for (const auto& [key, value] : row.items()) {
    if (key == "parameters" || value.is_null() || (value.is_string() && value.get<std::string>().empty()) ||
        (value.is_array() && value.empty()))
      continue;
    std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    if (value.is_array()) text = fmt::format("{}", fmt::join(value.get<std::vector<std::string>>(), ", "));
    fmt::print("{:<18} {}\n", key, text);
  }
  if (!row.contains("parameters")) return;
  fmt::print("parameters{}\n", row["parameters"].empty() ? "         none" : "  (--set NAME=VALUE)");
  for (const auto& parameter : row["parameters"]) {
    fmt::print("  {:<18} default {:<12} {}  [{}]\n", parameter["name"].get<std::string>(),
               parameter["default"].get<std::string>(), parameter["help"].get<std::string>(),
               parameter["range"].get<std::string>());
  }
}

}  // namespace

int list(const GlobalOptions& global, const ListOptions& options) {
  if (options.kind.empty()) {
    Json all = Json::object();
    for (const auto& kind : kinds()) {
      for (const auto& row : kind.rows()) all[kind.name].push_back(row["name"]);
    }
    if (global.json) {
      fmt::print("{}\n", all.dump());
    } else {
      for (const auto& [kind, names] : all.items())
        fmt::print("{:<16} {}\n", kind, fmt::join(names.get<std::vector<std::string>>(), " "));
    }
    return 0;
  }
  std::string known;
  for (const auto& kind : kinds()) {
    known += " " + kind.name;
    if (kind.name != options.kind) continue;
    Json rows = kind.rows();
    if (options.name.empty()) {
      if (global.json) {
        fmt::print("{}\n", rows.dump());
      } else {
        print_rows(rows);
      }
      return 0;
    }
    std::string names;
    for (auto& row : rows) {
      const auto aliases = row.value("aliases", std::vector<std::string>{});
      names += " " + row["name"].get<std::string>();
      if (row["name"] != options.name && std::find(aliases.begin(), aliases.end(), options.name) == aliases.end())
        continue;
      if (kind.add_details) kind.add_details(row);
      if (global.json) {
        fmt::print("{}\n", row.dump());
      } else {
        print_one(row);
      }
      return 0;
    }
    throw ConfigError(fmt::format("there is no '{}' among the {}; known:{}", options.name, options.kind, names));
  }
  throw ConfigError(fmt::format("'{}' cannot be listed; known:{}", options.kind, known));
}

std::string version_text() {
  const Json& record = reproducibility_record();
  return fmt::format("abn {} ({})", record["version"].get<std::string>(), record["revision"].get<std::string>());
}

int info(const GlobalOptions& global) {
  Json json = reproducibility_record();
  json["threads"] = omp_get_max_threads();
  Json folders = Json::array();
  for (const auto& folder : data_folders()) folders.push_back(folder.string());
  json["data_folders"] = folders;
  const DiskCache cache(cache_folder());
  const DiskCache::Status status = cache.status();
  json["cache"] = {{"folder", cache.folder().string()},
                   {"writable", status.writable},
                   {"files", status.files},
                   {"bytes", status.bytes}};
  if (global.json) {
    fmt::print("{}\n", json.dump());
    return 0;
  }
  for (const auto& [key, value] : flatten(json)) fmt::print("{:<26} {}\n", key, value);
  return 0;
}

}  // namespace abn::harness
