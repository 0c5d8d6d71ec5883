// An experiment as a person writes it (TOML), validated as a whole before anything runs.
//
//   kind = "images"                      # the default; "points": harness/point_spec.h
//   name = "fig_4_2"                     # names the output folder
//   title = "…"   thesis = "fig. 4.2"    # for tables and reports
//   scenes = ["scene:apple"]             # scenes and image files (relative to the spec)
//   to = "200x200"
//   spp = [6]                            # or samples = [240000]
//   seeds = 20        first_seed = 1
//   truth = "exact"   integrand = "nearest"   reconstruction = "auto"   on_nonfinite = "refuse"
//   filter = "box"                       # or a list of such; each is measured against its own truth
//   metrics = ["rmse", "mae"]            # default: all
//   images = true     gain = 10          # keep pictures and error maps of the first seed
//   crops = ["stalk"]  zoom = 8          # named regions (abn list scenes apple): RMSE inside, and sheets with images
//   sample_pictures = true               # with images: the samples of the first seed, ghost particles in blue
//   guide = "edges.png"                  # an image file (relative to the spec) or true_variance
//   target_error = 0.01                  # stop at that estimated RMSE; the budget is the most it may take
//   baseline = "jitter 3x2"              # label that ratios refer to; default: the first strategy
//   [[strategy]]
//   name = "jitter"   label = "jitter 3x2"
//   set = { key = "value" }
//   reconstruction = "kriging"           # of this strategy; default: the experiment's
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "harness/run.h"

namespace abn::harness {

struct StrategyChoice {
  std::string name;
  std::string label;
  ParameterWords parameters;
  std::string reconstruction = {};  // empty = the experiment's
};

struct ExperimentSpec {
  std::string name, title, thesis;
  std::vector<std::string> scenes;
  Extent to = {200, 200};
  std::vector<std::uint64_t> budgets;  // samples, in the order given
  std::uint64_t seeds = 1;
  std::uint64_t first_seed = 1;
  std::vector<std::string> filters = {"box"};  // in the order given
  std::string truth = "exact", integrand = "nearest", reconstruction = "auto", on_nonfinite = "refuse";
  std::string backend = "auto";
  std::vector<std::string> metrics;
  bool images = false;
  double gain = 10;
  std::vector<std::string> crops;  // names of regions
  std::uint64_t zoom = 8;          // of the crops
  bool sample_pictures = false;
  std::string guide;
  double target_error = 0;  // 0 = spend the budget
  std::string baseline;
  std::vector<StrategyChoice> strategies;

  /// All runs in fixed order: scene, filter, budget, strategy, seed. Runs on the same subject follow each other.
  std::vector<RunSpec> expand() const;
};

/// Where a spec lies: a path as given, or a bare name ("main") among the installed experiments. Throws IoError.
std::filesystem::path find_experiment(const std::string& word);

/// Reads and validates everything: every key, word and budget. Throws ConfigError (file, line, key, remedy) or IoError.
ExperimentSpec load_experiment(const std::filesystem::path& file);

/// Applies one `--set STRATEGY.KEY=VALUE` to every entry of that strategy (by name or label). Throws ConfigError.
void apply_override(std::vector<StrategyChoice>& strategies, const std::string& assignment);
inline void apply_override(ExperimentSpec& spec, const std::string& assignment) {
  apply_override(spec.strategies, assignment);
}

/// Validates every run of an experiment. Throws ConfigError.
void validate(const ExperimentSpec& spec);

}  // namespace abn::harness
