#include "sampling/dart.h"

#include <gtest/gtest.h>

#include "sampling/blue_noise_test.h"
#include "sampling/disk_grid.h"

namespace abn {
namespace {

static_assert(StrategyClass<Dart>);

constexpr Extent planes[] = {{1, 1}, {200, 200}, {1, 2000}, {3, 500}};

void expect_theorem(const SamplingTask& task, const Dart::Params& params = {}) {
  Dart dart(task, params);
  const auto points = all_positions(dart);
  ASSERT_EQ(points.size(), task.budget);
  for (const Vec2f point : points) {
    ASSERT_TRUE(point.x >= 0 && point.x < static_cast<float>(task.plane.width));
    ASSERT_TRUE(point.y >= 0 && point.y < static_cast<float>(task.plane.height));
  }
  const double radius = diagnostic(dart, "min_distance");
  EXPECT_GT(radius, 0.6 * reference_radius(task.plane, task.budget)) << task.plane.width << " " << task.budget;
  EXPECT_GE(smallest_torus_distance(points, task.plane), radius) << task.plane.width << " " << task.budget;
}

TEST(Dart, ExactCountAtTheStatedDistance) {
  for (const Extent plane : planes) {
    for (const std::uint64_t budget : {1, 2, 7, 100, 4096})
      expect_theorem({.plane = plane, .budget = budget, .seed = 1});
  }
  expect_theorem({.plane = {200, 200}, .budget = 240'000, .seed = 1});
}

TEST(Dart, RadiusAimedAtIsKept) {
  Dart dart({.plane = {200, 137}, .budget = 4096, .seed = 3}, {.radius = 0.7});
  const auto points = all_positions(dart);
  EXPECT_DOUBLE_EQ(diagnostic(dart, "relative_radius"), 0.7);
  EXPECT_GE(smallest_torus_distance(points, {200, 137}), 0.7 * reference_radius({200, 137}, 4096));
}

TEST(Dart, RadiusOutOfReachIsLowered) {
  expect_theorem({.plane = {50, 70}, .budget = 1000, .seed = 3}, {.radius = 0.9, .throws = 20});
  expect_theorem({.plane = {1, 900}, .budget = 50, .seed = 3}, {.radius = 0.9, .throws = 20});
}

TEST(Dart, SameTaskSamePointsOtherSeedOthers) {
  const SamplingTask task{.plane = {20, 30}, .budget = 500, .seed = 18446744073709551615U};
  Dart first(task, {});
  Dart second(task, {});
  Dart other({.plane = {20, 30}, .budget = 500, .seed = 0}, {});
  const auto points = all_positions(first);
  EXPECT_EQ(points, all_positions(second));
  EXPECT_NE(points, all_positions(other));
  EXPECT_TRUE(all_positions(first).empty());  // after the end always empty
}

// prior-work anchor for dart throwing at relative radius .675: .094; white noise 1.
TEST(Dart, LowFrequenciesAreWeak) {
  double power = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Dart dart({.plane = {1, 1}, .budget = 1024, .seed = seed}, {});
    power += low_frequency_power(all_positions(dart), {1, 1}) / 5;
  }
  EXPECT_LT(power, 0.1);
  EXPECT_GT(power, 0.05);
}

TEST(Dart, BudgetBeyondMemoryIsRefused) {
  EXPECT_THROW(Dart({.plane = {200, 200}, .budget = std::uint64_t{1} << 32, .seed = 1}, {}), ConfigError);
}

}  // namespace
}  // namespace abn
