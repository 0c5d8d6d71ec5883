#include "harness/experiment.h"

#include <fmt/format.h>

#include <map>
#include <memory>

#include "harness/crops.h"
#include "harness/experiment_loop.h"
#include "harness/experiment_pictures.h"
#include "harness/reliability.h"
#include "harness/summary.h"
#include "sampling/atomic_file.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

namespace fs = std::filesystem;

/// Column names: known before the first run, so that the CSV is append-only.
std::vector<std::string> csv_columns(const ExperimentSpec& spec, const std::vector<RunSpec>& runs) {
  std::vector<std::string> columns = {"experiment", "key",   "label",   "strategy", "scene",  "width",
                                      "height",     "seed",  "samples", "spp",      "filter", "reconstruction",
                                      "integrand",  "truth", "backend", "threads"};
  std::map<std::string, bool> parameters;
  for (const auto& run : runs) {
    ParameterWords words = run.parameters;
    const Strategy& strategy = find_strategy(run.strategy, words);
    for (const auto& [key, value] : strategy.resolve(words)) parameters["params." + key] = true;
  }
  for (const auto& [name, known] : parameters) columns.push_back(name);
  for (const auto& metric : spec.metrics) columns.push_back("scores." + metric);
  for (const char* name :
       {"time.generate_s", "time.evaluate_s", "time.reconstruct_s", "time.total_s", "time.cached", "passes",
        "empty_pixels", "max_samples_per_pixel", "diagnostics", "input_hash", "truth_standard_error", "estimated_rmse",
        "calibration.rmse_ratio", "calibration.worst_bin_factor", "calibration.log2_deviation"}) {
    columns.emplace_back(name);
  }
  for (const auto& crop : spec.crops) columns.push_back("regions." + crop);
  if (!spec.guide.empty()) columns.emplace_back("guide");
  if (spec.target_error > 0) columns.insert(columns.end(), {"target_error", "budget"});
  for (const auto& [name, value] : flatten({{"build", reproducibility_record()}})) columns.push_back(name);
  return columns;
}

/// The RMSE inside every crop of the scene.
Json region_errors(const ExperimentSpec& spec, const RunResult& result, const Subject& subject) {
  Json errors = Json::object();
  for (const Region& region : named_regions(subject.spec.scene, spec.crops)) {
    errors[region.name] = rmse_inside(result.picture, subject.truth.image, pixels_of(region, result.picture.size));
  }
  return errors;
}

}  // namespace

ExperimentOutcome run_experiment(const ExperimentSpec& spec, const ExperimentOptions& options) {
  const std::vector<RunSpec> all = spec.expand();
  const ExperimentPictures pictures(spec, options.out);
  const ExperimentFolder folder(options);
  RowFile file(options.out, csv_columns(spec, all), options.resume);

  Progress* bar = nullptr;
  std::unique_ptr<Subject> subject;
  const auto do_run = [&](RunSpec run_spec) {
    run_spec.cache = options.cache;
    if (!subject || subject->spec != run_spec.subject) {
      subject.reset();  // one source at a time in memory
      subject = load_subject(run_spec.subject);
      bar->clear();
      if (!options.quiet) {
        for (const auto& notice : subject->notices) fmt::print(stderr, "abn: {}: {}\n", run_spec.subject.scene, notice);
      }
      pictures.save_truth(*subject);
    }
    PointSet samples;
    const bool keep_samples = spec.sample_pictures && pictures.wants(run_spec);
    const RunResult result = run(run_spec, *subject, spec.metrics, keep_samples ? &samples : nullptr);
    Json row = to_json(result);
    if (!result.standard_error.cells().empty())
      row["calibration"] = to_json(reliability(result.standard_error, result.picture, subject->truth.image));
    if (!spec.crops.empty()) row["regions"] = region_errors(spec, result, *subject);
    row["input_hash"] = result.source_hash;
    // Pictures first: where there is a row, a resumed experiment finds its pictures.
    if (pictures.wants(run_spec)) pictures.save(result, *subject, samples);
    return row;
  };
  std::vector<Job> jobs;
  for (const RunSpec& run_spec : all) {
    jobs.push_back(
        {.key = run_key(run_spec),
         .detail = fmt::format("{} {} seed {}", scene_name(run_spec.subject.scene), run_spec.label, run_spec.seed),
         .work = [&do_run, &run_spec] { return do_run(run_spec); }});
  }
  if (!options.quiet) tell_fallbacks(spec.backend, spec.strategies, spec.reconstruction);
  Progress progress(spec.name, count_jobs(jobs, options, file), options.quiet);
  bar = &progress;
  const LoopOutcome loop = run_jobs(spec.name, jobs, options, file, progress);

  ExperimentOutcome outcome;
  outcome.skipped = loop.skipped;
  outcome.stopped = loop.stopped;
  outcome.rows = file.rows().size();
  try {
    outcome.table = summary_table(file.rows(), spec.baseline);
    write_atomically(options.out / "table.md", outcome.table);
    outcome.overview = pictures.draw_sheets(file.rows());
  } catch (const Json::exception&) {
    throw IoError(fmt::format("{}: a line of it is no row of an experiment; remove it, then go on with --resume",
                              (options.out / "runs.jsonl").string()));
  }
  return outcome;
}

}  // namespace abn::harness
