#include "sampling/hammersley.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sampling/draw_for_tests.h"

namespace abn {
namespace {

TEST(Hammersley, UnshiftedIsTheDefinition) {
  const auto points = draw<Hammersley>({1, 1}, 100, 1, {.shift = "none"});
  for (unsigned i = 0; i < 100; ++i) {
    double inverse = 0;
    for (unsigned bit = 0; bit < 7; ++bit) inverse += ((i >> bit) & 1U) * std::ldexp(0.5, -static_cast<int>(bit));
    EXPECT_NEAR(points[i].x, i / 100.0, 1e-7);
    EXPECT_EQ(points[i].y, inverse);
  }
}

TEST(Hammersley, UnshiftedPowersOfTwoAreNets) {
  for (unsigned m = 0; m <= 12; ++m) {
    EXPECT_TRUE(is_zero_net(draw<Hammersley>({1, 1}, std::uint64_t{1} << m, 1, {.shift = "none"}), m)) << m;
  }
}

TEST(Hammersley, ShiftedXIsEquallySpaced) {
  for (const std::size_t n : {7U, 64U, 1000U}) {
    auto points = draw<Hammersley>({1, 1}, n, 5);
    std::sort(points.begin(), points.end(), [](Vec2f a, Vec2f b) { return a.x < b.x; });
    for (std::size_t i = 0; i + 1 < n; ++i) {
      ASSERT_NEAR(points[i + 1].x - points[i].x, 1.0 / static_cast<double>(n), 2e-7);
    }
  }
}

TEST(Hammersley, ShiftIsOnePerSeedAndUniform) {
  double sum = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    const auto shifted = draw<Hammersley>({1, 1}, 16, seed);
    const auto plain = draw<Hammersley>({1, 1}, 16, seed, {.shift = "none"});
    const double shift = shifted[0].y;
    for (std::size_t i = 0; i < 16; ++i) {
      ASSERT_NEAR(shifted[i].y, std::fmod(plain[i].y + shift, 1.0), 2e-7);
    }
    sum += shift;
  }
  EXPECT_NEAR(sum / 1000, 0.5, 4 / std::sqrt(12.0 * 1000));
}

}  // namespace
}  // namespace abn
