#include "harness/spec.h"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <set>

#include "harness/data_path.h"
#include "harness/metrics.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

/// Reads keys of one TOML table, remembers which were read, and refuses the rest.
class TableReader {
 public:
  TableReader(const toml::table& table, std::string file) : table_(table), file_(std::move(file)) {}

  std::string text(const std::string& key, std::string fallback) {
    const toml::node* node = find(key);
    if (node == nullptr) return fallback;
    if (!node->is_string()) fail(*node, key, "text in quotes");
    return **node->as_string();
  }
  bool boolean(const std::string& key, bool fallback) {
    const toml::node* node = find(key);
    if (node == nullptr) return fallback;
    if (!node->is_boolean()) fail(*node, key, "true or false");
    return **node->as_boolean();
  }
  double number(const std::string& key, double fallback, double lo, double hi) {
    const toml::node* node = find(key);
    if (node == nullptr) return fallback;
    const auto value = node->value<double>();
    if (!node->is_number() || !(*value >= lo && *value <= hi))
      fail(*node, key, fmt::format("a number in [{}, {}]", lo, hi));
    return *value;
  }
  std::uint64_t whole(const std::string& key, std::uint64_t fallback, std::uint64_t lo) {
    const toml::node* node = find(key);
    if (node == nullptr) return fallback;
    if (!node->is_integer() || **node->as_integer() < static_cast<std::int64_t>(lo))
      fail(*node, key, fmt::format("a whole number >= {}", lo));
    return static_cast<std::uint64_t>(**node->as_integer());
  }
  /// A list, or one element without brackets.
  template <class Read>
  auto list(const std::string& key, const std::string& wanted, Read read) {
    std::vector<typename decltype(read(std::declval<const toml::node&>()))::value_type> values;
    const toml::node* node = find(key);
    if (node == nullptr) return values;
    const auto append = [&](const toml::node& element) {
      const auto value = read(element);
      if (!value) fail(element, key, wanted);
      values.push_back(*value);
    };
    if (const toml::array* array = node->as_array()) {
      for (const auto& element : *array) append(element);
      if (values.empty()) fail(*node, key, wanted);
    } else {
      append(*node);
    }
    return values;
  }
  std::vector<std::string> texts(const std::string& key) {
    return list(key, "text in quotes, or a list of such",
                [](const toml::node& n) { return n.value_exact<std::string>(); });
  }
  const toml::node* find(const std::string& key) {
    known_.insert(key);
    return table_.get(key);
  }
  /// Throws for the first key that nobody asked for.
  void refuse_unknown(const std::string& where) const {
    for (const auto& [key, node] : table_) {
      if (known_.contains(std::string(key.str()))) continue;
      throw ConfigError(fmt::format("{}:{}: unknown key '{}' in {}; known: {}", file_, node.source().begin.line,
                                    key.str(), where, fmt::join(known_, " ")));
    }
  }
  [[noreturn]] void fail(const toml::node& node, const std::string& key, const std::string& wanted) const {
    throw ConfigError(fmt::format("{}:{}: '{}' must be {}", file_, node.source().begin.line, key, wanted));
  }

 private:
  const toml::table& table_;
  std::string file_;
  std::set<std::string> known_;
};

std::string word_of(TableReader& reader, const std::string& key, const toml::node& node) {
  if (const auto* text = node.as_string()) return **text;
  if (const auto* boolean = node.as_boolean()) return **boolean ? "true" : "false";
  if (const auto* integer = node.as_integer()) return std::to_string(**integer);
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", **number);
  reader.fail(node, key, "a text, number or bool");
}

StrategyChoice read_strategy(const toml::table& table, const std::string& file) {
  TableReader reader(table, file);
  StrategyChoice choice;
  choice.name = reader.text("name", "");
  choice.label = reader.text("label", choice.name);
  if (const toml::node* set = reader.find("set")) {
    if (!set->is_table()) reader.fail(*set, "set", "a table such as { key = \"value\" }");
    for (const auto& [key, node] : *set->as_table())
      choice.parameters[std::string(key.str())] = word_of(reader, std::string(key.str()), node);
  }
  reader.refuse_unknown("[[strategy]]");
  if (choice.name.empty()) {
    throw ConfigError(fmt::format("{}:{}: [[strategy]] without a name; add name = \"jitter\" (abn list strategies)",
                                  file, table.source().begin.line));
  }
  return choice;
}

/// An image that is missing must show before the first run, not between two.
void require_file(const std::string& image) {
  std::error_code ignored;
  if (!std::filesystem::exists(image, ignored))
    throw IoError(fmt::format("cannot read image '{}': there is no such file; check the path", image));
}

/// Throws if a list names something twice: the same run would be done twice.
template <class T>
void require_distinct(const std::vector<T>& values, const std::string& key) {
  std::set<T> seen;
  for (const auto& value : values) {
    if (!seen.insert(value).second) throw ConfigError(fmt::format("'{}' lists {} twice; leave one out", key, value));
  }
}

