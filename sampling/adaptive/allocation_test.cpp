#include "sampling/adaptive/allocation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sampling/rng.h"

namespace abn {
namespace {

Grid<float> random_map(Extent size, std::uint64_t seed, float scale) {
  Grid<float> map(size);
  for (std::uint64_t i = 0; i < size.area(); ++i) map[i] = scale * Rng(seed, stream_id("allocation_test"), i).uniform();
  return map;
}

TEST(Allocation, AddsUpToTheTotal) {
  const Extent plane{50, 30};
  const Grid<float> weight = random_map({100, 60}, 1, 5);
  const Grid<float> have({100, 60}, 1.5F);
  for (const double total : {3000.0, 9000.0, 20000.0}) {
    EXPECT_NEAR(samples_of(allocate(weight, have, total, 100, plane), plane), total, 1e-3 * total);
  }
}

TEST(Allocation, IsProportionalBetweenFloorAndCeiling) {
  const Extent plane{40, 40};
  const Grid<float> weight = random_map({40, 40}, 2, 3);
  const Grid<float> have = random_map({40, 40}, 3, 1);
  const float most = 8;
  const Grid<float> density = allocate(weight, have, 40 * 40 * 3.0, double{most}, plane);
  double scale = 0;
  for (std::size_t i = 0; i < plane.area(); ++i) {
    EXPECT_GE(density[i], have[i]);
    EXPECT_LE(density[i], most);
    if (density[i] > have[i] * 1.001F && density[i] < most * 0.999F) {
      const double here = double{density[i]} / double{weight[i]};
      if (scale == 0) scale = here;
      EXPECT_NEAR(here, scale, 1e-4 * scale);
    }
  }
  EXPECT_GT(scale, 0);
}

TEST(Allocation, KeepsWhatIsThereWhenNothingIsLeft) {
  const Extent plane{10, 10};
  const Grid<float> have = random_map({20, 20}, 4, 6);
  const Grid<float> density = allocate(random_map({20, 20}, 5, 1), have, 1, 50, plane);
  for (std::size_t i = 0; i < have.cells().size(); ++i) EXPECT_EQ(density[i], have[i]);
}

TEST(Allocation, FillsEverythingWhenTheTotalDoesNotFit) {
  const Extent plane{10, 10};
  const Grid<float> density = allocate(random_map({10, 10}, 6, 1), Grid<float>({10, 10}, 0.0F), 1e6, 4, plane);
  for (const float n : density.cells()) EXPECT_NEAR(n, 4, 0.01);
}

TEST(Allocation, OneBrightCellCannotEatTheBudget) {
  const Extent plane{20, 20};
  Grid<float> weight({40, 40}, 1e-3F);
  weight[777] = 1e15F;
  const Grid<float> have({40, 40}, 1.0F);
  const double most = 64;
  const Grid<float> density = allocate(weight, have, 2400, most, plane);
  EXPECT_NEAR(samples_of(density, plane), 2400, 3);
  EXPECT_LE(density[777], most);
  EXPECT_GT(density[0], 5.5F);  // all others share what it could not take
}

TEST(Allocation, NoWeightAnywhereAddsNothing) {
  const Grid<float> have({8, 8}, 2.0F);
  const Grid<float> density = allocate(Grid<float>({8, 8}, 0.0F), have, 1000, 10, {8, 8});
  for (const float n : density.cells()) EXPECT_EQ(n, 2.0F);
}

TEST(UniformShare, IsOneForEqualAndSmallForConcentratedVariance) {
  EXPECT_DOUBLE_EQ(uniform_share(Grid<float>({9, 9}, 0.0F)), 1);
  EXPECT_NEAR(uniform_share(Grid<float>({9, 9}, 0.3F)), 1, 1e-6);
  Grid<float> spot({10, 10}, 0.0F);
  spot[5] = 4;
  EXPECT_NEAR(uniform_share(spot), 0.01, 1e-9);
}

TEST(DrawDeficit, FollowsTheDeficitEverywhere) {
  const Extent plane{32, 48};
  Grid<float> wanted({64, 96}, 1.0F);
  const Grid<float> have({64, 96}, 1.0F);
  for (std::uint32_t y = 0; y < 96; ++y) {
    for (std::uint32_t x = 0; x < 64; ++x) wanted.at(x, y) += static_cast<float>(x / 8);  // eight bands
  }
  const std::uint64_t count = 28000;
  const auto points = draw_deficit(wanted, have, count, plane, 7, 1);
  ASSERT_EQ(points.size(), count);
  std::array<double, 8> band{};
  for (const Vec2f p : points) {
    ASSERT_TRUE(p.x >= 0 && p.x < 32 && p.y >= 0 && p.y < 48);
    band[static_cast<std::size_t>(p.x / 4)] += 1;
  }
  EXPECT_EQ(band[0], 0);
  for (std::size_t b = 1; b < 8; ++b) EXPECT_NEAR(band[b], 1000.0 * static_cast<double>(b), 60) << b;
}

TEST(DrawDeficit, NothingWantedIsUniform) {
  const Grid<float> map({16, 16}, 1.0F);
  const auto points = draw_deficit(map, map, 1600, {16, 16}, 3, 2);
  ASSERT_EQ(points.size(), 1600U);
  int left = 0;
  for (const Vec2f p : points) left += p.x < 8 ? 1 : 0;
  EXPECT_NEAR(left, 800, 20);
}

TEST(DrawDeficit, ZeroAndOnePoint) {
  const Grid<float> map({4, 4}, 1.0F);
  EXPECT_TRUE(draw_deficit(map, map, 0, {4, 4}, 1, 1).empty());
  EXPECT_EQ(draw_deficit(map, Grid<float>({4, 4}, 0.0F), 1, {4, 4}, 1, 1).size(), 1U);
}

}  // namespace
}  // namespace abn
