// Typed parameters: each strategy owns an aggregate with defaults and one list of fields. The command line, TOML,
// `abn list NAME`, the echo in results and the manual all come from that list.
#pragma once

#include <initializer_list>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "sampling/error.h"

namespace abn {

/// Parameter values as words, by key: what `--set KEY=VALUE` and TOML deliver. Ordered, so that an echo is canonical.
using ParameterWords = std::map<std::string, std::string>;

/// One parameter of the aggregate P. Enumerations are strings with `choices`.
template <class P>
struct Field {
  std::string name;
  std::variant<double P::*, int P::*, bool P::*, std::string P::*> member;
  std::string help;  // one phrase and the unit, e.g. "support radius [spacings]"
  double lo = -std::numeric_limits<double>::infinity();
  double hi = std::numeric_limits<double>::infinity();
  std::vector<std::string> choices = {};
};

/// A field without its aggregate: for listings.
struct FieldDescription {
  std::string name, type, default_value, help;
  double lo, hi;
  std::vector<std::string> choices;
};

namespace detail {
// Parse one word; throw ConfigError naming `owner`, `key`, the word and the remedy.
double parse_number(std::string_view owner, std::string_view key, const std::string& word, double lo, double hi);
int parse_integer(std::string_view owner, std::string_view key, const std::string& word, double lo, double hi);
bool parse_bool(std::string_view owner, std::string_view key, const std::string& word);
std::string parse_choice(std::string_view owner, std::string_view key, const std::string& word,
                         const std::vector<std::string>& choices);
[[noreturn]] void throw_unknown_parameter(std::string_view owner, std::string_view key,
                                          const std::vector<std::string>& known);
std::string to_word(double value);
std::string to_word(int value);
std::string to_word(bool value);
std::string to_word(const std::string& value);
}  // namespace detail

/// Defaults overridden by `words`. Throws ConfigError for an unknown key, a word of the wrong type or out of range.
template <class P>
P parse_parameters(std::string_view owner, const std::vector<Field<P>>& fields, const ParameterWords& words) {
  P parameters{};
  if constexpr (std::is_empty_v<P>) {  // GCC 12 warns of a write into an object without members if it sees the loop
    if (!words.empty()) detail::throw_unknown_parameter(owner, words.begin()->first, {});
    return parameters;
  }
  for (const auto& entry : words) {  // no structured binding: C++20 lambdas capture it, clang 14 does not
    const std::string& key = entry.first;
    const std::string& word = entry.second;
    const Field<P>* field = nullptr;
    std::vector<std::string> known;
    for (const auto& candidate : fields) {
      known.push_back(candidate.name);
      if (candidate.name == key) field = &candidate;
    }
    if (field == nullptr) detail::throw_unknown_parameter(owner, key, known);
    std::visit(
        [&](auto member) {
          using Value = std::remove_cvref_t<decltype(parameters.*member)>;
          if constexpr (std::is_same_v<Value, double>) {
            parameters.*member = detail::parse_number(owner, key, word, field->lo, field->hi);
          } else if constexpr (std::is_same_v<Value, int>) {
            parameters.*member = detail::parse_integer(owner, key, word, field->lo, field->hi);
          } else if constexpr (std::is_same_v<Value, bool>) {
            parameters.*member = detail::parse_bool(owner, key, word);
          } else {
            parameters.*member = detail::parse_choice(owner, key, word, field->choices);
          }
        },
        field->member);
  }
  return parameters;
}

/// All values of an aggregate as words: the echo in results, and what a default looks like.
template <class P>
ParameterWords echo_parameters(const std::vector<Field<P>>& fields, const P& parameters) {
  ParameterWords words;
  for (const auto& field : fields) {
    std::visit([&](auto member) { words[field.name] = detail::to_word(parameters.*member); }, field.member);
  }
  return words;
}

template <class P>
std::vector<FieldDescription> describe_fields(const std::vector<Field<P>>& fields) {
  std::vector<FieldDescription> descriptions;
  const P defaults{};
  for (const auto& field : fields) {
    std::visit(
        [&](auto member) {
          using Value = std::remove_cvref_t<decltype(defaults.*member)>;
          const char* type = std::is_same_v<Value, double> ? "number"
                             : std::is_same_v<Value, int>  ? "integer"
                             : std::is_same_v<Value, bool> ? "bool"
                             : field.choices.empty()       ? "text"
                                                           : "choice";
          descriptions.push_back(
              {field.name, type, detail::to_word(defaults.*member), field.help, field.lo, field.hi, field.choices});
        },
        field.member);
  }
  return descriptions;
}

}  // namespace abn
