#include "sph_cuda/sum_in_turn.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "sampling/rng.h"
#include "sph_cuda/host_device.h"
#include "sph_cuda/test_device.h"

namespace abn::sph_cuda {
namespace {

/// Block b has its first counts[b] values.
struct Values {
  const std::uint32_t* counts;
  const double* values;
  double* sum;
  std::uint32_t count(std::uint32_t block) const { return counts[block]; }
  double value(std::uint32_t, std::uint32_t i) const { return values[i]; }
  void store(std::uint32_t block, double total) const { sum[block] = total; }
};
struct Floats {
  const std::uint32_t* counts;
  const double* values;
  Extremes* extremes;
  std::uint32_t count(std::uint32_t block) const { return counts[block]; }
  Extremes value(std::uint32_t, std::uint32_t i) const {
    const auto value = static_cast<float>(values[i]);
    return {value, value};
  }
  void store(std::uint32_t block, const Extremes& all) const { extremes[block] = all; }
};

TEST(SumInTurn, EqualsALoopInEveryOrderOfThreads) {
  const std::vector<std::uint32_t> counts = {0, 1, 2, 255, 257, 1023, 1024, 1025, 2048, 5000};
  std::vector<double> values(5000);
  for (std::uint32_t i = 0; i < 5000; ++i) values[i] = double{Rng(1, 2, i).uniform()} / (1 + i % 9);
  const auto blocks = static_cast<std::uint32_t>(counts.size());
  for (const LaunchOrder order : {LaunchOrder::forward, LaunchOrder::backward, LaunchOrder::scattered}) {
    const HostDevice device(order);
    const auto count = on_device(counts);
    const auto value = on_device(values);
    auto sums = on_device(std::vector<double>(blocks, -1));
    auto both = on_device(std::vector<Extremes>(blocks));
    device.launch_blocks(blocks, SumInTurn<Values>{{count.data(), value.data(), sums.data()}});
    device.launch_blocks(blocks, FindExtremes<Floats>{{count.data(), value.data(), both.data()}});
    const std::vector<double> sum = sums.download(blocks);
    const std::vector<Extremes> extremes = both.download(blocks);
    for (std::uint32_t b = 0; b < blocks; ++b) {
      const auto end = values.begin() + counts[b];
      EXPECT_EQ(sum[b], std::accumulate(values.begin(), end, 0.0)) << counts[b];
      if (counts[b] == 0) continue;
      EXPECT_EQ(extremes[b].smallest, static_cast<float>(*std::min_element(values.begin(), end)));
      EXPECT_EQ(extremes[b].largest, static_cast<float>(*std::max_element(values.begin(), end)));
    }
  }
}

}  // namespace
}  // namespace abn::sph_cuda
