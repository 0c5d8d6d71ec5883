#include "harness/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "harness/statistics.h"

namespace abn::harness {
namespace {

struct Column {
  std::string label;
  std::map<std::uint64_t, double> rmse;  // by seed
  std::vector<double> generate_ms, total_ms;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

std::string error_cell(const Column& column) {
  std::vector<double> values;
  for (const auto& [seed, value] : column.rmse) values.push_back(value);
  const Summary summary = summarize(values);
  if (values.size() < 2) return fmt::format("{:.5f}", summary.mean);
  return fmt::format("{:.5f} ± {:.5f}", summary.mean, 0.5 * (summary.interval.high - summary.interval.low));
}

/// Ratio of errors over the seeds that both have; the verdict only where the interval excludes 1.
std::string ratio_cell(const Column& column, const Column& baseline) {
  if (&column == &baseline) return "1";
  std::vector<double> test;
  std::vector<double> reference;
  for (const auto& [seed, value] : column.rmse) {
    const auto other = baseline.rmse.find(seed);
    if (other == baseline.rmse.end()) continue;
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

}  // namespace

std::string summary_table(const std::vector<Json>& rows, const std::string& baseline) {
  using Key = std::tuple<std::string, std::uint64_t>;
  std::vector<Key> order;
  std::map<Key, std::vector<Column>> tables;
  for (const auto& row : rows) {
    const Key key{row["scene"], row["samples"]};
    if (!tables.contains(key)) order.push_back(key);
    auto& columns = tables[key];
    const std::string label = row["label"];
    auto column = std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.label == label; });
    if (column == columns.end())
      column = columns.insert(columns.end(), {.label = label, .rmse = {}, .generate_ms = {}, .total_ms = {}});
    const auto& score = row["scores"].contains("rmse") ? row["scores"]["rmse"] : Json(nullptr);
    if (score.is_number()) column->rmse[row["seed"]] = score;
    column->generate_ms.push_back(1e3 * row["time"]["generate_s"].get<double>());
    column->total_ms.push_back(1e3 * row["time"]["total_s"].get<double>());
  }

  std::string text;
  for (const auto& key : order) {
    const auto& columns = tables[key];
    const auto reference =
        std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.label == baseline; });
    const Column& base = reference == columns.end() ? columns.front() : *reference;
    text += fmt::format("{}, {} samples: RMSE in linear light, mean ± half of the 95 % interval over seeds\n\n",
                        std::get<0>(key), std::get<1>(key));
    std::size_t width = 8;
    for (const auto& column : columns) width = std::max(width, column.label.size());
    const std::string ratio_title = "RMSE / " + base.label + " [95 %]";
    text += fmt::format("| {:<{}} | {:<19} | {:<32} | seeds | generate ms | total ms |\n", "strategy", width, "RMSE",
                        ratio_title);
    text += fmt::format("|{:-<{}}|{:-<21}|{:-<34}|------:|------------:|---------:|\n", "", width + 2, "", "");
    for (const auto& column : columns) {
      text += fmt::format("| {:<{}} | {:<19} | {:<32} | {:>5} | {:>11.1f} | {:>8.1f} |\n", column.label, width,
                          column.rmse.empty() ? "–" : error_cell(column), ratio_cell(column, base),
                          column.generate_ms.size(), median(column.generate_ms), median(column.total_ms));
    }
    text += '\n';
  }
  return text;
}

}  // namespace abn::harness
