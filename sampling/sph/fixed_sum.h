// Sums in one fixed order, which a loop on the host and a block of threads on a device can both follow.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace abn::sph {

inline constexpr std::uint32_t sum_chunk = 1024;  // values that are summed together
inline constexpr std::uint32_t sum_lanes = 256;   // lane k of a chunk takes its values k, k + 256, …; a power of two

/// The sum of one chunk: every lane's values in turn, then lane k + lane (k + half) for half = 128, 64, …, 1.
class ChunkSum {
 public:
  /// place: index in the chunk, given in rising order.
  void add(std::size_t place, double value) { lane_[place % sum_lanes] += value; }
  double total() {
    for (std::size_t half = sum_lanes / 2; half > 0; half /= 2) {
      for (std::size_t k = 0; k < half; ++k) lane_[k] += lane_[k + half];
    }
    return lane_[0];
  }

 private:
  std::array<double, sum_lanes> lane_{};
};

/// The totals of the chunks of load(i), i < count.
template <class Load>
std::vector<double> chunk_totals(std::size_t count, const Load& load) {
  std::vector<double> totals;
  totals.reserve((count + sum_chunk - 1) / sum_chunk);
  for (std::size_t begin = 0; begin < count; begin += sum_chunk) {
    ChunkSum chunk;
    const std::size_t here = std::min<std::size_t>(sum_chunk, count - begin);
    for (std::size_t k = 0; k < here; ++k) chunk.add(k, load(begin + k));
    totals.push_back(chunk.total());
  }
  return totals;
}

/// The sum of load(i), i < count: chunk by chunk, then those totals again, until one is left. 0 without values.
template <class Load>
double fixed_order_sum(std::size_t count, const Load& load) {
  if (count == 0) return 0;
  std::vector<double> values = chunk_totals(count, load);
  while (values.size() > 1) values = chunk_totals(values.size(), [&](std::size_t i) { return values[i]; });
  return values[0];
}

/// The sum of any number of values, e.g. of the chunks' totals.
inline double fixed_order_sum(const std::vector<double>& values) {
  return fixed_order_sum(values.size(), [&](std::size_t i) { return values[i]; });
}

}  // namespace abn::sph
