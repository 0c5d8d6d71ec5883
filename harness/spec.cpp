#include "harness/spec.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "harness/crops.h"
#include "harness/data_path.h"
#include "harness/metrics.h"
#include "harness/toml_reader.h"
#include "sampling/error.h"
#include "sampling/pixel_filter.h"

namespace abn::harness {
namespace {

std::string known_experiments() {
  std::set<std::string> names;
  for (const auto& folder : data_folders()) {
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "experiments", none))
      if (entry.path().extension() == ".toml") names.insert(entry.path().stem().string());
  }
  return fmt::format("{}", fmt::join(names, " "));
}

/// A file is named relative to the spec, so that the pair can be moved together.
std::string beside(const std::filesystem::path& spec, const std::string& file) {
  return std::filesystem::path(file).is_relative() ? (spec.parent_path() / file).lexically_normal().string() : file;
}

/// Throws unless every crop is a region of one of the scenes.
void require_crops(const ExperimentSpec& spec) {
  require_distinct(spec.crops, "crops");
  for (const auto& crop : spec.crops) {
    std::vector<std::string> known;
    bool found = false;
    for (const auto& scene : spec.scenes) {
      found |= !named_regions(scene, {crop}).empty();
      if (!scene.starts_with("scene:")) continue;
      for (const auto& region : regions(find_scene(scene.substr(6)))) known.push_back(region.name);
    }
    if (!found) {
      throw ConfigError(fmt::format("'crops' names '{}', and no scene has a region of that name; known: {}", crop,
                                    known.empty() ? "none" : fmt::format("{}", fmt::join(known, " "))));
    }
  }
  if (spec.zoom > 100) throw ConfigError(fmt::format("'zoom' is {}; give a whole number from 1 to 100", spec.zoom));
  if (spec.sample_pictures && !spec.images)
    throw ConfigError("sample_pictures = true without images; add images = true");
}

}  // namespace

std::filesystem::path find_experiment(const std::string& word) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(word, ignored)) return word;
  const bool bare = word.find('/') == std::string::npos && !word.ends_with(".toml");
  if (!bare)
    throw IoError(fmt::format(
        "{}: no such experiment file; give a path, or a name from the experiments folder such as main", word));
  try {
    return find_data(std::filesystem::path("experiments") / (word + ".toml"));
  } catch (const IoError&) {
    throw IoError(fmt::format("there is no experiment '{}'; known: {}; or give the path of a TOML file", word,
                              known_experiments()));
  }
}

ExperimentSpec load_experiment(const std::filesystem::path& path) {
  const std::string file = path.string();
  const toml::table table = parse_experiment_file(path);
  TableReader reader(table, file);
  if (reader.text("kind", "images") != "images") {
    throw ConfigError(fmt::format("{}: this experiment is of another kind than images; abn run runs it", file));
  }
  ExperimentSpec spec;
  spec.name = reader.text("name", path.stem().string());
  spec.title = reader.text("title", spec.name);
  spec.thesis = reader.text("thesis", "");
  spec.to = parse_extent(reader.text("to", "200x200"), file + ": 'to'");
  spec.truth = reader.text("truth", spec.truth);
  spec.integrand = reader.text("integrand", spec.integrand);
  spec.reconstruction = reader.text("reconstruction", spec.reconstruction);
  spec.on_nonfinite = reader.text("on_nonfinite", spec.on_nonfinite);
  spec.backend = reader.text("backend", spec.backend);
  spec.seeds = reader.whole("seeds", 1, 1);
  spec.first_seed = reader.whole("first_seed", 1, 0);
  spec.images = reader.boolean("images", false);
  spec.gain = reader.number("gain", 10, 1e-6, 1e6);
  spec.crops = reader.texts("crops");
  spec.zoom = reader.whole("zoom", 8, 1);
  spec.sample_pictures = reader.boolean("sample_pictures", false);
  spec.guide = reader.text("guide", "");
  if (!spec.guide.empty() && spec.guide != "true_variance") spec.guide = beside(path, spec.guide);
  spec.target_error = reader.number("target_error", 0, 0, 1e6);
  spec.baseline = reader.text("baseline", "");
  spec.metrics = reader.texts("metrics");
  if (const auto filters = reader.texts("filter"); !filters.empty()) spec.filters = filters;

  for (const std::string& scene : reader.texts("scenes")) {
    spec.scenes.push_back(scene.starts_with("scene:") ? scene : beside(path, scene));
  }
  if (spec.scenes.empty())
    throw ConfigError(fmt::format("{}: no scenes; add scenes = [\"scene:apple\"] (abn list scenes)", file));

  const auto spp = reader.list("spp", "a number > 0, or a list of such", [](const toml::node& n) {
    const auto value = n.is_number() ? n.value<double>() : std::nullopt;
    return value && *value > 0 && *value <= 1e9 ? value : std::nullopt;
  });
  const auto samples = reader.list("samples", "a whole number >= 1, or a list of such", [](const toml::node& n) {
    const auto value = n.value_exact<std::int64_t>();
    return value && *value >= 1 ? value : std::nullopt;
  });
  if (spp.empty() == samples.empty())
    throw ConfigError(
        fmt::format("{}: give either spp = [6] or samples = [240000]{}", file, spp.empty() ? "" : ", not both"));
  for (const double value : spp) {
    const double budget = value * static_cast<double>(spec.to.area());
    if (budget != std::floor(budget)) {
      throw ConfigError(fmt::format("{}: spp = {} gives {} samples on {}x{}, which is not whole; use samples = [{}]",
                                    file, value, budget, spec.to.width, spec.to.height, std::llround(budget)));
    }
    spec.budgets.push_back(static_cast<std::uint64_t>(budget));
  }
  for (const std::int64_t value : samples) spec.budgets.push_back(static_cast<std::uint64_t>(value));

  spec.strategies = read_strategies(reader, file);
  reader.refuse_unknown("the experiment");
  if (spec.metrics.empty()) {
    for (const auto& metric : metrics()) spec.metrics.push_back(metric.name);
  }
  try {
    validate(spec);
  } catch (const ConfigError& error) {
    throw ConfigError(fmt::format("{}: {}", file, error.what()));
  }
  return spec;
}

