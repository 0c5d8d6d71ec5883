#include "sampling/adaptive/pixel_variance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace abn {
namespace {

PixelStats stats_of(std::initializer_list<float> values) {
  PixelStats stats;
  for (const float v : values) stats.add(v);
  return stats;
}

TEST(PixelVariance, IsThatOfThePopulationAndNothingWhereUnknown) {
  Grid<PixelStats> pixels({3, 1});
  pixels[0] = stats_of({0.7F});
  pixels[1] = stats_of({0.0F, 1.0F});
  pixels[2] = stats_of({0.25F, 0.25F, 0.25F});
  const Grid<float> variance = pixel_variance(pixels, {3, 1});
  EXPECT_EQ(variance[0], 0.0F);
  EXPECT_FLOAT_EQ(variance[1], 0.25F);  // the largest for data in [0,1]; the unbiased one would be 0.5
  EXPECT_EQ(variance[2], 0.0F);
}

TEST(PixelVariance, IsFiniteWhateverTheValues) {
  const float inf = std::numeric_limits<float>::infinity();
  Grid<PixelStats> pixels({4, 1});
  pixels[0] = stats_of({0.0F, 3e38F});
  pixels[1] = stats_of({std::nanf(""), 1.0F});
  pixels[2] = stats_of({inf, 1.0F});
  pixels[3] = stats_of({0.0F, 4e18F});
  const Grid<float> variance = pixel_variance(pixels, {4, 1});
  for (const float v : variance.cells()) {
    EXPECT_TRUE(std::isfinite(v));
    EXPECT_GE(v, 0.0F);
  }
  EXPECT_GT(variance[3], 1e30F);
}

TEST(PixelVariance, AGridOfAnotherSizeSaysNothing) {
  const Grid<float> variance = pixel_variance(Grid<PixelStats>{}, {2, 2});
  for (const float v : variance.cells()) EXPECT_EQ(v, 0.0F);
}

TEST(Resampled, RepeatsFinerAndAveragesCoarser) {
  Grid<float> values({2, 1});
  values[0] = 1;
  values[1] = 3;
  const Grid<float> finer = resampled(values, {4, 2});
  EXPECT_EQ(finer.at(1, 1), 1.0F);
  EXPECT_EQ(finer.at(2, 0), 3.0F);
  EXPECT_EQ(resampled(values, {1, 1})[0], 2.0F);
  // Three cells over two: the middle one belongs to both.
  Grid<float> three({3, 1});
  three[0] = 0;
  three[1] = 2;
  three[2] = 4;
  EXPECT_EQ(resampled(three, {2, 1})[0], 1.0F);
  EXPECT_EQ(resampled(three, {2, 1})[1], 3.0F);
}

TEST(Resampled, LeavesOutWhatIsNotFinite) {
  Grid<float> values({2, 1});
  values[0] = std::nanf("");
  values[1] = 3;
  EXPECT_EQ(resampled(values, {1, 1})[0], 3.0F);
  EXPECT_EQ(resampled(values, {2, 1})[0], 0.0F);
}

TEST(Dilated, TakesTheLargestOfTheSquare) {
  Grid<float> values({7, 5});
  values.at(3, 2) = 1;
  const Grid<float> result = dilated(values, 1);
  int ones = 0;
  for (std::uint32_t y = 0; y < 5; ++y) {
    for (std::uint32_t x = 0; x < 7; ++x) {
      const bool near = x >= 2 && x <= 4 && y >= 1 && y <= 3;
      EXPECT_EQ(result.at(x, y), near ? 1.0F : 0.0F) << x << " " << y;
      ones += near ? 1 : 0;
    }
  }
  EXPECT_EQ(ones, 9);
  EXPECT_EQ(dilated(values, 0).at(2, 2), 0.0F);
}

}  // namespace
}  // namespace abn
