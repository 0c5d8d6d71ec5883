#include "harness/experiment.h"

#include <fmt/format.h>

#include <map>
#include <memory>

#include "harness/experiment_loop.h"
#include "harness/image_io.h"
#include "harness/output.h"
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
        "empty_pixels", "max_samples_per_pixel", "diagnostics", "input_hash", "truth_standard_error"}) {
    columns.emplace_back(name);
  }
  for (const auto& [name, value] : flatten({{"build", reproducibility_record()}})) columns.push_back(name);
  return columns;
}

std::string scene_name(const std::string& scene) {
  return scene.starts_with("scene:") ? scene.substr(6) : fs::path(scene).stem().string();
}

std::string picture_stem(const std::string& scene, std::uint64_t samples, const std::string& label) {
  return fmt::format("{}_{}_{}", scene_name(scene), samples, file_name(label));
}

/// Throws if the pictures of two runs would have the same name.
void require_own_pictures(const ExperimentSpec& spec) {
  std::map<std::string, std::string> owners;
  for (const auto& scene : spec.scenes) {
    for (const auto& choice : spec.strategies) {
      const std::string owner = fmt::format("'{}' of {}", choice.label, scene);
      const auto [other, is_new] = owners.emplace(picture_stem(scene, 0, choice.label), owner);
      if (is_new) continue;
      throw ConfigError(fmt::format(
          "the pictures of {} and {} would have the same file names; change a label or the name of an image",
          other->second, owner));
    }
  }
}

/// The result (EXR and PNG), the signed difference (EXR), the error map (PNG).
void save_pictures(const fs::path& folder, const RunResult& result, const Subject& subject, double gain) {
  const std::string stem = picture_stem(subject.spec.scene, result.spec.samples, result.spec.label);
  const auto path = [&](const char* ending) { return (folder / (stem + ending)).string(); };
  write_picture(path(".exr"), result.picture, subject.high_dynamic_range);
  write_picture(path(".png"), result.picture, subject.high_dynamic_range);
  write_error_map(path("_difference.exr"), result.picture, subject.truth.image, gain);
  write_error_map(path("_error.png"), result.picture, subject.truth.image, gain);
}

void save_truth(const fs::path& folder, const Subject& subject) {
  const std::string path = (folder / (scene_name(subject.spec.scene) + "_truth")).string();
  write_picture(path + ".exr", subject.truth.image, subject.high_dynamic_range);
  write_picture(path + ".png", subject.truth.image, subject.high_dynamic_range);
}

/// One sheet per scene and budget from the pictures on disk, so that a resumed experiment gets all of it. A sheet whose
/// pictures are not all there yet (another shard makes them) is left out. Returns the first one.
fs::path draw_overviews(const ExperimentSpec& spec, const fs::path& out, const std::vector<Json>& rows) {
  std::map<std::string, const Json*> first_seed_rows;
  for (const auto& row : rows) {
    if (row["seed"] == spec.first_seed)
      first_seed_rows[picture_stem(row["scene"], row["samples"], row["label"])] = &row;
  }
  fs::path first;
  for (const auto& scene : spec.scenes) {
    for (const std::uint64_t samples : spec.budgets) {
      std::vector<Exhibit> exhibits;
      for (const auto& choice : spec.strategies) {
        const std::string stem = picture_stem(scene, samples, choice.label);
        const fs::path picture = out / "images" / (stem + ".exr");
        const auto row = first_seed_rows.find(stem);
        if (row == first_seed_rows.end() || !fs::exists(picture)) break;
        const Json& rmse = (*row->second)["scores"].value("rmse", Json(nullptr));
        exhibits.push_back(
            {choice.label, load_image(picture.string()).image, rmse.is_number() ? rmse.get<double>() : 0.0});
      }
      if (exhibits.size() != spec.strategies.size()) continue;
      const LoadedImage truth = load_image((out / "images" / (scene_name(scene) + "_truth.exr")).string());
      bool above_one = false;
      for (const float value : truth.image.texels) above_one = above_one || value > 1.0F;
      const std::string title = fmt::format("{}: {}, {}x{}, {} samples", spec.title, scene_name(scene), spec.to.width,
                                            spec.to.height, samples);
      const Picture sheet = overview(title, truth.image, exhibits, above_one, spec.gain);
      const bool only_one = spec.scenes.size() * spec.budgets.size() == 1;
      const fs::path path =
          out / (only_one ? "overview.png" : fmt::format("overview_{}_{}.png", scene_name(scene), samples));
      save_rgb8(path.string(), sheet.size(), sheet.rgb);
      if (first.empty()) first = path;
    }
  }
  return first;
}

}  // namespace

ExperimentOutcome run_experiment(const ExperimentSpec& spec, const ExperimentOptions& options) {
  const std::vector<RunSpec> all = spec.expand();
  if (spec.images) require_own_pictures(spec);
  const ExperimentFolder folder(options);
  RowFile file(options.out, csv_columns(spec, all), options.resume);
  const fs::path images = options.out / "images";
  if (spec.images) fs::create_directories(images);

  Progress* bar = nullptr;
  std::unique_ptr<Subject> subject;
  const auto do_run = [&](const RunSpec& run_spec) {
    if (!subject || subject->spec != run_spec.subject) {
      subject.reset();  // one source at a time in memory
      subject = load_subject(run_spec.subject);
      bar->clear();
      if (!options.quiet) {
        for (const auto& notice : subject->notices) fmt::print(stderr, "abn: {}: {}\n", run_spec.subject.scene, notice);
      }
      if (spec.images) save_truth(images, *subject);
    }
    const RunResult result = run(run_spec, *subject, spec.metrics);
    Json row = to_json(result);
    row["input_hash"] = result.source_hash;
    // Pictures first: where there is a row, a resumed experiment finds its pictures.
    if (spec.images && run_spec.seed == spec.first_seed) save_pictures(images, result, *subject, spec.gain);
    return row;
  };
  std::vector<Job> jobs;
  for (const RunSpec& run_spec : all) {
    jobs.push_back(
        {.key = run_key(run_spec),
         .detail = fmt::format("{} {} seed {}", scene_name(run_spec.subject.scene), run_spec.label, run_spec.seed),
         .work = [&do_run, &run_spec] { return do_run(run_spec); }});
  }
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
    if (spec.images) outcome.overview = draw_overviews(spec, options.out, file.rows());
  } catch (const Json::exception&) {
    throw IoError(fmt::format("{}: a line of it is no row of an experiment; remove it, then go on with --resume",
                              (options.out / "runs.jsonl").string()));
  }
  return outcome;
}

}  // namespace abn::harness
