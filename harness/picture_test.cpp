#include "harness/picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "harness/color.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

Rgb8 colour_at(const Picture& picture, std::uint32_t x, std::uint32_t y) {
  Rgb8 colour{};
  std::copy_n(picture.pixel(x, y), 3, colour.data());
  return colour;
}

double luminance_of(Rgb8 colour) {
  float linear[3];
  for (std::size_t c = 0; c < 3; ++c) linear[c] = srgb_to_linear(static_cast<float>(colour[c]) / 255.0F);
  return luminance(linear, 3);
}

std::size_t count_colour(const Picture& picture, Rgb8 colour) {
  std::size_t count = 0;
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    for (std::uint32_t x = 0; x < picture.width; ++x) count += colour_at(picture, x, y) == colour ? 1 : 0;
  }
  return count;
}

TEST(Color, CurvesAreInverseAndMatchTheStandard) {
  EXPECT_EQ(linear_to_srgb(0.0F), 0.0F);
  EXPECT_NEAR(linear_to_srgb(1.0F), 1.0F, 1e-6);
  EXPECT_NEAR(srgb_to_linear(0.5F), 0.21404114F, 1e-7);
  EXPECT_NEAR(srgb_to_linear(0.04F), 0.04F / 12.92F, 1e-9);
  for (int byte = 0; byte < 256; ++byte) {
    const float encoded = static_cast<float>(byte) / 255.0F;
    EXPECT_NEAR(linear_to_srgb(srgb_to_linear(encoded)), encoded, 1e-6);
  }
  EXPECT_TRUE(std::isnan(linear_to_srgb(std::numeric_limits<float>::quiet_NaN())));
  EXPECT_TRUE(std::isfinite(linear_to_srgb(-1.0F)));
}

TEST(FalseColour, LightnessIsLinearAndColoursAreDistinct) {
  std::set<Rgb8> colours;
  for (int i = 0; i < 256; ++i) {
    const Rgb8 colour = false_colour(static_cast<float>(i) / 255.0F);
    colours.insert(colour);
    const double y = luminance_of(colour);
    const double lightness = y > 0.008856 ? 116 * std::cbrt(y) - 16 : 903.3 * y;  // CIE L*
    EXPECT_NEAR(lightness, 1.0 + 95.0 * i / 255.0, 0.6) << i;                     // 8 bits round
  }
  EXPECT_GT(colours.size(), 240U);
}

TEST(FalseColour, OutsideIsClampedAndNotANumberStandsOut) {
  EXPECT_EQ(false_colour(-1.0F), false_colour(0.0F));
  EXPECT_EQ(false_colour(std::numeric_limits<float>::infinity()), false_colour(1.0F));
  const Rgb8 signal = false_colour(std::numeric_limits<float>::quiet_NaN());
  for (int i = 0; i < 256; ++i) EXPECT_NE(false_colour(static_cast<float>(i) / 255.0F), signal);
}

TEST(Picture, LinearLightIsEncodedAndGreyReplicated) {
  Image grey({3, 1}, 1);
  grey.texels = {0.0F, 0.21404114F, 7.0F};
  const Picture picture = to_picture(grey);
  EXPECT_EQ(colour_at(picture, 0, 0), (Rgb8{0, 0, 0}));
  EXPECT_EQ(colour_at(picture, 1, 0), (Rgb8{128, 128, 128}));
  EXPECT_EQ(colour_at(picture, 2, 0), (Rgb8{255, 255, 255}));
  Image bright({4, 1}, 1);
  bright.texels = {1.0F, -1.0F, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()};
  const Picture mapped = to_picture(bright, ToneMapping::reinhard);
  EXPECT_EQ(mapped.pixel(0, 0)[0], std::lround(linear_to_srgb(0.5F) * 255.0F));
  EXPECT_EQ(mapped.pixel(1, 0)[0], 0);
  EXPECT_EQ(mapped.pixel(2, 0)[0], 255);
  EXPECT_EQ(mapped.pixel(3, 0)[0], 0);
}

TEST(Picture, EnlargedPixelsAreSquares) {
  Picture small(2, 1);
  small.rgb = {1, 2, 3, 4, 5, 6};
  const Picture large = enlarge(small, 3);
  EXPECT_EQ(large.width, 6U);
  EXPECT_EQ(large.height, 3U);
  for (std::uint32_t y = 0; y < 3; ++y) {
    for (std::uint32_t x = 0; x < 6; ++x) {
      EXPECT_EQ(colour_at(large, x, y), x < 3 ? (Rgb8{1, 2, 3}) : (Rgb8{4, 5, 6}));
    }
  }
}

TEST(Text, StaysInItsBoxAndOffThePictureIsHarmless) {
  Picture page(300, 60);
  draw_text(page, "rmse 0.0245", 40, 40, 14, {0, 0, 0});
  const int end = 40 + text_width("rmse 0.0245", 14);
  std::size_t inked = 0;
  for (std::uint32_t y = 0; y < page.height; ++y) {
    for (std::uint32_t x = 0; x < page.width; ++x) {
      if (colour_at(page, x, y) == Rgb8{255, 255, 255}) continue;
      ++inked;
      EXPECT_GE(static_cast<int>(x), 38);
      EXPECT_LE(static_cast<int>(x), end + 2);
      EXPECT_GE(y, 22U);
      EXPECT_LE(y, 47U);
    }
  }
  EXPECT_GT(inked, 100U);
  draw_text(page, "outside", -1000, 5000, 14, {0, 0, 0});
  draw_text(page, "", 10, 10, 14, {0, 0, 0});
}

TEST(Montage, EveryPictureIsThereAtTheSameScale) {
  std::vector<MontageItem> items;
  for (std::uint8_t i = 0; i < 3; ++i) {
    items.push_back({"picture\nof one colour", Picture(20, 10, {static_cast<std::uint8_t>(10 * i + 1), 200, 7})});
  }
  items.push_back({"blank", Picture()});
  MontageLayout layout;
  layout.columns = 2;
  layout.smallest_width = 50;
  const Picture sheet = montage(items, layout);
  for (const MontageItem& item : items) {
    if (item.picture.rgb.empty()) continue;
    EXPECT_EQ(count_colour(sheet, colour_at(item.picture, 0, 0)), 20U * 10U * 9U);  // factor 3: 60 >= 50
  }
  layout.title = "title";
  layout.note = "one\ntwo";
  layout.colour_bar = ColourBar{0, 1, true, "unit"};
  EXPECT_GT(montage(items, layout).height, sheet.height);
  EXPECT_EQ(montage(items, layout).width, sheet.width);
  items[0].label = std::string(500, 'x');  // shrinks, does not widen the sheet
  EXPECT_EQ(montage(items, layout).width, sheet.width);
}

TEST(Montage, NothingToShowIsRefused) {
  EXPECT_THROW(montage({}, {}), ConfigError);
  const MontageItem blank{"blank", Picture()};
  EXPECT_THROW(montage({&blank, 1}, {}), ConfigError);
  const MontageItem one{"one", Picture(2, 2)};
  MontageLayout layout;
  layout.columns = 0;
  EXPECT_THROW(montage({&one, 1}, layout), ConfigError);
}

}  // namespace
}  // namespace abn::harness
