#include "harness/flip.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "harness/color.h"
#include "harness/image_io.h"
#include "sampling/rng.h"

namespace abn::harness {
namespace {

// Expected means are those of the authors' tool, version 1.6, at its default viewing conditions. They warn that the
// order of float operations differs between implementations.
constexpr double tolerance = 1e-4;

Image constant(std::uint32_t channels, std::initializer_list<float> colour) {
  Image image({64, 64}, channels);
  for (std::size_t i = 0; i < image.texels.size(); ++i) image.texels[i] = colour.begin()[i % colour.size()];
  return image;
}

Image rgb(float r, float g, float b) { return constant(3, {r, g, b}); }

Image load(const char* name) { return load_image(std::string(ABN_TEST_DATA_DIR) + "/flip/" + name, {}).image; }

TEST(LdrFlip, ConstantImagesMatchTheAuthors) {
  const Image black = rgb(0, 0, 0);
  const Image white = rgb(1, 1, 1);
  const float half = srgb_to_linear(128.0F / 255.0F);
  EXPECT_NEAR(ldr_flip(white, black).mean, 0.967345, tolerance);
  EXPECT_NEAR(ldr_flip(black, white).mean, 0.967345, tolerance);
  EXPECT_NEAR(ldr_flip(rgb(half, half, half), black).mean, 0.933854, tolerance);
  EXPECT_NEAR(ldr_flip(rgb(0, 1, 0), rgb(1, 0, 0)).mean, 0.986630, tolerance);
  EXPECT_NEAR(ldr_flip(rgb(0, 1, 0), rgb(0, 0, 1)).mean, 1.0, tolerance);
  EXPECT_NEAR(ldr_flip(rgb(0, 0, 1), black).mean, 0.958303, tolerance);
}

TEST(LdrFlip, OnePixelCheckerboardMatchesTheAuthors) {
  const Image white = rgb(1, 1, 1);
  Image checker = white;
  for (std::uint32_t y = 0; y < 64; ++y) {
    for (std::uint32_t x = y % 2; x < 64; x += 2) {
      for (int c = 0; c < 3; ++c) checker.texel(x, y)[c] = 0.0F;
    }
  }
  EXPECT_NEAR(ldr_flip(checker, white).mean, 0.537643, tolerance);
}

TEST(LdrFlip, EqualImagesDoNotDiffer) {
  const FlipResult result = ldr_flip(rgb(0.2F, 0.5F, 0.7F), rgb(0.2F, 0.5F, 0.7F));
  EXPECT_EQ(result.mean, 0.0);
  for (float value : result.map.cells()) EXPECT_EQ(value, 0.0F);
}

TEST(LdrFlip, GreyIsReplicated) {
  EXPECT_EQ(ldr_flip(constant(1, {0.3F}), constant(1, {0.6F})).mean,
            ldr_flip(rgb(0.3F, 0.3F, 0.3F), rgb(0.6F, 0.6F, 0.6F)).mean);
}

TEST(LdrFlip, PicturePairMatchesTheAuthors) {
  const FlipResult result = ldr_flip(load("apple200-test.png"), load("apple200-ref.png"));
  EXPECT_NEAR(result.mean, 0.134498, tolerance);
  const auto [low, high] = std::minmax_element(result.map.cells().begin(), result.map.cells().end());
  EXPECT_NEAR(*low, 0.000000F, 1e-3);
  EXPECT_NEAR(*high, 0.754621F, 1e-3);
}

TEST(HdrFlip, PicturePairMatchesTheAuthors) {
  const Image test = load("apple200-test.exr");
  const Image reference = load("apple200-ref.exr");
  const ExposureRange range = flip_exposures(test, reference);
  EXPECT_NEAR(range.start, -0.3949, 1e-4);
  EXPECT_NEAR(range.stop, 1.7613, 1e-4);
  EXPECT_EQ(range.count, 3);
  const FlipResult result = hdr_flip(test, reference);
  EXPECT_NEAR(result.mean, 0.146535, tolerance);
  const auto [low, high] = std::minmax_element(result.map.cells().begin(), result.map.cells().end());
  EXPECT_NEAR(*low, 0.000018F, 1e-3);
  EXPECT_NEAR(*high, 0.669923F, 1e-3);
}

TEST(HdrFlip, ConstantImagesMatchTheAuthors) {
  const Image test = constant(3, {2.0F});
  const Image reference = constant(3, {0.5F});
  const ExposureRange range = flip_exposures(test, reference);
  EXPECT_NEAR(range.start, 2.0833, 1e-4);
  EXPECT_NEAR(range.stop, 2.0833, 1e-4);
  EXPECT_EQ(range.count, 2);
  EXPECT_NEAR(hdr_flip(test, reference).mean, 0.191635, tolerance);
}

TEST(HdrFlip, BlackReferenceStillShowsADifference) {
  const Image black = constant(3, {0.0F});
  EXPECT_GT(hdr_flip(constant(3, {0.5F}), black).mean, 0.5);
  EXPECT_GT(hdr_flip(constant(3, {1e-6F}), black).mean, 0.5);  // exposed by the test image
  EXPECT_EQ(hdr_flip(black, black).mean, 0.0);
  EXPECT_GT(hdr_flip(black, constant(3, {0.5F})).mean, 0.5);
}

TEST(HdrFlip, MostlyBlackReferenceHasFiniteExposures) {
  Image reference = constant(1, {0.0F});
  for (std::uint32_t x = 0; x < 8; ++x) reference.texel(x, 0)[0] = x == 0 ? 100.0F : 1.0F;
  const ExposureRange range = flip_exposures(reference, reference);
  EXPECT_NEAR(range.stop - range.start, std::log2(100.0), 1e-9);  // the median of the lit pixels is 1
  EXPECT_EQ(range.count, 7);
  for (float& value : reference.texels) value = std::numeric_limits<float>::denorm_min();
  reference.texels[0] = std::numeric_limits<float>::max();
  EXPECT_EQ(flip_exposures(reference, reference).count, 32);
  EXPECT_EQ(hdr_flip(reference, reference).mean, 0.0);
}

TEST(Flip, NotANumberIsSeenAndDoesNoHarm) {
  Image test = constant(3, {0.5F});
  test.texel(10, 20)[1] = std::numeric_limits<float>::quiet_NaN();
  const Image reference = constant(3, {0.5F});
  for (const FlipResult& result : {ldr_flip(test, reference), hdr_flip(test, reference)}) {
    EXPECT_TRUE(std::isnan(result.mean));
    EXPECT_TRUE(std::isnan(result.map.at(10, 20)));
    EXPECT_EQ(result.map.at(60, 60), 0.0F);
  }
}

TEST(Flip, ResultDoesNotDependOnThreads) {
  Image test({300, 230}, 3);  // large enough to be shared among threads
  Image reference = test;
  Rng rng(1, stream_id("flip_test"));
  for (std::size_t i = 0; i < test.texels.size(); ++i) {
    reference.texels[i] = 4.0F * rng.uniform();
    test.texels[i] = reference.texels[i] + rng.uniform();
  }
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const FlipResult one = hdr_flip(test, reference);
  omp_set_num_threads(3);
  const FlipResult three = hdr_flip(test, reference);
  omp_set_num_threads(threads);
  EXPECT_EQ(one.mean, three.mean);
  EXPECT_TRUE(std::ranges::equal(one.map.cells(), three.map.cells()));
}

TEST(Flip, AnySizeIsAccepted) {
  for (const Extent size : {Extent{1, 1}, Extent{3, 2}, Extent{1, 40}}) {
    const Image black(size, 1);
    Image white(size, 1);
    for (float& value : white.texels) value = 1.0F;
    EXPECT_NEAR(ldr_flip(white, black).mean, 0.967345, tolerance);  // constant images: size plays no part
    EXPECT_GT(hdr_flip(white, black).mean, 0.5);
  }
}

}  // namespace
}  // namespace abn::harness
