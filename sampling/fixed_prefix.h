// Running totals in one fixed order, which a loop on the host and the threads of a device can both follow.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace abn {

inline constexpr std::uint32_t prefix_chunk = 128;  // values that are added one after the other

/// What comes before each value and, at the end, the sum of all: [n + 1]. Every chunk of values is added up from 0 by
/// itself, the chunks' totals are added one after the other, and a value has before it the chunks before plus what is
/// before it in its own. Never falls where no value is below 0.
inline std::vector<double> fixed_order_prefix(std::span<const double> values) {
  std::vector<double> before(values.size() + 1);
  double base = 0;
  for (std::size_t begin = 0; begin < values.size(); begin += prefix_chunk) {
    const std::size_t end = std::min<std::size_t>(begin + prefix_chunk, values.size());
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      before[i] = base + sum;
      sum += values[i];
    }
    base += sum;
  }
  before.back() = base;
  return before;
}

}  // namespace abn