std::string known_experiments() {
  std::set<std::string> names;
  for (const auto& folder : data_folders()) {
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "experiments", none))
      if (entry.path().extension() == ".toml") names.insert(entry.path().stem().string());
  }
  return fmt::format("{}", fmt::join(names, " "));
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
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    throw IoError(fmt::format("{}: no such file; give the path of an experiment (TOML)", file));
  toml::table table;
  try {
    table = toml::parse_file(file);
  } catch (const toml::parse_error& error) {
    if (error.source().begin.line == 0) throw IoError(fmt::format("{}: cannot be read: {}", file, error.description()));
    throw ConfigError(fmt::format("{}:{}: not valid TOML: {}", file, error.source().begin.line, error.description()));
  }

  TableReader reader(table, file);
  ExperimentSpec spec;
  spec.name = reader.text("name", path.stem().string());
  spec.title = reader.text("title", spec.name);
  spec.thesis = reader.text("thesis", "");
  spec.to = parse_extent(reader.text("to", "200x200"), file + ": 'to'");
  spec.truth = reader.text("truth", spec.truth);
  spec.integrand = reader.text("integrand", spec.integrand);
  spec.filter = reader.text("filter", spec.filter);
  spec.reconstruction = reader.text("reconstruction", spec.reconstruction);
  spec.on_nonfinite = reader.text("on_nonfinite", spec.on_nonfinite);
  spec.backend = reader.text("backend", spec.backend);
  spec.seeds = reader.whole("seeds", 1, 1);
  spec.first_seed = reader.whole("first_seed", 1, 0);
  spec.images = reader.boolean("images", false);
  spec.gain = reader.number("gain", 10, 1e-6, 1e6);
  spec.baseline = reader.text("baseline", "");
  spec.metrics = reader.texts("metrics");

  for (std::string scene : reader.texts("scenes")) {
    // An image file is named relative to the spec, so that the pair can be moved together.
    if (!scene.starts_with("scene:") && std::filesystem::path(scene).is_relative())
      scene = (path.parent_path() / scene).lexically_normal().string();
    spec.scenes.push_back(scene);
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

  if (const toml::node* list = reader.find("strategy")) {
    const toml::array* array = list->as_array();
    if (array == nullptr || !array->is_array_of_tables())
      reader.fail(*list, "strategy", "given as [[strategy]] tables");
    for (const auto& entry : *array) spec.strategies.push_back(read_strategy(*entry.as_table(), file));
  }
  reader.refuse_unknown("the experiment");
  if (spec.strategies.empty())
    throw ConfigError(fmt::format("{}: no [[strategy]]; add one with a name (abn list strategies)", file));
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

void apply_override(ExperimentSpec& spec, const std::string& assignment) {
  const auto equals = assignment.find('=');
  const auto dot = assignment.rfind('.', equals);
  if (equals == std::string::npos || dot == std::string::npos || dot == 0 || dot + 1 == equals) {
    throw ConfigError(
        fmt::format("--set is '{}'; give STRATEGY.KEY=VALUE, e.g. sph_blue_noise.iterations=50", assignment));
  }
  const std::string name = assignment.substr(0, dot);
  bool found = false;
  for (auto& choice : spec.strategies) {
    if (choice.name != name && choice.label != name) continue;
    choice.parameters[assignment.substr(dot + 1, equals - dot - 1)] = assignment.substr(equals + 1);
    found = true;
  }
  if (!found) {
    std::vector<std::string> names;
    for (const auto& choice : spec.strategies) names.push_back(choice.label);
    throw ConfigError(fmt::format("--set {}: the experiment has no strategy '{}'; it has: {}", assignment, name,
                                  fmt::join(names, ", ")));
  }
}

std::vector<RunSpec> ExperimentSpec::expand() const {
  std::vector<RunSpec> runs;
  for (const auto& scene : scenes) {
    for (const std::uint64_t budget : budgets) {
      for (const auto& choice : strategies) {
        for (std::uint64_t k = 0; k < seeds; ++k) {
          RunSpec run;
          run.label = choice.label;
          run.strategy = choice.name;
          run.parameters = choice.parameters;
          run.subject = {.scene = scene,
                         .to = to,
                         .integrand = integrand,
                         .truth = truth,
                         .filter = filter,
                         .channels = {},
                         .on_nonfinite = on_nonfinite};
          run.samples = budget;
          run.seed = first_seed + k;
          run.reconstruction = reconstruction;
          run.backend = backend;
          runs.push_back(std::move(run));
        }
      }
    }
  }
  return runs;
}

void validate(const ExperimentSpec& spec) {
  if (spec.name.empty() || spec.name == "." || spec.name == ".." || spec.name.find('/') != std::string::npos)
    throw ConfigError(fmt::format("'name' is '{}'; give a folder name without '/'", spec.name));
  for (const auto& metric : spec.metrics) find_metric(metric);
  require_distinct(spec.metrics, "metrics");
  require_distinct(spec.scenes, "scenes");
  require_distinct(spec.budgets, "samples or spp");
  std::set<std::string> labels;
  for (const auto& choice : spec.strategies) {
    if (choice.label.empty())
      throw ConfigError(fmt::format("strategy {} has an empty label; leave it out", choice.name));
    if (!labels.insert(choice.label).second) {
      throw ConfigError(fmt::format("two strategies are labelled '{}'; give each a label of its own", choice.label));
    }
  }
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
    if (!run.subject.scene.starts_with("scene:")) require_file(run.subject.scene);
  }
}

}  // namespace abn::harness
