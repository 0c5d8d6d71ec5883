#include "harness/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <compare>
#include <map>
#include <set>

#include "harness/statistics.h"

namespace abn::harness {
namespace {

/// Errors of one kind by seed.
using Errors = std::map<std::uint64_t, double>;

struct Column {
  std::string label;
  Errors rmse;
  std::map<std::string, Errors> regions;  // RMSE inside a crop
  std::vector<double> generate_ms, total_ms;
  std::vector<double> spp;          // actual, where a run may stop before its budget
  std::vector<double> calibration;  // estimated RMSE / true RMSE
};

/// What the strategies of one table have in common.
struct Key {
  std::string scene, filter;
  std::uint64_t budget = 0;  // samples
  friend auto operator<=>(const Key&, const Key&) = default;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

std::string error_cell(const Errors& errors) {
  if (errors.empty()) return "–";
  std::vector<double> values;
  for (const auto& [seed, value] : errors) values.push_back(value);
  const Summary summary = summarize(values);
  if (values.size() < 2) return fmt::format("{:.5f}", summary.mean);
  return fmt::format("{:.5f} ± {:.5f}", summary.mean, 0.5 * (summary.interval.high - summary.interval.low));
}

/// Ratio of errors over the seeds that both have; the verdict only where the interval excludes 1.
std::string ratio_cell(const Errors& errors, const Errors& baseline) {
  if (&errors == &baseline) return "1";
  std::vector<double> test;
  std::vector<double> reference;
  for (const auto& [seed, value] : errors) {
    const auto other = baseline.find(seed);
    if (other == baseline.end()) continue;
    test.push_back(value);
    reference.push_back(other->second);
  }
  if (test.empty()) return "–";
  const PairedComparison comparison = compare_paired(test, reference);
  if (comparison.count == 0) return "– (one error is 0)";
  if (comparison.count < 2) return fmt::format("{:.3f}", comparison.ratio);
  const char* verdict = !comparison.interval_excludes_one() ? "" : comparison.interval.high < 1 ? " better" : " worse";
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]{}", comparison.ratio, comparison.interval.low, comparison.interval.high,
                     verdict);
}

/// The rows of one strategy and subject gathered.
void add_row(Column& column, const Json& row) {
  const std::uint64_t seed = row["seed"];
  const auto& score = row["scores"].contains("rmse") ? row["scores"]["rmse"] : Json(nullptr);
  if (score.is_number()) column.rmse[seed] = score;
  if (row.contains("regions")) {
    for (const auto& [name, value] : row["regions"].items())
      if (value.is_number()) column.regions[name][seed] = value;
  }
  column.generate_ms.push_back(1e3 * row["time"]["generate_s"].get<double>());
  column.total_ms.push_back(1e3 * row["time"]["total_s"].get<double>());
  if (row.contains("budget")) column.spp.push_back(row["spp"]);
  if (row.contains("calibration") && row["calibration"]["rmse_ratio"].is_number())
    column.calibration.push_back(row["calibration"]["rmse_ratio"]);
}

/// Columns that only some experiments have: title, and the cell of a strategy.
struct Extra {
  std::string title;
  std::vector<double> Column::*values;
  int decimals;
};

std::string main_table(const std::vector<Column>& columns, const Column& base) {
  static const std::vector<Extra> kExtras = {{"spp", &Column::spp, 2}, {"estimated / true", &Column::calibration, 3}};
  std::vector<Extra> extras;
  for (const Extra& extra : kExtras) {
    if (std::any_of(columns.begin(), columns.end(), [&](const Column& c) { return !(c.*extra.values).empty(); }))
      extras.push_back(extra);
  }
  std::size_t width = 8;
  for (const auto& column : columns) width = std::max(width, column.label.size());
  std::string text =
      fmt::format("| {:<{}} | {:<19} | {:<32} |", "strategy", width, "RMSE", "RMSE / " + base.label + " [95 %]");
  std::string line = fmt::format("|{:-<{}}|{:-<21}|{:-<34}|", "", width + 2, "", "");
  for (const Extra& extra : extras) {
    text += fmt::format(" {} |", extra.title);
    line += fmt::format("{:->{}}:|", "", extra.title.size() + 1);
  }
  text += " seeds | generate ms | total ms |\n" + line + "------:|------------:|---------:|\n";
  for (const auto& column : columns) {
    text += fmt::format("| {:<{}} | {:<19} | {:<32} |", column.label, width, error_cell(column.rmse),
                        ratio_cell(column.rmse, base.rmse));
    for (const Extra& extra : extras) {
      const auto& values = column.*extra.values;
      const std::string cell =
          values.empty() ? std::string("–") : fmt::format("{:.{}f}", summarize(values).mean, extra.decimals);
      text += fmt::format(" {:>{}} |", cell, extra.title.size());
    }
    text += fmt::format(" {:>5} | {:>11.1f} | {:>8.1f} |\n", column.generate_ms.size(), median(column.generate_ms),
                        median(column.total_ms));
  }
  return text;
}

/// The same errors inside every crop; empty if there is none.
std::string region_table(const std::vector<Column>& columns, const Column& base) {
  std::vector<std::string> names;
  std::size_t name_width = 6;
  std::size_t width = 8;
  for (const auto& column : columns) {
    width = std::max(width, column.label.size());
    for (const auto& [name, errors] : column.regions) {
      name_width = std::max(name_width, name.size());
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  if (names.empty()) return "";
  std::string text = fmt::format("\n| {:<{}} | {:<{}} | {:<19} | {:<32} |\n|{:-<{}}|{:-<{}}|{:-<21}|{:-<34}|\n",
                                 "region", name_width, "strategy", width, "RMSE inside",
                                 "RMSE / " + base.label + " [95 %]", "", name_width + 2, "", width + 2, "", "");
  static const Errors kNone;
  for (const auto& name : names) {
    const auto errors_of = [&](const Column& column) -> const Errors& {
      const auto found = column.regions.find(name);
      return found == column.regions.end() ? kNone : found->second;
    };
    for (const auto& column : columns) {
      text += fmt::format("| {:<{}} | {:<{}} | {:<19} | {:<32} |\n", name, name_width, column.label, width,
                          error_cell(errors_of(column)), ratio_cell(errors_of(column), errors_of(base)));
    }
  }
  return text;
}

}  // namespace

std::string summary_table(const std::vector<Json>& rows, const std::string& baseline) {
  std::vector<Key> order;
  std::map<Key, std::vector<Column>> tables;
  std::set<std::string> filters;
  for (const auto& row : rows) {
    const Key key{row["scene"], row.value("filter", "box"), row.value("budget", row["samples"].get<std::uint64_t>())};
    filters.insert(key.filter);
    if (!tables.contains(key)) order.push_back(key);
    auto& columns = tables[key];
    const std::string label = row["label"];
    auto column = std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.label == label; });
    if (column == columns.end()) {
      column = columns.insert(columns.end(), Column{});
      column->label = label;
    }
    add_row(*column, row);
  }

  std::string text;
  for (const auto& key : order) {
    const auto& columns = tables[key];
    const auto reference =
        std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.label == baseline; });
    const Column& base = reference == columns.end() ? columns.front() : *reference;
    text += fmt::format("{}, {}{} samples: RMSE in linear light, mean ± half of the 95 % interval over seeds\n\n",
                        key.scene, filters.size() > 1 ? "filter " + key.filter + ", " : "", key.budget);
    text += main_table(columns, base) + region_table(columns, base) + '\n';
  }
  return text;
}

}  // namespace abn::harness
