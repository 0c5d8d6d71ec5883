#include "sampling/analysis/axis_power.h"

#include <gtest/gtest.h>
#include <omp.h>

#include "sampling/analysis/periodogram.h"
#include "sampling/analysis/point_sets_test.h"
#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::analysis {
namespace {

TEST(AxisPower, EqualsThePeriodogram) {
  const auto points = make_set("random", 777, 5);
  const Periodogram spectrum(points, 130);
  const AxisPower power = axis_power(points, 130);
  ASSERT_EQ(power.x.size(), 131U);
  for (int k = 1; k <= 130; ++k) {
    const auto i = static_cast<std::size_t>(k);
    ASSERT_NEAR(power.x[i], spectrum.power(k, 0), 1e-10) << k;
    ASSERT_NEAR(power.y[i], spectrum.power(0, k), 1e-10) << k;
    ASSERT_NEAR(power.diagonal[i], spectrum.power(k, k), 1e-10) << k;
    ASSERT_NEAR(power.anti_diagonal[i], spectrum.power(k, -k), 1e-10) << k;
  }
  EXPECT_EQ(power.x[0], 0);
}

TEST(AxisPower, FindsALattice) {
  const AxisPower power = axis_power(square_lattice(60, {0.5, 0.5}));
  EXPECT_EQ(power.x.size(), 241U);  // 4 sqrt(N) and 0
  EXPECT_NEAR(power.largest, 3600, 1e-6);
  EXPECT_EQ(power.frequency % 60, 0U);
  for (std::size_t k = 1; k <= 240; ++k) {
    ASSERT_NEAR(power.x[k], k % 60 == 0 ? 3600 : 0, 1e-6);
    ASSERT_NEAR(power.y[k], k % 60 == 0 ? 3600 : 0, 1e-6);
  }
}

// A lattice of spacing 1/64 in y only, blurred until a radial mean no longer shows it.
TEST(AxisPower, NamesAxisAndFrequencyOfAFaintLattice) {
  std::vector<Point> points;
  Rng rng(9, stream_id("rows"));
  for (int i = 0; i < 4096; ++i) {
    const double row = (i % 64 + 0.5 + 0.7 * (rng.uniform() - 0.5)) / 64;
    points.push_back({rng.uniform(), row});
  }
  const AxisPower power = axis_power(points);
  EXPECT_EQ(power.axis, AxisPower::Axis::y);
  EXPECT_EQ(power.frequency, 64U);
  EXPECT_NEAR(power.largest, 4096 * 0.1353, 80);  // N sinc(0.7)^2
  EXPECT_LT(power.largest_diagonal, 20);
}

TEST(AxisPower, WhiteNoiseIsBelowTheAlarm) {
  double mean = 0;
  double expected = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const AxisPower power = axis_power(make_set("random", 1024, seed));
    mean += power.largest / 20;
    expected = power.expected_of_white_noise;
    EXPECT_LT(power.largest, expected + 9);
  }
  EXPECT_NEAR(expected, 6.12, 0.01);  // of 256 exponential numbers
  EXPECT_NEAR(mean, expected, 1);     // 3.5 standard errors
}

TEST(AxisPower, SameBitsForAnyInstructionsAndThreads) {
  const auto points = make_set("random", 1500, 2);
  const AxisPower expected = axis_power(points, 0, VectorUnit::baseline);
  const int before = omp_get_max_threads();
  for (const VectorUnit unit : vector_units()) {
    for (const int threads : {1, 2, 4}) {
      omp_set_num_threads(threads);
      const AxisPower power = axis_power(points, 0, unit);
      EXPECT_EQ(power.x, expected.x);
      EXPECT_EQ(power.y, expected.y);
      EXPECT_EQ(power.diagonal, expected.diagonal);
      EXPECT_EQ(power.anti_diagonal, expected.anti_diagonal);
    }
  }
  omp_set_num_threads(before);
}

TEST(AxisPower, BadWordsAreRefused) {
  EXPECT_THROW(axis_power({}), ConfigError);
  EXPECT_THROW(axis_power(std::vector<Point>(1), std::size_t{1} << 21), ConfigError);
}

}  // namespace
}  // namespace abn::analysis
