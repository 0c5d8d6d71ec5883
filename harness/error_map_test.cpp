#include "harness/error_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/metrics.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

Image image(std::uint32_t channels, std::initializer_list<float> texels) {
  Image result({static_cast<std::uint32_t>(texels.size()) / channels, 1}, channels);
  result.texels.assign(texels);
  return result;
}

TEST(ErrorMap, DifferenceIsSignedAndExact) {
  const ErrorMap map = error_map(image(3, {0.5F, 0.0F, 1.0F}), image(3, {0.25F, 0.5F, 4.0F}));
  EXPECT_EQ(map.difference.texels, (std::vector<float>{0.25F, -0.5F, -3.0F}));
  EXPECT_EQ(map.difference.channels, 3U);
}

TEST(ErrorMap, AmplifiedIsAbsoluteGainedAndClamped) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const ErrorMap map = error_map(image(1, {0.03125F, -0.0625F, 2.0F, nan}), image(1, {0, 0, 0, 0}));
  const Image amplified = map.amplified(10);
  EXPECT_EQ(amplified.texels[0], 0.3125F);
  EXPECT_EQ(amplified.texels[1], 0.625F);
  EXPECT_EQ(amplified.texels[2], 1.0F);
  EXPECT_TRUE(std::isnan(amplified.texels[3]));
}

TEST(ErrorMap, FalseColourIsOfTheMeanOverChannels) {
  const ErrorMap map = error_map(image(3, {0.015F, -0.06F, 0.0F, 0.0F, 0.0F, 0.0F}), Image({2, 1}, 3));
  const Picture raster = map.false_colour_raster(10);
  const Rgb8 expected = false_colour(0.25F);
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), raster.pixel(0, 0)));
  const Rgb8 none = false_colour(0.0F);
  EXPECT_TRUE(std::equal(none.begin(), none.end(), raster.pixel(1, 0)));
}

TEST(ErrorMap, PictureHoldsTheEnlargedRasterAndTheWholeScale) {
  Image test({200, 100}, 1);
  for (float& texel : test.texels) texel = 0.05F;
  const Picture picture = error_map(test, Image({200, 100}, 1)).false_colour_picture(10);
  EXPECT_GE(picture.width, 600U);
  std::size_t map_pixels = 0;
  bool first = false;
  bool last = false;
  const Rgb8 expected = false_colour(0.5F);
  const Rgb8 low = false_colour(0.0F);
  const Rgb8 high = false_colour(1.0F);
  for (std::size_t i = 0; i < picture.rgb.size(); i += 3) {
    const auto is = [&](const Rgb8& colour) { return std::equal(colour.begin(), colour.end(), &picture.rgb[i]); };
    map_pixels += is(expected) ? 1 : 0;
    first = first || is(low);
    last = last || is(high);
  }
  EXPECT_GE(map_pixels, 600U * 300U);
  EXPECT_LE(map_pixels, 600U * 300U + 200U);  // and its place in the bar
  EXPECT_TRUE(first);
  EXPECT_TRUE(last);
  EXPECT_EQ(ErrorMap::colour_bar(10).high, 0.1);
}

TEST(EstimatedError, RasterIsTheFalseColourOfEveryPixel) {
  Grid<float> standard_error({3, 2});
  for (std::size_t i = 0; i < 6; ++i) standard_error[i] = 0.02F * static_cast<float>(i);
  standard_error[5] = std::numeric_limits<float>::quiet_NaN();
  const Picture raster = estimated_error_raster(standard_error, 20);
  ASSERT_EQ(raster.size(), standard_error.size());
  for (std::uint32_t i = 0; i < 6; ++i) {
    const Rgb8 expected = false_colour(20 * standard_error[i]);
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), raster.pixel(i % 3, i / 3))) << i;
  }
  const Picture picture = estimated_error_picture(standard_error, 20);
  EXPECT_GE(picture.width, 600U);
}

TEST(EstimatedError, NothingToDrawIsRefused) {
  EXPECT_THROW(estimated_error_raster({}, 10), ConfigError);
  EXPECT_THROW(estimated_error_picture({}, 10), ConfigError);
  EXPECT_THROW(estimated_error_picture(Grid<float>({2, 2}), 0), ConfigError);
}

TEST(ErrorMap, WrongInputIsRefused) {
  EXPECT_THROW(error_map(Image({2, 2}, 1), Image({2, 2}, 3)), ConfigError);
  const ErrorMap map = error_map(image(1, {1}), image(1, {0}));
  for (const double gain : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_THROW(map.amplified(gain), ConfigError);
    EXPECT_THROW(map.false_colour_raster(gain), ConfigError);
    EXPECT_THROW(map.false_colour_picture(gain), ConfigError);
    EXPECT_THROW(ErrorMap::colour_bar(gain), ConfigError);
  }
}

}  // namespace
}  // namespace abn::harness
