#include "harness/film.h"

#include <gtest/gtest.h>

#include <cmath>

#include "harness/reconstruction.h"
#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::harness {
namespace {

constexpr Extent plane{8, 6};

std::vector<Vec2f> random_positions(std::size_t count, std::uint64_t seed) {
  std::vector<Vec2f> position(count);
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(seed, stream_id("film_test"), i);
    position[i] = to_plane(rng.uniform2(), plane);
  }
  return position;
}

std::vector<float> random_values(std::size_t count, std::uint64_t seed) {
  std::vector<float> values(count);
  Rng rng(seed, stream_id("film_test values"));
  for (float& value : values) value = rng.uniform();
  return values;
}

TEST(Film, MeanIsByTheActualCount) {
  for (const std::uint32_t channels : {1U, 3U}) {
    const auto position = random_positions(1000, 1);
    const auto values = random_values(1000 * channels, 2);
    Film film(plane, channels);
    // In two batches of unequal size, the twin in one direct sum.
    film.add({.position = std::span(position).first(137)}, std::span(values).first(137 * channels));
    film.add({.position = std::span(position).subspan(137)}, std::span(values).subspan(137 * channels));
    std::vector<long double> sum(plane.area() * channels);
    std::vector<std::uint64_t> count(plane.area());
    for (std::size_t i = 0; i < position.size(); ++i) {
      const std::size_t p = static_cast<std::size_t>(std::floor(position[i].y)) * plane.width +
                            static_cast<std::size_t>(std::floor(position[i].x));
      ++count[p];
      for (std::uint32_t c = 0; c < channels; ++c) sum[p * channels + c] += values[i * channels + c];
    }
    const Developed developed = film.develop();
    EXPECT_EQ(developed.samples, 1000U);
    EXPECT_EQ(developed.empty_pixels, 0U);
    EXPECT_EQ(developed.max_samples_per_pixel, *std::max_element(count.begin(), count.end()));
    for (std::size_t p = 0; p < plane.area(); ++p) {
      EXPECT_EQ(film.stats()[p].count, static_cast<float>(count[p]));
      for (std::uint32_t c = 0; c < channels; ++c) {
        const auto mean = static_cast<float>(sum[p * channels + c] / static_cast<long double>(count[p]));
        EXPECT_FLOAT_EQ(developed.image.texels[p * channels + c], mean);
      }
    }
  }
}

TEST(Film, AConstantIsReproducedExactly) {
  const auto position = random_positions(5000, 3);
  for (const float value : {0.1F, 0.0F, 0.5F, 1e-6F, 12345.678F}) {
    const std::vector<float> values(position.size(), value);
    const auto weight = random_values(position.size(), 4);
    for (const bool weighted : {false, true}) {
      Film film(plane, 1);
      film.add({.position = position, .weight = weighted ? std::span<const float>(weight) : std::span<const float>()},
               values);
      for (const float texel : film.develop().image.texels) EXPECT_EQ(texel, value);
      for (const PixelStats& stats : film.stats().cells()) EXPECT_EQ(stats.variance(), 0.0F);
    }
  }
}

TEST(Film, WeightsAreNormalisedByTheirSum) {
  Film film({2, 1}, 1);
  film.add({.position = std::vector<Vec2f>{{0.5F, 0.5F}, {0.1F, 0.2F}, {1.5F, 0.5F}},
            .weight = std::vector<float>{1, 3, 0.25F}},
           std::vector<float>{4, 8, 16});
  EXPECT_EQ(film.develop().image.texels, (std::vector<float>{7, 16}));
}

TEST(Film, AnOwnerOverridesThePosition) {
  Film film({2, 2}, 1);
  film.add(
      {.position = std::vector<Vec2f>{{-3, -3}, {0.5F, 0.5F}, {9, 9}}, .pixel = std::vector<std::uint32_t>{3, 1, 3}},
      std::vector<float>{1, 2, 3});
  const Developed developed = film.develop();
  EXPECT_EQ(developed.image.texels[3], 2.0F);
  EXPECT_EQ(developed.image.texels[1], 2.0F);
  EXPECT_EQ(developed.empty_pixels, 2U);
}

