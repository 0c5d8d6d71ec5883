#include "harness/apple_analytic.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "harness/image_io.h"

namespace abn::harness {
namespace {

std::string hash_with_threads(int threads, Extent size) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  const std::string hash = pixel_hash(render_apple_analytic(size));
  omp_set_num_threads(before);
  return hash;
}

TEST(AppleAnalytic, SameBitsForAnyNumberOfThreads) {
  const Extent size{1200, 60};  // rows long enough for the parallel loop
  EXPECT_EQ(hash_with_threads(1, size), hash_with_threads(2, size));
  EXPECT_EQ(hash_with_threads(1, size), hash_with_threads(5, size));
}

TEST(AppleAnalytic, IsAFunctionOfThePlaneAndNotOfTexels) {
  // The same point of the picture on planes of three sizes; powers of two, so that the position scales exactly.
  const AppleAnalytic small({128, 128}), large({1024, 1024});
  std::vector<Vec2f> at_small, at_large;
  for (int i = 0; i < 500; ++i) {
    const Vec2f p{static_cast<float>((i * 37) % 512) / 4 + 0.0625F, static_cast<float>((i * 91) % 512) / 4 + 0.0625F};
    at_small.push_back(p);
    at_large.push_back(p * 8);
  }
  std::vector<float> a(1500), b(1500);
  small.evaluate(at_small, a);
  large.evaluate(at_large, b);
  EXPECT_EQ(a, b);
}

TEST(AppleAnalytic, RenderIsTheEvaluationAtTexelCentres) {
  const Extent size{30, 20};
  const Image image = render_apple_analytic(size);
  const AppleAnalytic apple(size);
  std::vector<float> value(3);
  for (std::uint32_t y = 0; y < size.height; y += 7) {
    for (std::uint32_t x = 0; x < size.width; x += 7) {
      const Vec2f centre{static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F};
      apple.evaluate(std::span(&centre, 1), value);
      for (std::uint32_t c = 0; c < 3; ++c) EXPECT_EQ(image.texel(x, y)[c], value[c]);
    }
  }
}

TEST(AppleAnalytic, ValuesAreFiniteAndInUnitRange) {
  const Image image = render_apple_analytic({500, 500});
  for (const float value : image.texels) {
    ASSERT_GE(value, 0.0F);
    ASSERT_LE(value, 1.0F);
  }
}

TEST(AppleAnalytic, AnyFinitePositionGivesAValue) {
  const float huge = std::numeric_limits<float>::max();
  const std::vector<Vec2f> positions{{-50, -50}, {500, 500}, {huge, 0}, {0, huge}, {-huge, 1}, {0, -huge}, {100, 29}};
  std::vector<float> values(3 * positions.size());
  AppleAnalytic({200, 200}).evaluate(positions, values);
  for (const float value : values) EXPECT_TRUE(std::isfinite(value));
}

TEST(AppleAnalytic, ShowsSkyCheckersSkinAndStalk) {
  const Extent size{200, 200};
  const Image image = render_apple_analytic(size);
  const float* sky = image.texel(100, 5);
  EXPECT_GT(luminance(sky, 3), 0.6F);
  const float* skin = image.texel(100, 100);
  EXPECT_GT(skin[1], skin[0]);
  EXPECT_GT(skin[0], 3 * skin[2]);
  const float* stalk = image.texel(104, 65);
  EXPECT_LT(luminance(stalk, 3), 0.25F);
  EXPECT_GT(stalk[0], stalk[2]);
  std::vector<float> front;
  for (std::uint32_t x = 0; x < 200; ++x) front.push_back(luminance(image.texel(x, 190), 3));
  const auto [dark, light] = std::minmax_element(front.begin(), front.end());
  EXPECT_GT(*light, 10 * *dark);
}

}  // namespace
}  // namespace abn::harness
