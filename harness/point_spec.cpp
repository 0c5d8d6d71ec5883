#include "harness/point_spec.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "harness/backend.h"
#include "harness/point_metrics.h"
#include "harness/rows.h"
#include "harness/run.h"
#include "harness/toml_reader.h"
#include "sampling/error.h"
#include "sampling/sph/size_field_cases.h"

namespace abn::harness {
namespace {

/// [sweep]: STRATEGY.KEY = [values]; TOML makes a table of tables of it.
std::vector<SweepAxis> read_sweep(TableReader& reader, const std::string& file) {
  std::vector<SweepAxis> sweep;
  const toml::node* node = reader.find("sweep");
  if (node == nullptr) return sweep;
  const auto wanted = [&](const toml::node& at) {
    return ConfigError(fmt::format("{}:{}: 'sweep' must hold lines such as sph_blue_noise.delta = [0.1, 0.3]", file,
                                   at.source().begin.line));
  };
  if (!node->is_table()) throw wanted(*node);
  for (const auto& [strategy, keys] : *node->as_table()) {
    if (!keys.is_table()) throw wanted(keys);
    for (const auto& [key, values] : *keys.as_table()) {
      const toml::array* array = values.as_array();
      if (array == nullptr || array->empty()) throw wanted(values);
      SweepAxis axis{std::string(strategy.str()), std::string(key.str()), {}};
      for (const auto& value : *array) axis.values.push_back(word_of(reader, axis.key, value));
      require_distinct(axis.values, axis.strategy + "." + axis.key);
      sweep.push_back(std::move(axis));
    }
  }
  // TOML tables are sorted by key; the order of the file is the order in which a person thinks of them.
  const auto line_of = [&](const SweepAxis& axis) {
    return node->as_table()->get(axis.strategy)->as_table()->get(axis.key)->source().begin;
  };
  std::stable_sort(sweep.begin(), sweep.end(), [&](const SweepAxis& a, const SweepAxis& b) {
    const auto left = line_of(a);
    const auto right = line_of(b);
    return left.line != right.line ? left.line < right.line : left.column < right.column;
  });
  return sweep;
}

/// Throws if a density's name is wrong; the image is read when its turn comes.
void require_density(const std::string& word) {
  if (word.empty()) return;
  if (word.starts_with("size:")) {
    static_cast<void>(sph::make_size_field(word.substr(5), {1, 1}));
    return;
  }
  require_scene(word);
}

}  // namespace

std::string canonical(const PointRunSpec& spec) {
  ParameterWords words = spec.task.parameters;
  const Strategy& strategy = find_strategy(spec.task.strategy, words);
  nlohmann::json json;
  json["strategy"] = strategy.info.name;
  json["params"] = strategy.resolve(words);
  json["density"] = spec.density;
  json["density_floor"] = spec.density_floor;
  json["pixels"] = {spec.pixels.width, spec.pixels.height};
  json["count"] = spec.task.count;
  json["seed"] = spec.task.seed;
  json["backend"] = resolve_backend(spec.task.backend).name;
  return json.dump();
}

std::string run_key(const PointRunSpec& spec) { return hash_key(canonical(spec)); }

std::vector<StrategyChoice> PointExperimentSpec::choices() const {
  std::vector<StrategyChoice> all;
  for (const auto& choice : strategies) {
    std::vector<StrategyChoice> variants = {choice};
    for (const auto& axis : sweep) {
      if (axis.strategy != choice.name && axis.strategy != choice.label) continue;
      std::vector<StrategyChoice> more;
      for (const auto& variant : variants) {
        for (const auto& value : axis.values) {
          more.push_back(variant);
          more.back().parameters[axis.key] = value;
          more.back().label += fmt::format(" {}={}", axis.key, value);
        }
      }
      variants = std::move(more);
    }
    all.insert(all.end(), variants.begin(), variants.end());
  }
  return all;
}

std::uint64_t PointExperimentSpec::seeds_of(const StrategyChoice& choice) const {
  ParameterWords words = choice.parameters;
  return find_strategy(choice.name, words).info.random ? seeds : 1;
}

std::vector<PointRunSpec> PointExperimentSpec::expand() const {
  std::vector<PointRunSpec> runs;
  const std::vector<StrategyChoice> all = choices();
  for (const auto& density : densities) {
    for (const std::uint64_t count : counts) {
      for (const auto& choice : all) {
        for (std::uint64_t k = 0; k < seeds_of(choice); ++k) {
          PointRunSpec run{.label = choice.label,
                           .density = density,
                           .density_floor = density.empty() ? 0 : density_floor,
                           .pixels = pixels,
                           .task = {.strategy = choice.name, .parameters = choice.parameters}};
          run.task.count = count;
          run.task.seed = first_seed + k;
          run.task.backend = backend;
          runs.push_back(std::move(run));
        }
      }
    }
  }
  return runs;
}

std::string experiment_kind(const std::filesystem::path& path) {
  const toml::table table = parse_experiment_file(path);
  TableReader reader(table, path.string());
  std::string kind = reader.text("kind", "images");
  if (kind != "images" && kind != "points") reader.fail(*table.get("kind"), "kind", "\"images\" or \"points\"");
  return kind;
}

PointExperimentSpec load_point_experiment(const std::filesystem::path& path) {
  const std::string file = path.string();
  const toml::table table = parse_experiment_file(path);
  TableReader reader(table, file);
  if (reader.text("kind", "images") != "points") {
    throw ConfigError(fmt::format("{}: this experiment is not of kind \"points\"", file));
  }
  PointExperimentSpec spec;
  spec.name = reader.text("name", path.stem().string());
  spec.title = reader.text("title", spec.name);
  spec.thesis = reader.text("thesis", "");
  spec.backend = reader.text("backend", spec.backend);
  spec.seeds = reader.whole("seeds", 1, 1);
  spec.first_seed = reader.whole("first_seed", 1, 0);
  spec.density_floor = reader.number("density_floor", 0, 0, 1);
  spec.pixels = parse_extent(reader.text("pixels", "200x200"), file + ": 'pixels'");
  spec.images = reader.boolean("images", false);
  spec.metrics = reader.texts("metrics");
  for (const std::int64_t count :
       reader.list("counts", "a whole number >= 1, or a list of such", [](const toml::node& n) {
         const auto value = n.value_exact<std::int64_t>();
         return value && *value >= 1 ? value : std::nullopt;
       })) {
    spec.counts.push_back(static_cast<std::uint64_t>(count));
  }
  if (spec.counts.empty())
    throw ConfigError(fmt::format("{}: no counts; add counts = [1024], the number of points in a set", file));
  std::vector<std::string> densities = reader.texts("density");
  for (std::string& density : densities) {
    const bool named = density.empty() || density.starts_with("scene:") || density.starts_with("size:");
    // An image file is named relative to the spec, so that the pair can be moved together.
    if (!named && std::filesystem::path(density).is_relative())
      density = (path.parent_path() / density).lexically_normal().string();
  }
  if (!densities.empty()) spec.densities = std::move(densities);
  spec.sweep = read_sweep(reader, file);
  spec.strategies = read_strategies(reader, file);
  reader.refuse_unknown("the experiment");
  if (spec.metrics.empty()) {
    for (const auto& metric : point_metrics()) spec.metrics.push_back(metric.name);
  }
  try {
    validate(spec);
  } catch (const ConfigError& error) {
    throw ConfigError(fmt::format("{}: {}", file, error.what()));
  }
  return spec;
}

void validate(const PointExperimentSpec& spec) {
  for (const auto& metric : spec.metrics) find_point_metric(metric);
  require_distinct(spec.metrics, "metrics");
  require_distinct(spec.counts, "counts");
  require_distinct(spec.densities, "density");
  for (const auto& density : spec.densities) require_density(density);
  if (spec.seeds > 1000000) throw ConfigError("'seeds' must be at most 1000000");
  for (const auto& axis : spec.sweep) {
    const bool known = std::any_of(spec.strategies.begin(), spec.strategies.end(), [&](const StrategyChoice& choice) {
      return choice.name == axis.strategy || choice.label == axis.strategy;
    });
    if (known) continue;
    std::vector<std::string> labels;
    for (const auto& choice : spec.strategies) labels.push_back(choice.label);
    throw ConfigError(fmt::format("[sweep] {}.{}: the experiment has no strategy '{}'; it has: {}", axis.strategy,
                                  axis.key, axis.strategy, fmt::join(labels, ", ")));
  }
  require_names(spec.name, spec.choices());
  // One seed stands for all: words do not depend on it. Building the sampler also checks that the count can be met.
  PointExperimentSpec one_seed = spec;
  one_seed.seeds = 1;
  std::map<std::string, std::string> owners;
  for (const auto& run : one_seed.expand()) {
    require_points(run.task);
    const auto [other, is_new] = owners.emplace(canonical(run), run.label);
    if (!is_new) {
      throw ConfigError(fmt::format("'{}' and '{}' are the same sets ({} points); leave one out, or change a parameter",
                                    other->second, run.label, run.task.count));
    }
  }
}

}  // namespace abn::harness
