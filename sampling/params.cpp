#include "sampling/params.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace abn::detail {
namespace {

std::string quoted(std::string_view owner, std::string_view key, const std::string& word) {
  return std::string("parameter '") + std::string(key) + "' of " + std::string(owner) + " is '" + word + "'";
}

std::string range_text(double lo, double hi) { return "[" + to_word(lo) + ", " + to_word(hi) + "]"; }

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text.append(text.empty() ? "" : " ").append(word);
  return text.empty() ? "(none)" : text;
}

}  // namespace

double parse_number(std::string_view owner, std::string_view key, const std::string& word, double lo, double hi) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) {
    throw ConfigError(quoted(owner, key, word) + ", which is no number; give one in " + range_text(lo, hi));
  }
  if (value < lo || value > hi) {
    throw ConfigError(quoted(owner, key, word) + ", out of range; give a number in " + range_text(lo, hi));
  }
  return value;
}

int parse_integer(std::string_view owner, std::string_view key, const std::string& word, double lo, double hi) {
  lo = std::max(lo, static_cast<double>(std::numeric_limits<int>::min()));
  hi = std::min(hi, static_cast<double>(std::numeric_limits<int>::max()));
  int value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size()) {
    throw ConfigError(quoted(owner, key, word) + ", which is no whole number; give one in " + range_text(lo, hi));
  }
  if (error != std::errc{} || value < lo || value > hi) {
    throw ConfigError(quoted(owner, key, word) + ", out of range; give a whole number in " + range_text(lo, hi));
  }
  return value;
}

bool parse_bool(std::string_view owner, std::string_view key, const std::string& word) {
  if (word == "true" || word == "on" || word == "1") return true;
  if (word == "false" || word == "off" || word == "0") return false;
  throw ConfigError(quoted(owner, key, word) + "; give true or false");
}

std::string parse_choice(std::string_view owner, std::string_view key, const std::string& word,
                         const std::vector<std::string>& choices) {
  if (!choices.empty() && std::find(choices.begin(), choices.end(), word) == choices.end()) {
    throw ConfigError(quoted(owner, key, word) + "; known: " + joined(choices));
  }
  return word;
}

void throw_unknown_parameter(std::string_view owner, std::string_view key, const std::vector<std::string>& known) {
  throw ConfigError(std::string("unknown parameter '") + std::string(key) + "' of " + std::string(owner) +
                    "; known: " + joined(known));
}

std::string to_word(double value) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} ? std::string(text.data(), end) : std::string("?");
}
std::string to_word(int value) { return std::to_string(value); }
std::string to_word(bool value) { return value ? "true" : "false"; }
std::string to_word(const std::string& value) { return value; }

}  // namespace abn::detail
