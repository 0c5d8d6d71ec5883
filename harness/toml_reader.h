// Reading TOML such that every mistake names file, line, key and remedy: what the two kinds of experiments share.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <toml++/toml.h>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "harness/spec.h"
#include "sampling/error.h"

namespace abn::harness {

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

/// The file as a table. Throws IoError, ConfigError (file, line, what the parser says).
toml::table parse_experiment_file(const std::filesystem::path& path);

/// A value as a word of a command line.
std::string word_of(TableReader& reader, const std::string& key, const toml::node& node);

/// The [[strategy]] tables; throws ConfigError if there is none.
std::vector<StrategyChoice> read_strategies(TableReader& reader, const std::string& file);

/// Throws if a list names something twice: the same run would be done twice.
template <class T>
void require_distinct(const std::vector<T>& values, const std::string& key) {
  std::set<T> seen;
  for (const auto& value : values) {
    if (!seen.insert(value).second) throw ConfigError(fmt::format("'{}' lists {} twice; leave one out", key, value));
  }
}

/// Throws if "scene:NAME" is unknown or an image file is missing: that must show before the first run, not between two.
void require_scene(const std::string& word);

/// Throws ConfigError unless every label is there, once, and `name` can be a folder.
void require_names(const std::string& name, const std::vector<StrategyChoice>& strategies);

}  // namespace abn::harness
