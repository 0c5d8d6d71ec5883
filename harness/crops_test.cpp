#include "harness/crops.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sampling/error.h"

namespace abn::harness {
namespace {

Image ramp(Extent size, std::uint32_t channels) {
  Image image(size, channels);
  for (std::size_t i = 0; i < image.texels.size(); ++i) image.texels[i] = static_cast<float>(i);
  return image;
}

TEST(Crops, CornersAreRoundedToWholePixels) {
  const Region stalk{"stalk", 0.460, 0.185, 0.580, 0.375};
  const CanvasArea at_200 = pixels_of(stalk, {200, 200});
  EXPECT_EQ(at_200.left, 92);
  EXPECT_EQ(at_200.top, 37);
  EXPECT_EQ(at_200.right(), 116);
  EXPECT_EQ(at_200.bottom(), 75);
  const CanvasArea whole = pixels_of({"", 0, 0, 1, 1}, {7, 3});
  EXPECT_EQ(whole.width, 7);
  EXPECT_EQ(whole.height, 3);
  // On a plane of few pixels a region is one of them, inside.
  for (const double left : {0.0, 0.3, 0.5, 0.99}) {
    const CanvasArea one = pixels_of({"", left, left, left + 0.01, left + 0.01}, {2, 2});
    EXPECT_EQ(one.width, 1);
    EXPECT_LE(one.right(), 2);
  }
}

TEST(Crops, CutOutKeepsTexels) {
  const Image image = ramp({5, 4}, 3);
  const Image part = cut_out(image, {1, 2, 3, 2});
  ASSERT_EQ(part.size, (Extent{3, 2}));
  for (std::uint32_t y = 0; y < 2; ++y) {
    for (std::uint32_t x = 0; x < 3; ++x) {
      for (std::uint32_t c = 0; c < 3; ++c) EXPECT_EQ(part.texel(x, y)[c], image.texel(x + 1, y + 2)[c]);
    }
  }
}

TEST(Crops, RmseIsOfTheInsideOnly) {
  const Image truth({4, 4}, 1);
  Image test = truth;
  *test.texel(0, 0) = 100;
  *test.texel(2, 2) = 0.3F;
  *test.texel(3, 2) = -0.4F;
  EXPECT_NEAR(rmse_inside(test, truth, {2, 2, 2, 2}), 0.25, 1e-7);
  EXPECT_EQ(rmse_inside(test, truth, {2, 0, 2, 2}), 0);
  EXPECT_THROW(rmse_inside(test, Image({4, 3}, 1), {0, 0, 1, 1}), ConfigError);
}

TEST(Crops, SheetShowsEveryPixelEnlarged) {
  Image truth({10, 10}, 3);
  Image test = truth;
  for (std::uint32_t c = 0; c < 3; ++c) test.texel(4, 4)[c] = 0.05F;
  const Picture sheet =
      crop_sheet(truth, {{"test", test, 0}}, {"mark", 0.3, 0.3, 0.7, 0.6}, {.title = "crops", .gain = 10, .zoom = 30});
  const Rgb8 expected = false_colour(0.5F);
  std::size_t coloured = 0;
  for (std::size_t i = 0; i < sheet.rgb.size(); i += 3) {
    coloured += std::equal(expected.begin(), expected.end(), &sheet.rgb[i]) ? 1 : 0;
  }
  EXPECT_GE(coloured, 30U * 30U);
  EXPECT_LE(coloured, 30U * 30U + 100U);  // and its place in the colour bar
}

TEST(Crops, RegionsAreFoundByName) {
  const auto found = named_regions("scene:apple", {"far_checkers", "nonsense", "stalk"});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].name, "far_checkers");
  EXPECT_EQ(found[1].name, "stalk");
  EXPECT_TRUE(named_regions("photo.png", {"stalk"}).empty());
  EXPECT_TRUE(named_regions("scene:constant", {"stalk"}).empty());
}

}  // namespace
}  // namespace abn::harness
