#include "harness/error_structure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::harness {
namespace {

Image filled(Extent size, auto value) {
  Image image(size, 1);
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = 0; x < size.width; ++x) *image.texel(x, y) = static_cast<float>(value(x, y));
  }
  return image;
}

const Extent kSize{64, 48};
const Image kBlack = filled(kSize, [](auto, auto) { return 0.0; });

Image noise() {
  Rng rng(1, stream_id("error structure test"));
  return filled(kSize, [&](auto, auto) { return rng.uniform() - 0.5F; });
}

TEST(SpectralPeak, SingleWaveGivesHalfTheNumberOfPixels) {
  const Image wave = filled(
      kSize, [](auto x, auto y) { return 0.5 + 0.2 * std::cos(2 * std::numbers::pi * (5.0 * x / 64 + 7.0 * y / 48)); });
  EXPECT_NEAR(spectral_peak(wave, kBlack), 64 * 48 / 2.0, 1);
}

TEST(SpectralPeak, NoiseIsNearTheLogarithmOfHalfThePixels) {
  const double peak = spectral_peak(noise(), kBlack);
  EXPECT_GT(peak, std::log(64 * 48 / 2.0) - 3);
  EXPECT_LT(peak, std::log(64 * 48 / 2.0) + 6);
}

TEST(SpectralPeak, EqualImagesAndAConstantErrorHaveNone) {
  EXPECT_EQ(spectral_peak(kBlack, kBlack), 0);
  EXPECT_EQ(spectral_peak(filled(kSize, [](auto, auto) { return 0.25; }), kBlack), 0);
  EXPECT_THROW(spectral_peak(kBlack, Image({64, 47}, 1)), ConfigError);
}

TEST(SpectralPeak, SidesWithLargePrimeFactorsAreCutToFastOnes) {
  const Image wave = filled({67, 53}, [](auto x, auto y) {
    return 0.5 + 0.2 * std::cos(2 * std::numbers::pi * (5.0 * x / 64 + 6.0 * y / 50));
  });
  EXPECT_NEAR(spectral_peak(wave, Image({67, 53}, 1)), 64 * 50 / 2.0, 1);
}

TEST(ErrorRunLength, StripesHaveRunsOfTheirOwnLength) {
  // Rows of alternating sign: 64 px along the rows, 1 px along the columns; harmonic in the number of runs.
  const Image stripes = filled(kSize, [](auto, auto y) { return y % 2 == 0 ? 0.1 : -0.1; });
  const double pixels = 64 * 48;
  EXPECT_NEAR(error_run_length(stripes, kBlack), 2 * pixels / (48 + pixels), 1e-12);
  // Blocks of 8 x 8.
  const Image blocks = filled(kSize, [](auto x, auto y) { return (x / 8 + y / 8) % 2 == 0 ? 0.1 : -0.1; });
  EXPECT_NEAR(error_run_length(blocks, kBlack), 8, 1e-12);
}

TEST(ErrorRunLength, NoiseIsShort) {
  EXPECT_LT(error_run_length(noise(), kBlack), 2);
  EXPECT_EQ(error_run_length(kBlack, kBlack), 0);
}

}  // namespace
}  // namespace abn::harness
