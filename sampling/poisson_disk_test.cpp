#include "sampling/poisson_disk.h"

#include <gtest/gtest.h>

#include "sampling/blue_noise_test.h"
#include "sampling/disk_grid.h"

namespace abn {
namespace {

static_assert(StrategyClass<PoissonDisk>);

constexpr Extent planes[] = {{1, 1}, {200, 200}, {1, 2000}, {3, 500}};

void expect_theorem(const SamplingTask& task, const PoissonDisk::Params& params = {}) {
  PoissonDisk poisson_disk(task, params);
  const auto points = all_positions(poisson_disk);
  ASSERT_EQ(points.size(), task.budget);
  for (const Vec2f point : points) {
    ASSERT_TRUE(point.x >= 0 && point.x < static_cast<float>(task.plane.width));
    ASSERT_TRUE(point.y >= 0 && point.y < static_cast<float>(task.plane.height));
  }
  const double radius = diagnostic(poisson_disk, "min_distance");
  EXPECT_GT(radius, 0.6 * reference_radius(task.plane, task.budget)) << task.plane.width << " " << task.budget;
  EXPECT_GE(smallest_torus_distance(points, task.plane), radius) << task.plane.width << " " << task.budget;
}

TEST(PoissonDisk, ExactCountAtTheStatedDistance) {
  for (const Extent plane : planes) {
    for (const std::uint64_t budget : {1, 2, 7, 100, 4096})
      expect_theorem({.plane = plane, .budget = budget, .seed = 1});
  }
  expect_theorem({.plane = {200, 200}, .budget = 240'000, .seed = 1});
  expect_theorem({.plane = {3, 500}, .budget = 240'000, .seed = 2});
}

TEST(PoissonDisk, EveryBudgetIsMet) {
  for (std::uint64_t budget = 1; budget <= 64; ++budget) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) expect_theorem({.plane = {9, 7}, .budget = budget, .seed = seed});
  }
}

TEST(PoissonDisk, NothingIsRemovedByDefault) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    PoissonDisk poisson_disk({.plane = {64, 64}, .budget = 4096, .seed = seed}, {});
    all_positions(poisson_disk);
    EXPECT_EQ(diagnostic(poisson_disk, "removed"), 0);
    EXPECT_GT(diagnostic(poisson_disk, "relative_radius"), 0.715);
    EXPECT_LT(diagnostic(poisson_disk, "relative_radius"), 0.75);
  }
}

TEST(PoissonDisk, GivenRadiusIsKeptBySparing) {
  PoissonDisk sparse({.plane = {200, 137}, .budget = 4096, .seed = 3}, {.radius = 0.6});
  const auto points = all_positions(sparse);
  EXPECT_EQ(points.size(), 4096U);
  EXPECT_DOUBLE_EQ(diagnostic(sparse, "relative_radius"), 0.6);
  EXPECT_GT(diagnostic(sparse, "removed"), 1000);
  EXPECT_GE(smallest_torus_distance(points, {200, 137}), 0.6 * reference_radius({200, 137}, 4096));
}

TEST(PoissonDisk, GivenRadiusOutOfReachIsLowered) {
  expect_theorem({.plane = {50, 70}, .budget = 1000, .seed = 3}, {.radius = 0.9});
  expect_theorem({.plane = {50, 70}, .budget = 1000, .seed = 3}, {.radius = 0, .candidates = 1});
}

TEST(PoissonDisk, SameTaskSamePointsOtherSeedOthers) {
  const SamplingTask task{.plane = {20, 30}, .budget = 500, .seed = 18446744073709551615U};
  PoissonDisk first(task, {});
  PoissonDisk second(task, {});
  PoissonDisk other({.plane = {20, 30}, .budget = 500, .seed = 0}, {});
  const auto points = all_positions(first);
  EXPECT_EQ(points, all_positions(second));
  EXPECT_NE(points, all_positions(other));
  EXPECT_TRUE(all_positions(first).empty());  // after the end always empty
}

// Removing the surplus of a too-small radius leaves holes: the reason for the default.
TEST(PoissonDisk, LowFrequenciesAreWeakerThanAfterRemoval) {
  double power = 0;
  double after_removal = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SamplingTask task{.plane = {1, 1}, .budget = 1024, .seed = seed};
    PoissonDisk filled(task, {});
    PoissonDisk thinned(task, {.radius = 0.7});
    power += low_frequency_power(all_positions(filled), {1, 1}) / 5;
    after_removal += low_frequency_power(all_positions(thinned), {1, 1}) / 5;
  }
  EXPECT_LT(power, 0.1);
  EXPECT_GT(power, 0.05);
  EXPECT_GT(after_removal, 1.3 * power);
}

TEST(PoissonDisk, BadWordsAreRefused) {
  EXPECT_THROW(PoissonDisk({.plane = {200, 200}, .budget = std::uint64_t{1} << 32, .seed = 1}, {}), ConfigError);
  EXPECT_THROW(PoissonDisk({.plane = {200, 200}, .budget = 100, .seed = 1}, {.radius = 0.1}), ConfigError);
}

}  // namespace
}  // namespace abn