void apply_override(std::vector<StrategyChoice>& strategies, const std::string& assignment) {
  const auto equals = assignment.find('=');
  const auto dot = assignment.rfind('.', equals);
  if (equals == std::string::npos || dot == std::string::npos || dot == 0 || dot + 1 == equals) {
    throw ConfigError(
        fmt::format("--set is '{}'; give STRATEGY.KEY=VALUE, e.g. sph_blue_noise.iterations=50", assignment));
  }
  const std::string name = assignment.substr(0, dot);
  bool found = false;
  for (auto& choice : strategies) {
    if (choice.name != name && choice.label != name) continue;
    choice.parameters[assignment.substr(dot + 1, equals - dot - 1)] = assignment.substr(equals + 1);
    found = true;
  }
  if (!found) {
    std::vector<std::string> names;
    for (const auto& choice : strategies) names.push_back(choice.label);
    throw ConfigError(fmt::format("--set {}: the experiment has no strategy '{}'; it has: {}", assignment, name,
                                  fmt::join(names, ", ")));
  }
}

std::vector<RunSpec> ExperimentSpec::expand() const {
  std::vector<RunSpec> runs;
  const auto add = [&](const SubjectSpec& subject, std::uint64_t budget, const StrategyChoice& choice) {
    for (std::uint64_t k = 0; k < seeds; ++k) {
      RunSpec run;
      run.label = choice.label;
      run.strategy = choice.name;
      run.parameters = choice.parameters;
      run.subject = subject;
      run.samples = budget;
      run.seed = first_seed + k;
      run.reconstruction = choice.reconstruction.empty() ? reconstruction : choice.reconstruction;
      run.backend = backend;
      run.target_error = target_error;
      runs.push_back(std::move(run));
    }
  };
  for (const auto& scene : scenes) {
    for (const auto& filter : filters) {
      const SubjectSpec subject = {.scene = scene,
                                   .to = to,
                                   .integrand = integrand,
                                   .truth = truth,
                                   .filter = filter,
                                   .channels = {},
                                   .on_nonfinite = on_nonfinite,
                                   .guide = guide};
      for (const std::uint64_t budget : budgets) {
        for (const auto& choice : strategies) add(subject, budget, choice);
      }
    }
  }
  return runs;
}

void validate(const ExperimentSpec& spec) {
  require_names(spec.name, spec.strategies);
  for (const auto& metric : spec.metrics) find_metric(metric);
  require_distinct(spec.metrics, "metrics");
  require_distinct(spec.scenes, "scenes");
  require_distinct(spec.budgets, "samples or spp");
  require_crops(spec);
  std::vector<std::string> filters;  // spelled out: "gaussian" and "gaussian:sigma=0.5" are the same
  for (const auto& filter : spec.filters) filters.push_back(make_filter(filter)->words());
  require_distinct(filters, "filter");
  std::set<std::string> labels;
  for (const auto& choice : spec.strategies) labels.insert(choice.label);
  if (!spec.baseline.empty() && !labels.contains(spec.baseline)) {
    throw ConfigError(
        fmt::format("baseline '{}' is no strategy's label; labels: {}", spec.baseline, fmt::join(labels, ", ")));
  }
  if (spec.seeds > 1000000) throw ConfigError("'seeds' must be at most 1000000");
  // One seed stands for all: words do not depend on it. Building the sampler also checks that the budget can be met.
  ExperimentSpec one_seed = spec;
  one_seed.seeds = 1;
  for (const auto& run : one_seed.expand()) {
    validate(run);
    require_sampler(run);
    require_scene(run.subject.scene);
  }
}

}  // namespace abn::harness
