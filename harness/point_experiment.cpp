#include "harness/point_experiment.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "harness/density.h"
#include "harness/experiment_loop.h"
#include "harness/point_gallery.h"
#include "harness/statistics.h"
#include "sampling/atomic_file.h"
#include "sampling/error.h"
#include "sampling/points_io.h"

namespace abn::harness {
namespace {

namespace fs = std::filesystem;

/// Column names: known before the first run, so that the CSV is append-only.
std::vector<std::string> csv_columns(const PointExperimentSpec& spec, const std::vector<PointRunSpec>& runs) {
  std::vector<std::string> columns = {"experiment",    "key",   "label", "strategy", "density",
                                      "density_floor", "count", "seed",  "backend",  "threads"};
  std::set<std::string> parameters;
  for (const auto& run : runs) {
    ParameterWords words = run.task.parameters;
    const Strategy& strategy = find_strategy(run.task.strategy, words);
    for (const auto& [key, value] : strategy.resolve(words)) parameters.insert("params." + key);
  }
  columns.insert(columns.end(), parameters.begin(), parameters.end());
  for (const auto& metric : spec.metrics) columns.push_back("scores." + metric);
  columns.insert(columns.end(), {"time.generate_s", "skipped", "diagnostics"});
  for (const auto& [name, value] : flatten({{"build", reproducibility_record()}})) columns.push_back(name);
  return columns;
}

Json to_row(const PointRunResult& result, const std::vector<std::string>& metrics) {
  const PointRunSpec& spec = result.spec;
  Json row = {{"label", spec.label},
              {"strategy", spec.task.strategy},
              {"density", spec.density},
              {"density_floor", spec.density_floor},
              {"count", result.drawn.set.position.size()},
              {"seed", spec.task.seed},
              {"backend", result.drawn.backend},
              {"threads", omp_get_max_threads()}};
  row["params"] = Json::object();
  for (const auto& [key, value] : result.drawn.parameters) row["params"][key] = value;
  row["scores"] = Json::object();
  for (const auto& metric : metrics) {
    const auto value = result.measures.values.find(metric);
    const bool defined = value != result.measures.values.end() && std::isfinite(value->second);
    row["scores"][metric] = defined ? Json(value->second) : Json(nullptr);
  }
  row["time"] = {{"generate_s", result.drawn.generate_s}};
  // As text: one CSV column for whatever was skipped.
  Json skipped = Json::array();
  for (const auto& [metric, reason] : result.measures.skipped) skipped.push_back(metric + ": " + reason);
  row["skipped"] = std::move(skipped);
  row["diagnostics"] = to_json(result.drawn.diagnostics);
  return row;
}

}  // namespace

PointRunResult run(const PointRunSpec& spec, std::shared_ptr<const Grid<float>> density,
                   const std::vector<std::string>& metrics) {
  PointRunResult result;
  result.spec = spec;
  PointTask task = spec.task;
  task.density = density;
  result.drawn = draw_points(task);
  const std::vector<analysis::Point> points = analysis::to_unit(result.drawn.set.position, result.drawn.plane);
  result.measures = measure(
      {.points = points, .density = std::move(density), .pixels = spec.pixels, .diagnostics = result.drawn.diagnostics},
      metrics);
  return result;
}

ExperimentOutcome run_experiment(const PointExperimentSpec& spec, const ExperimentOptions& options) {
  const std::vector<PointRunSpec> all = spec.expand();
  if (spec.images) require_own_pictures(spec);
  const ExperimentFolder folder(options);
  RowFile file(options.out, csv_columns(spec, all), options.resume);
  if (spec.images) fs::create_directories(options.out / "points");

  std::string density_word;
  std::shared_ptr<const Grid<float>> density;
  const auto do_run = [&](PointRunSpec run_spec) {
    run_spec.task.cache = options.cache;
    if (run_spec.density != density_word) {
      density = run_spec.density.empty() ? nullptr
                                         : load_density(run_spec.density, {.floor = run_spec.density_floor}).density;
      density_word = run_spec.density;
    }
    const PointRunResult result = run(run_spec, density, spec.metrics);
    // The points first: where there is a row, a resumed experiment finds what its pictures are drawn from.
    if (spec.images) {
      write_points(points_file(options.out, run_spec), result.drawn.set.view(), result.drawn.plane,
                   PointFormat::utk_bin);
    }
    return to_row(result, spec.metrics);
  };
  std::vector<Job> jobs;
  for (const PointRunSpec& run_spec : all) {
    jobs.push_back({.key = run_key(run_spec),
                    .detail = fmt::format("{} N={} seed {}", run_spec.label, run_spec.task.count, run_spec.task.seed),
                    .work = [&do_run, &run_spec] { return do_run(run_spec); }});
  }
  if (!options.quiet) tell_fallbacks(spec.backend, spec.strategies);
  Progress progress(spec.name, count_jobs(jobs, options, file), options.quiet);
  const LoopOutcome loop = run_jobs(spec.name, jobs, options, file, progress);

  ExperimentOutcome outcome;
  outcome.skipped = loop.skipped;
  outcome.stopped = loop.stopped;
  outcome.rows = file.rows().size();
  try {
    outcome.table = point_summary_table(file.rows(), spec.metrics);
    write_atomically(options.out / "table.md", outcome.table);
    if (spec.images && !loop.stopped) outcome.overview = draw_gallery(spec, options.out, file.rows());
  } catch (const Json::exception&) {
    throw IoError(fmt::format("{}: a line of it is no row of an experiment; remove it, then go on with --resume",
                              (options.out / "runs.jsonl").string()));
  }
  return outcome;
}

std::string point_summary_table(const std::vector<Json>& rows, const std::vector<std::string>& metrics) {
  struct Line {
    std::string label;
    std::map<std::string, std::vector<double>> values;
    std::vector<double> generate_ms;
  };
  using Key = std::pair<std::string, std::uint64_t>;
  std::vector<Key> order;
  std::map<Key, std::vector<Line>> tables;
  for (const auto& row : rows) {
    const Key key{row["density"], row["count"]};
    if (!tables.contains(key)) order.push_back(key);
    auto& lines = tables[key];
    const std::string label = row["label"];
    auto line = std::find_if(lines.begin(), lines.end(), [&](const Line& l) { return l.label == label; });
    if (line == lines.end()) line = lines.insert(lines.end(), Line{label, {}, {}});
    for (const auto& metric : metrics) {
      const auto& score = row["scores"].contains(metric) ? row["scores"][metric] : Json(nullptr);
      if (score.is_number()) line->values[metric].push_back(score);
    }
    line->generate_ms.push_back(1e3 * row["time"]["generate_s"].get<double>());
  }
  const auto cell = [](const Line& line, const std::string& metric) -> std::string {
    const auto values = line.values.find(metric);
    if (values == line.values.end()) return "–";
    const Summary summary = summarize(values->second);
    if (summary.count < 2) return fmt::format("{:.4g}", summary.mean);
    return fmt::format("{:.4g} ± {:.2g}", summary.mean, 0.5 * (summary.interval.high - summary.interval.low));
  };
  std::string text;
  for (const auto& key : order) {
    const auto& lines = tables[key];
    std::vector<std::string> defined;  // metrics that some line has
    for (const auto& metric : metrics) {
      if (std::any_of(lines.begin(), lines.end(), [&](const Line& line) { return line.values.contains(metric); }))
        defined.push_back(metric);
    }
    text += fmt::format("{}{} points: mean ± half of the 95 % interval over seeds\n\n",
                        key.first.empty() ? "" : key.first + ", ", key.second);
    std::size_t width = 8;
    for (const auto& line : lines) width = std::max(width, line.label.size());
    text += fmt::format("| {:<{}} |", "strategy", width);
    std::string rule = fmt::format("|{:-<{}}|", "", width + 2);
    std::vector<std::size_t> widths;
    for (const auto& metric : defined) {
      widths.push_back(std::max<std::size_t>(metric.size(), 19));
      text += fmt::format(" {:<{}} |", metric, widths.back());
      rule += fmt::format("{:-<{}}|", "", widths.back() + 2);
    }
    text += " seeds | generate ms |\n" + rule + "------:|------------:|\n";
    for (const auto& line : lines) {
      text += fmt::format("| {:<{}} |", line.label, width);
      for (std::size_t i = 0; i < defined.size(); ++i)
        text += fmt::format(" {:<{}} |", cell(line, defined[i]), widths[i]);
      text += fmt::format(" {:>5} | {:>11.1f} |\n", line.generate_ms.size(), summarize(line.generate_ms).mean);
    }
    text += '\n';
  }
  return text;
}

}  // namespace abn::harness
