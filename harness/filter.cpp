#include "harness/filter.h"

#include "sampling/error.h"

namespace abn::harness {

const std::vector<Filter>& filters() {
  static const std::vector<Filter> table = {
      {"box", "the plain average over the pixel's own square", 0.5},
  };
  return table;
}

const Filter& find_filter(std::string_view name) {
  std::string known;
  for (const auto& row : filters()) {
    if (row.name == name) return row;
    known += (known.empty() ? "" : ", ") + row.name;
  }
  throw ConfigError("filter '" + std::string(name) + "' is unknown; known: " + known);
}

}  // namespace abn::harness
