// The table of pixel filters: what a pixel's value is an average of.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace abn::harness {

/// A row of the table.
struct Filter {
  std::string name;     // as typed after --filter
  std::string summary;  // one sentence
  double radius = 0;    // half the side of the square it covers around the pixel's centre [px]
};

/// The table, in the order of `abn list filters`.
const std::vector<Filter>& filters();

/// The row of that name; throws ConfigError that lists what is known.
const Filter& find_filter(std::string_view name);

}  // namespace abn::harness
