#include "sampling/adaptive/drivers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sampling/rng.h"

namespace abn {
namespace {

std::vector<Vec2f> white(Extent plane, std::uint64_t count) {
  std::vector<Vec2f> points;
  for (std::uint64_t i = 0; i < count; ++i) {
    points.push_back(to_plane(Rng(4, stream_id("drivers_test"), i).uniform2(), plane));
  }
  return points;
}

TEST(LocalMean, FollowsARampAndKeepsConstants) {
  const Extent plane{20, 10};
  const auto position = white(plane, 4000);
  std::vector<float> ramp;
  for (const Vec2f p : position) ramp.push_back(p.x);
  const Grid<float> mean = local_mean(position, ramp, 1, plane, {40, 20}, 2);
  for (std::uint32_t x = 6; x < 34; ++x) EXPECT_NEAR(mean.at(x, 10), (static_cast<float>(x) + 0.5F) / 2, 0.35F) << x;
  const Grid<float> flat = local_mean(position, std::vector<float>(12000, 0.75F), 3, plane, {40, 20}, 1);
  for (const float value : flat.cells()) EXPECT_NEAR(value, 0.75F, 1e-5F);
}

TEST(LocalMean, ReachesEveryCellFromFewSamples) {
  const std::vector<Vec2f> position = {{0.5F, 0.5F}, {15.5F, 15.5F}};
  const Grid<float> mean = local_mean(position, std::vector<float>{0, 1}, 1, {16, 16}, {32, 32}, 1);
  EXPECT_LT(mean.at(0, 0), 0.1F);
  EXPECT_GT(mean.at(31, 31), 0.9F);
  for (const float value : mean.cells()) EXPECT_TRUE(value >= 0 && value <= 1);
  const Grid<float> none = local_mean({}, {}, 1, {4, 4}, {4, 4}, 1);
  for (const float value : none.cells()) EXPECT_EQ(value, 0);
}

TEST(SquaredGradient, OfALinearMapIsConstant) {
  Grid<float> map({9, 7});
  for (std::uint32_t y = 0; y < 7; ++y) {
    for (std::uint32_t x = 0; x < 9; ++x) map.at(x, y) = 3 * static_cast<float>(x) - 4 * static_cast<float>(y);
  }
  const Grid<float> gradient = squared_gradient(map);
  for (const float value : gradient.cells()) EXPECT_NEAR(value, 25, 1e-3F);
  EXPECT_EQ(squared_gradient(Grid<float>({1, 1}, 2.0F))[0], 0);
}

TEST(BothDrivers, GivesEachItsShareOfTheDensity) {
  Grid<float> a({2, 2}, 0.0F);
  Grid<float> b({2, 2}, 0.0F);
  a[0] = 1e-8F;
  b[1] = 4e20F;
  b[2] = 1e20F;
  for (const double exponent : {0.25, 0.5, 1.0}) {
    const Grid<float> both = both_drivers(a, b, exponent, 0.25);
    const auto density = [&](std::size_t i) { return std::pow(double{both[i]}, exponent); };
    EXPECT_NEAR(density(0), 3, 1e-4) << exponent;
    EXPECT_NEAR(density(1) + density(2), 1, 1e-4) << exponent;
    EXPECT_NEAR(density(1) / density(2), std::pow(4, exponent), 1e-4) << exponent;
    EXPECT_EQ(both[3], 0);
  }
  EXPECT_EQ(both_drivers(a, Grid<float>({2, 2}, 0.0F), 1, 0.5)[0], 2);
  EXPECT_EQ(both_drivers(Grid<float>({2, 2}, 0.0F), Grid<float>({2, 2}, 0.0F), 0.5, 0.5)[0], 0);
}

TEST(DrawPerPixel, GivesEveryPixelOneAndTheRestByDensity) {
  const Extent plane{16, 8};
  Grid<float> density({32, 16}, 1.0F);
  for (std::uint32_t y = 0; y < 16; ++y) {
    for (std::uint32_t x = 16; x < 32; ++x) density.at(x, y) = 11;
  }
  const std::uint64_t count = 16 * 8 * 6;
  const auto points = draw_per_pixel(density, count, plane, 7);
  ASSERT_EQ(points.size(), count);
  std::vector<int> held(plane.area(), 0);
  for (const Vec2f p : points) ++held[static_cast<std::size_t>(p.y) * 16 + static_cast<std::size_t>(p.x)];
  for (std::size_t p = 0; p < plane.area(); ++p) {
    if (p % 16 < 7) {
      EXPECT_EQ(held[p], 1) << p;
    }
    if (p % 16 > 8) {
      EXPECT_NEAR(held[p], 11, 1.5) << p;
    }
  }
}

TEST(DrawPerPixel, EveryPointIsUniformInItsPixel) {
  // What makes the mean of a pixel unbiased: over seeds, the k-th point of a pixel falls everywhere alike.
  const Grid<float> density({2, 1}, 5.0F);
  double x = 0;
  double square = 0;
  constexpr int seeds = 4000;
  for (int seed = 0; seed < seeds; ++seed) {
    const Vec2f third = draw_per_pixel(density, 10, {2, 1}, static_cast<std::uint64_t>(seed))[2];
    x += double{third.x} / seeds;
    square += double{third.x} * double{third.x} / seeds;
  }
  EXPECT_NEAR(x, 0.5, 0.02);
  EXPECT_NEAR(square, 1.0 / 3, 0.02);
}

}  // namespace
}  // namespace abn
