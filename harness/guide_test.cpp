#include "harness/guide.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "harness/image_io.h"
#include "harness/scenes.h"
#include "sampling/error.h"
#include "sampling/test_folder.h"

namespace abn::harness {
namespace {

TEST(Guide, TrueVarianceOfACheckerboard) {
  // Squares of 3 texels, 1/4 and 3/4, in pixels of 6 texels on the left half; constant on the right half.
  Image source({24, 12}, 1);
  for (std::uint32_t y = 0; y < 12; ++y) {
    for (std::uint32_t x = 0; x < 24; ++x) *source.texel(x, y) = x >= 12 || (x / 3 + y / 3) % 2 == 0 ? 0.75F : 0.25F;
  }
  const auto guide = load_guide("true_variance", source, {4, 2});
  ASSERT_EQ(guide->size(), (Extent{4, 2}));
  for (std::uint32_t y = 0; y < 2; ++y) {
    for (std::uint32_t x = 0; x < 4; ++x) EXPECT_NEAR(guide->at(x, y), x < 2 ? 0.0625 : 0.0, 1e-7) << x << " " << y;
  }
}

TEST(Guide, TrueVarianceIsOfLuminanceAndWithinThePixel) {
  // Red against a green of the same luminance, and a step at a pixel's border: no variance inside any pixel.
  Image source({4, 2}, 3);
  for (std::uint32_t y = 0; y < 2; ++y) {
    source.texel(0, y)[0] = 0.5F;
    source.texel(1, y)[1] = 0.5F * 0.2126F / 0.7152F;
    for (std::uint32_t x = 2; x < 4; ++x) source.texel(x, y)[2] = 1;
  }
  const auto guide = load_guide("true_variance", source, {2, 1});
  EXPECT_NEAR(guide->at(0, 0), 0, 1e-8);
  EXPECT_NEAR(guide->at(1, 0), 0, 1e-8);
}

TEST(Guide, TrueVarianceMatchesItsDefinitionWherePixelsCutTexels) {
  const Image source = render_scene(find_scene("fbm"), {50, 50});
  const Extent to{8, 8};
  const auto guide = load_guide("true_variance", source, to);
  for (std::uint32_t y = 0; y < 8; ++y) {
    for (std::uint32_t x = 0; x < 8; ++x) {
      double weight = 0;
      double sum = 0;
      double squares = 0;
      for (std::uint32_t v = 0; v < 50; ++v) {
        for (std::uint32_t u = 0; u < 50; ++u) {
          const auto overlap = [](double texel, double pixel) {
            return std::max(0.0, std::min(texel + 1, (pixel + 1) * 6.25) - std::max(texel, pixel * 6.25));
          };
          const double area = overlap(u, x) * overlap(v, y);
          const double value = *source.texel(u, v);
          weight += area;
          sum += area * value;
          squares += area * value * value;
        }
      }
      const double variance = squares / weight - (sum / weight) * (sum / weight);
      EXPECT_NEAR(guide->at(x, y), variance, 2e-7) << x << " " << y;
    }
  }
}

TEST(Guide, AFileIsItsLuminanceWithoutNegativeValues) {
  const TestFolder folder;
  Image image({3, 1}, 3);
  image.texels = {1, 1, 1, 0, 2, 0, -1, 0, 0};
  const std::string path = (folder.path() / "guide.exr").string();
  save_image(path, image, {.depth = "float"});
  // Its own resolution: whoever reads it stretches it over the plane.
  const auto guide = load_guide(path, Image({10, 10}, 1), {5, 5});
  ASSERT_EQ(guide->size(), (Extent{3, 1}));
  EXPECT_NEAR(guide->at(0, 0), 1, 1e-6);
  EXPECT_NEAR(guide->at(1, 0), 2 * 0.7152, 1e-6);
  EXPECT_EQ(guide->at(2, 0), 0);
}

TEST(Guide, FilesThatAreNoneAreRefused) {
  const TestFolder folder;
  const Image source({10, 10}, 1);
  EXPECT_THROW(load_guide((folder.path() / "nowhere.png").string(), source, {5, 5}), IoError);
  const std::string text = (folder.path() / "text.png").string();
  std::ofstream(text) << "this is text";
  EXPECT_THROW(load_guide(text, source, {5, 5}), IoError);
  const std::string nan = (folder.path() / "nan.exr").string();
  Image image({2, 1}, 1);
  image.texels = {1, std::nanf("")};
  save_image(nan, image, {.depth = "float"});
  EXPECT_THROW(load_guide(nan, source, {5, 5}), IoError);
}

}  // namespace
}  // namespace abn::harness
