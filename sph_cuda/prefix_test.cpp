#include "sph_cuda/prefix.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "sampling/rng.h"
#include "sph_cuda/test_device.h"

namespace abn::sph_cuda {
namespace {

struct LoadValue {
  const double* value;
  double operator()(std::uint32_t i) const { return value[i]; }
};

TEST(Prefix, EqualsTheHostsBitForBit) {
  for (const std::uint32_t n : {0U, 1U, 127U, 128U, 129U, 5000U, 256U * 128, 256U * 128 + 1, 100000U}) {
    std::vector<double> values(n);
    for (std::uint32_t i = 0; i < n; ++i) values[i] = double{Rng(1, 2, i).uniform()} * (i % 7 == 0 ? 0 : 1e-3);
    const std::vector<double> expected = fixed_order_prefix(values);
    EXPECT_TRUE(std::is_sorted(expected.begin(), expected.end()));
    EXPECT_NEAR(expected.back(), std::accumulate(values.begin(), values.end(), 0.0), 1e-12 * n);
    HostDevice device(LaunchOrder::scattered);
    Prefix<HostDevice> prefix;
    const auto value = on_device(values);
    prefix.find(device, n, LoadValue{value.data()});
    EXPECT_EQ(prefix.total(n), expected.back());
    EXPECT_TRUE(same_bits(prefix.before(), expected.data(), expected.size()));
  }
}

}  // namespace
}  // namespace abn::sph_cuda
