#include "harness/sample_bins.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "harness/reconstruction_cases.h"

namespace abn::harness {
namespace {

void position_as_value(Vec2f p, float* value) {
  value[0] = p.x;
  value[1] = p.y;
  value[2] = p.x * p.y;
}

TEST(SampleBins, HoldsEverySampleOfPositiveWeightInItsPixel) {
  const Extent plane{7, 5};
  const auto position = scattered(plane, 500, 1);
  std::vector<float> weight(position.size());
  for (std::size_t i = 0; i < weight.size(); ++i) weight[i] = static_cast<float>(i % 3) - 0.5F;
  const Film film = film_of(plane, 3, position, position_as_value, weight);
  const SampleBins bins(film);
  EXPECT_EQ(bins.size(), 333U);
  std::vector<std::size_t> wanted(plane.area());
  for (std::size_t i = 0; i < position.size(); ++i) {
    if (weight[i] > 0) ++wanted[static_cast<std::size_t>(position[i].y) * 7 + static_cast<std::size_t>(position[i].x)];
  }
  for (std::size_t p = 0; p < plane.area(); ++p) {
    EXPECT_EQ(bins.end(p) - bins.begin(p), wanted[p]);
    for (std::uint32_t i = bins.begin(p); i < bins.end(p); ++i) {
      EXPECT_EQ(std::floor(bins.x()[i]), static_cast<float>(p % 7));
      EXPECT_EQ(std::floor(bins.y()[i]), static_cast<float>(p / 7));
      EXPECT_EQ(bins.value(i)[0], bins.x()[i]);
      EXPECT_EQ(bins.value(i)[2], bins.x()[i] * bins.y()[i]);
      EXPECT_EQ(bins.luminances()[i], luminance(bins.value(i), 3));
    }
  }
}

TEST(SampleBins, GathersWhatBruteForceFinds) {
  const Extent plane{6, 4};
  const SampleBins bins(film_of(plane, 3, scattered(plane, 300, 2), position_as_value));
  std::vector<std::uint32_t> found{1, 2, 3};
  for (const float margin : {0.0F, 0.25F, 1.7F, 20.0F}) {
    for (const bool round : {false, true}) {
      for (std::uint32_t p = 0; p < plane.area(); ++p) {
        const auto left = static_cast<float>(p % 6);
        const auto top = static_cast<float>(p / 6);
        std::vector<std::uint32_t> wanted;
        for (std::uint32_t i = 0; i < bins.size(); ++i) {
          const float dx = std::max({left - bins.x()[i], bins.x()[i] - left - 1, 0.0F});
          const float dy = std::max({top - bins.y()[i], bins.y()[i] - top - 1, 0.0F});
          if (round ? std::hypot(dx, dy) <= margin : std::max(dx, dy) <= margin) wanted.push_back(i);
        }
        bins.gather(p % 6, p / 6, margin, round, found);
        EXPECT_EQ(found, wanted) << margin << ' ' << round << ' ' << p;
      }
    }
  }
}

TEST(SampleBins, MapsValuesAndLuminances) {
  SampleBins bins(film_of({2, 1}, 3, {{0.5F, 0.5F}, {1.5F, 0.25F}}, position_as_value));
  bins.map_values([](float value) { return 2 * value; });
  EXPECT_EQ(bins.value(1)[0], 3.0F);
  EXPECT_EQ(bins.luminances()[1], luminance(bins.value(1), 3));
}

TEST(SampleBins, IsEmptyWithoutSamples) {
  const SampleBins bins(Film({3, 3}, 1, true));
  EXPECT_EQ(bins.size(), 0U);
  std::vector<std::uint32_t> found{7};
  bins.gather(1, 1, 5, true, found);
  EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace abn::harness