TEST(Film, StatisticsSurviveAHugeRange) {
  // 10^(12x/N - 6) inside one pixel, and the same on an offset: E[x^2] - E[x]^2 in float would give anything.
  for (const double offset : {0.0, 1000.0}) {
    constexpr int n = 400;
    std::vector<float> values;
    for (int i = 0; i < n; ++i) {
      values.push_back(static_cast<float>(offset > 0 ? offset + 0.001 * i : std::pow(10.0, 12.0 * i / n - 6)));
    }
    long double mean = 0;
    for (const float v : values) mean += v;
    mean /= n;
    long double squares = 0;
    for (const float v : values) squares += (v - mean) * (v - mean);
    Film film({1, 1}, 1);
    film.add({.position = std::vector<Vec2f>(n, {0.5F, 0.5F})}, values);
    EXPECT_EQ(film.develop().image.texels[0], static_cast<float>(mean));
    const auto variance = static_cast<float>(squares / (n - 1));
    // PixelStats is float: on the offset its mean is known to 6e-5 only, 2e-4 of the largest deviation.
    EXPECT_NEAR(film.stats()[0].variance(), variance, (offset > 0 ? 0.1F : 1e-3F) * variance);
  }
}

TEST(Film, StatisticsAreOfTheLuminance) {
  Film film({1, 1}, 3);
  film.add({.position = std::vector<Vec2f>(2, {0.5F, 0.5F})}, std::vector<float>{1, 0, 0, 0, 1, 0});
  EXPECT_FLOAT_EQ(film.stats()[0].mean, (0.2126F + 0.7152F) / 2);
  EXPECT_NEAR(film.stats()[0].variance(), (0.7152F - 0.2126F) * (0.7152F - 0.2126F) / 2, 1e-6);
  Film one({1, 1}, 3);
  one.add({.position = std::vector<Vec2f>(1, {0.5F, 0.5F})}, std::vector<float>{1, 1, 1});
  EXPECT_FALSE(one.stats()[0].known());
}

TEST(Film, EmptyPixelsAreFilledFromTheNearestAndCounted) {
  Film film({5, 1}, 1);
  film.add({.position = std::vector<Vec2f>{{0.5F, 0.5F}, {4.5F, 0.5F}}}, std::vector<float>{2, 4});
  const Developed developed = film.develop();
  EXPECT_EQ(developed.empty_pixels, 3U);
  EXPECT_EQ(developed.image.texels, (std::vector<float>{2, 2, 3, 4, 4}));
}

TEST(Film, OneSampleFillsAPlaneAndNoneLeavesItBlack) {
  Film film({200, 200}, 3);
  film.add({.position = std::vector<Vec2f>{{17.3F, 188.2F}}}, std::vector<float>{0.1F, 0.2F, 0.3F});
  const Developed developed = film.develop();
  EXPECT_EQ(developed.empty_pixels, 39'999U);
  for (std::size_t i = 0; i < developed.image.texels.size(); ++i) {
    ASSERT_EQ(developed.image.texels[i], (std::array<float, 3>{0.1F, 0.2F, 0.3F})[i % 3]);
  }
  const Developed nothing = Film({3, 3}, 1).develop();
  EXPECT_EQ(nothing.empty_pixels, 9U);
  EXPECT_EQ(nothing.image.texels, std::vector<float>(9, 0.0F));
}

TEST(Film, WeightsThatCancelCountAsEmpty) {
  Film film({2, 1}, 1);
  film.add({.position = std::vector<Vec2f>{{0.5F, 0.5F}, {0.5F, 0.5F}, {1.5F, 0.5F}},
            .weight = std::vector<float>{1, -1, 1}},
           std::vector<float>{4, 8, 16});
  const Developed developed = film.develop();
  EXPECT_EQ(developed.empty_pixels, 1U);
  EXPECT_EQ(developed.image.texels[0], 16.0F);
}

TEST(Reconstruction, RowsAreFoundByNameOrListed) {
  for (const auto& row : reconstructions()) {
    Film film({1, 1}, 1, row.needs_samples);
    film.add({.position = std::vector<Vec2f>(1, {0.5F, 0.5F})}, std::vector<float>{3});
    EXPECT_EQ(find_reconstruction(row.name).develop(film).image.texels[0], 3.0F);
    EXPECT_FALSE(row.summary.empty());
  }
  try {
    (void)find_reconstruction("median");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("mean"), std::string::npos);
  }
}

}  // namespace
}  // namespace abn::harness
