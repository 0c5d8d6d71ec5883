#include "harness/sample_picture.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "sampling/error.h"

namespace abn::harness {
namespace {

constexpr Extent plane{40, 20};

Rgb8 colour_at(const Picture& picture, std::uint32_t x, std::uint32_t y) {
  Rgb8 colour{};
  std::copy_n(picture.pixel(x, y), 3, colour.data());
  return colour;
}

TEST(SamplePicture, DotsAndGhostsStandWhereTheyAre) {
  const Vec2f samples[] = {{0.5F, 0.5F}, {39.5F, 19.5F}};
  const Vec2f ghosts[] = {{-1.0F, 10.0F}, {20.0F, 21.0F}};
  const PlaneRegion region = region_around(plane, ghosts);
  EXPECT_LT(region.left, -1);
  EXPECT_EQ(region.top, 0);
  EXPECT_EQ(region.right, 40);
  EXPECT_GT(region.bottom, 21);
  const Picture picture = draw_samples(samples, ghosts, plane, region);
  EXPECT_NEAR(picture.width, 1000, 1);
  const double scale = 1000 / (region.right - region.left);
  const auto at = [&](double x, double y) {
    return colour_at(picture, static_cast<std::uint32_t>((x - region.left) * scale),
                     static_cast<std::uint32_t>((y - region.top) * scale));
  };
  EXPECT_EQ(at(0.5, 0.5), (Rgb8{255, 255, 255}));
  EXPECT_EQ(at(39.5, 19.5), (Rgb8{255, 255, 255}));
  EXPECT_EQ(at(-1, 10), (Rgb8{86, 180, 233}));
  EXPECT_EQ(at(20, 21), (Rgb8{86, 180, 233}));
  EXPECT_EQ(at(20.5, 10.5), (Rgb8{0, 0, 0}));
}

TEST(SamplePicture, ARegionShowsItsPartOnly) {
  std::vector<Vec2f> samples;
  for (int i = 0; i < 40; ++i) samples.push_back({static_cast<float>(i) + 0.5F, 5.5F});
  const Picture picture = draw_samples(samples, {}, plane, {10, 5, 20, 10});
  EXPECT_EQ(picture.width, 1000U);
  EXPECT_EQ(picture.height, 500U);
  for (std::uint32_t i = 0; i < 10; ++i) {
    EXPECT_EQ(colour_at(picture, 100 * i + 50, 50), (Rgb8{255, 255, 255})) << i;
    EXPECT_EQ(colour_at(picture, 100 * i + 50, 150), (Rgb8{0, 0, 0})) << i;
  }
}

TEST(SamplePicture, AWholePlaneOfAnySizeStaysAPicture) {
  EXPECT_EQ(draw_samples({}, {}, {200, 100}, region_around({200, 100}, {})).width, 2000U);
  EXPECT_EQ(draw_samples({}, {}, {3000, 1500}, region_around({3000, 1500}, {})).width, 4000U);
  EXPECT_EQ(draw_samples({}, {}, {1, 1}, region_around({1, 1}, {})).width, 400U);  // the widest a pixel gets
}

TEST(SamplePicture, CrowdedSamplesGetSmallDots) {
  std::vector<Vec2f> samples;
  for (int i = 0; i < 100; ++i) {
    samples.push_back({5 + 0.05F + 0.1F * static_cast<float>(i % 10), 5 + 0.05F + 0.1F * static_cast<float>(i / 10)});
  }
  const Picture picture = draw_samples(samples, {}, plane, {5, 5, 6, 6});
  std::size_t lit = 0;
  for (std::size_t i = 0; i < picture.rgb.size(); i += 3) lit += picture.rgb[i] > 200 ? 1 : 0;
  EXPECT_LT(lit, picture.rgb.size() / 3 / 2);
  EXPECT_GT(lit, picture.rgb.size() / 3 / 10);
}

TEST(SamplePicture, RegionsOfWrongWordsAreRefused) {
  const PlaneRegion region = parse_plane_region("-1.5,0,20,20.25", "--points-region", plane);
  EXPECT_EQ(region.left, -1.5);
  EXPECT_EQ(region.bottom, 20.25);
  for (const char* word : {"", "1,2,3", "1,2,3,4,5", "a,0,1,1", "0,0,1,1x", "5,0,5,1", "0,5,1,4", "nan,0,1,1",
                           "0,0,inf,1", "41,0,50,5", "0,-9,5,0", "0,0,1e9,1", "0 0 1 1"}) {
    EXPECT_THROW(parse_plane_region(word, "--points-region", plane), ConfigError) << word;
  }
}

}  // namespace
}  // namespace abn::harness
