#include "sampling/analysis/count_variation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sampling/draw_for_tests.h"
#include "sampling/error.h"
#include "sampling/jitter.h"
#include "sampling/random.h"

namespace abn::analysis {
namespace {

TEST(CountVariation, ByHand) {
  const std::vector<Vec2f> positions{{0.5F, 0.5F}, {0, 0.25F}, {0.75F, 0}, {1.0F, 0.5F}, {2.5F, 1.9F}, {2.0F, 1.0F}};
  // Counts 3 1 0 / 0 0 2: mean 1, variance (4 + 0 + 1 + 1 + 1 + 1) / 6.
  for (const CountVariation& counted :
       {count_variation({.position = positions}, {3, 2}), count_variation(to_unit(positions, {3, 2}), {3, 2})}) {
    EXPECT_DOUBLE_EQ(counted.mean, 1);
    EXPECT_DOUBLE_EQ(counted.coefficient, std::sqrt(8.0 / 6));
    EXPECT_EQ(counted.least, 0U);
    EXPECT_EQ(counted.most, 3U);
    EXPECT_EQ(counted.empty, 3U);
  }
}

TEST(CountVariation, OwnersArePreferredToPositions) {
  const std::vector<Vec2f> positions{{-5, 0}, {1e9F, 0}};
  const std::vector<std::uint32_t> pixel{0, 1};
  const CountVariation counted = count_variation({.position = positions, .pixel = pixel}, {2, 1});
  EXPECT_EQ(counted.coefficient, 0);
  EXPECT_EQ(counted.least, 1U);
  EXPECT_EQ(counted.most, 1U);
}

TEST(CountVariation, SetsHaveTheirAnchors) {
  // 240 000 samples on 200 x 200 pixels, measured with other code: white .408 = 1 / sqrt(6), jitter over the plane .19.
  const Extent plane{200, 200};
  const CountVariation white = count_variation({.position = draw<Random>(plane, 240'000, 1)}, plane);
  EXPECT_NEAR(white.coefficient, 1 / std::sqrt(6.0), 0.005);
  EXPECT_NEAR(static_cast<double>(white.empty), 40'000 * std::exp(-6.0), 40);  // Poisson: 99, standard deviation 10
  const CountVariation jitter = count_variation({.position = draw<JitterPlane>(plane, 240'000, 1)}, plane);
  EXPECT_NEAR(jitter.coefficient, 0.19, 0.01);
  const CountVariation pixel_jitter = count_variation({.position = draw<Jitter>(plane, 240'000, 1)}, plane);
  EXPECT_EQ(pixel_jitter.coefficient, 0);
  EXPECT_EQ(pixel_jitter.least, 6U);
}

TEST(CountVariation, WrongInputIsRefused) {
  const std::vector<Vec2f> inside{{0.5F, 0.5F}};
  const std::vector<Vec2f> outside{{0.5F, 1.0F}};
  const std::vector<Vec2f> bad{{std::numeric_limits<float>::quiet_NaN(), 0}};
  EXPECT_THROW(count_variation(SampleBatch{}, {1, 1}), ConfigError);
  EXPECT_THROW(count_variation(Points{}, {1, 1}), ConfigError);
  EXPECT_THROW(count_variation({.position = inside}, {0, 1}), ConfigError);
  EXPECT_THROW(count_variation({.position = outside}, {1, 1}), ConfigError);
  EXPECT_THROW(count_variation({.position = bad}, {1, 1}), ConfigError);
}

}  // namespace
}  // namespace abn::analysis
