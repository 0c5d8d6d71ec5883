#include "harness/toml_reader.h"

#include "harness/scenes.h"

namespace abn::harness {

toml::table parse_experiment_file(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    throw IoError(fmt::format("{}: no such file; give the path of an experiment (TOML)", file));
  try {
    return toml::parse_file(file);
  } catch (const toml::parse_error& error) {
    if (error.source().begin.line == 0) throw IoError(fmt::format("{}: cannot be read: {}", file, error.description()));
    throw ConfigError(fmt::format("{}:{}: not valid TOML: {}", file, error.source().begin.line, error.description()));
  }
}

std::string word_of(TableReader& reader, const std::string& key, const toml::node& node) {
  if (const auto* text = node.as_string()) return **text;
  if (const auto* boolean = node.as_boolean()) return **boolean ? "true" : "false";
  if (const auto* integer = node.as_integer()) return std::to_string(**integer);
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", **number);
  reader.fail(node, key, "a text, number or bool");
}

namespace {

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
  choice.reconstruction = reader.text("reconstruction", "");
  reader.refuse_unknown("[[strategy]]");
  if (choice.name.empty()) {
    throw ConfigError(fmt::format("{}:{}: [[strategy]] without a name; add name = \"jitter\" (abn list strategies)",
                                  file, table.source().begin.line));
  }
  return choice;
}

}  // namespace

std::vector<StrategyChoice> read_strategies(TableReader& reader, const std::string& file) {
  std::vector<StrategyChoice> strategies;
  if (const toml::node* list = reader.find("strategy")) {
    const toml::array* array = list->as_array();
    if (array == nullptr || !array->is_array_of_tables())
      reader.fail(*list, "strategy", "given as [[strategy]] tables");
    for (const auto& entry : *array) strategies.push_back(read_strategy(*entry.as_table(), file));
  }
  if (strategies.empty())
    throw ConfigError(fmt::format("{}: no [[strategy]]; add one with a name (abn list strategies)", file));
  return strategies;
}

void require_scene(const std::string& word) {
  if (word.starts_with("scene:")) {
    find_scene(word.substr(6));
    return;
  }
  std::error_code ignored;
  if (!std::filesystem::exists(word, ignored))
    throw IoError(fmt::format("cannot read image '{}': there is no such file; check the path", word));
}

void require_names(const std::string& name, const std::vector<StrategyChoice>& strategies) {
  if (name.empty() || name == "." || name == ".." || name.find('/') != std::string::npos)
    throw ConfigError(fmt::format("'name' is '{}'; give a folder name without '/'", name));
  std::set<std::string> labels;
  for (const auto& choice : strategies) {
    if (choice.label.empty())
      throw ConfigError(fmt::format("strategy {} has an empty label; leave it out", choice.name));
    if (!labels.insert(choice.label).second) {
      throw ConfigError(fmt::format("two strategies are labelled '{}'; give each a label of its own", choice.label));
    }
  }
}

}  // namespace abn::harness
