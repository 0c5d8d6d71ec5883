#include "harness/truth.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::harness {
namespace {

Image noise(Extent size, std::uint32_t channels) {
  Image image(size, channels);
  Rng rng(1, stream_id("truth_test"), size.width);
  for (float& texel : image.texels) texel = rng.uniform();
  return image;
}

// The nearest truth without shared code: per pixel, texel borders in long double.
double brute_nearest(const Image& image, Extent to, std::uint32_t ox, std::uint32_t oy, std::uint32_t c) {
  const long double sx = static_cast<long double>(image.size.width) / to.width;
  const long double sy = static_cast<long double>(image.size.height) / to.height;
  long double sum = 0;
  for (std::uint32_t y = 0; y < image.size.height; ++y) {
    const long double dy = std::min<long double>(y + 1, (oy + 1) * sy) - std::max<long double>(y, oy * sy);
    if (dy <= 0) continue;
    for (std::uint32_t x = 0; x < image.size.width; ++x) {
      const long double dx = std::min<long double>(x + 1, (ox + 1) * sx) - std::max<long double>(x, ox * sx);
      if (dx > 0) sum += dx * dy * image.texel(x, y)[c];
    }
  }
  return static_cast<double>(sum / (sx * sy));
}

// The bilinear truth by two-point Gauss quadrature on every cell between texel centres and pixel borders, where the
// interpolant is bilinear and the rule exact.
double brute_bilinear(const Image& image, Extent to, std::uint32_t ox, std::uint32_t oy, std::uint32_t c) {
  const auto nodes = [](double begin, double end) {
    std::vector<std::pair<double, double>> points;  // position [texel], weight
    const double half = 0.5 / std::sqrt(3.0);
    for (double a = begin; a < end - 1e-12;) {
      const double b = std::min(end, std::floor(a + 0.5 + 1e-9) + 0.5);
      const double length = b - a;
      points.emplace_back((a + b) / 2 - half * length, length / 2);
      points.emplace_back((a + b) / 2 + half * length, length / 2);
      a = b;
    }
    return points;
  };
  const auto value = [&](double u, double v) {
    u = std::clamp(u - 0.5, 0.0, image.size.width - 1.0);
    v = std::clamp(v - 0.5, 0.0, image.size.height - 1.0);
    const auto x = static_cast<std::uint32_t>(u);
    const auto y = static_cast<std::uint32_t>(v);
    const std::uint32_t x1 = std::min(x + 1, image.size.width - 1);
    const std::uint32_t y1 = std::min(y + 1, image.size.height - 1);
    const double fx = u - x;
    const double fy = v - y;
    return (1 - fy) * ((1 - fx) * image.texel(x, y)[c] + fx * image.texel(x1, y)[c]) +
           fy * ((1 - fx) * image.texel(x, y1)[c] + fx * image.texel(x1, y1)[c]);
  };
  const double sx = static_cast<double>(image.size.width) / to.width;
  const double sy = static_cast<double>(image.size.height) / to.height;
  double sum = 0;
  for (const auto& [v, wv] : nodes(oy * sy, (oy + 1) * sy)) {
    for (const auto& [u, wu] : nodes(ox * sx, (ox + 1) * sx)) sum += wu * wv * value(u, v);
  }
  return sum / (sx * sy);
}

struct Case {
  Extent from, to;
};

const std::vector<Case> cases = {{{60, 60}, {4, 4}},  {{60, 60}, {7, 7}}, {{59, 61}, {4, 4}},  {{59, 61}, {9, 5}},
                                 {{1, 60}, {4, 4}},   {{60, 1}, {4, 4}},  {{1, 1}, {3, 2}},    {{5, 3}, {12, 20}},
                                 {{6, 6}, {6, 6}},    {{6, 6}, {12, 18}}, {{60, 60}, {1, 1}},  {{60, 59}, {59, 60}},
                                 {{64, 10}, {1, 10}}, {{2, 2}, {3, 3}},   {{37, 23}, {37, 1}}, {{30, 20}, {15, 20}}};

TEST(ExactTruth, MatchesAnIndependentSumForAnyRatio) {
  for (const Case& k : cases) {
    for (const std::uint32_t channels : {1U, 3U}) {
      const Image image = noise(k.from, channels);
      const GroundTruth nearest = exact_truth(image, k.to);
      const GroundTruth bilinear = exact_truth(image, k.to, Interpolation::bilinear);
      EXPECT_TRUE(nearest.standard_error.texels.empty());
      EXPECT_EQ(nearest.method, "exact");
      for (std::uint32_t y = 0; y < k.to.height; ++y) {
        for (std::uint32_t x = 0; x < k.to.width; ++x) {
          for (std::uint32_t c = 0; c < channels; ++c) {
            const double expected = brute_nearest(image, k.to, x, y, c);
            ASSERT_NEAR(nearest.image.texel(x, y)[c], expected, 6.1e-8 * expected)
                << k.from.width << "x" << k.from.height << " to " << k.to.width << "x" << k.to.height;
            const double smooth = brute_bilinear(image, k.to, x, y, c);
            ASSERT_NEAR(bilinear.image.texel(x, y)[c], smooth, 6.1e-8 * smooth + 1e-12)
                << k.from.width << "x" << k.from.height << " to " << k.to.width << "x" << k.to.height;
          }
        }
      }
    }
  }
}

TEST(ExactTruth, BlocksAndWeightsAgree) {
  for (const std::uint32_t channels : {1U, 3U}) {
    for (const Extent to : {Extent{20, 20}, Extent{300, 300}, Extent{1, 1}, Extent{150, 4}, Extent{3, 75}}) {
      const Image image = noise({300, 300}, channels);
      const Image blocks = detail::block_mean(image, to);
      const Image weights = detail::weighted_mean(image, to, Interpolation::nearest);
      for (std::size_t i = 0; i < blocks.texels.size(); ++i) EXPECT_FLOAT_EQ(blocks.texels[i], weights.texels[i]);
    }
  }
}

TEST(ExactTruth, AConstantIsReproducedExactly) {
  for (const Case& k : cases) {
    Image image(k.from, 3);
    for (std::size_t i = 0; i < image.texels.size(); ++i) image.texels[i] = i % 3 == 0 ? 0.1F : 1e-6F;
    for (const auto interpolation : {Interpolation::nearest, Interpolation::bilinear}) {
      const Image mean = exact_truth(image, k.to, interpolation).image;
      for (std::size_t i = 0; i < mean.texels.size(); ++i) ASSERT_EQ(mean.texels[i], i % 3 == 0 ? 0.1F : 1e-6F);
    }
  }
}

TEST(ExactTruth, AgreesWithOpenCvInterArea) {
  const Image image = noise({300, 450}, 3);
  for (const Extent to : {Extent{20, 30}, Extent{199, 101}, Extent{7, 450}}) {
    const Image mean = exact_truth(image, to).image;
    Image area(to, 3);
    const cv::Mat from(450, 300, CV_32FC3, const_cast<float*>(image.texels.data()));
    cv::Mat into(static_cast<int>(to.height), static_cast<int>(to.width), CV_32FC3, area.texels.data());
    cv::resize(from, into, into.size(), 0, 0, cv::INTER_AREA);
    for (std::size_t i = 0; i < mean.texels.size(); ++i) EXPECT_NEAR(mean.texels[i], area.texels[i], 2e-6);
  }
}

TEST(ExactTruth, HardCasesHaveTheirKnownValues) {
  // A checkerboard of single texels under 15 x 15 blocks: 113 or 112 white ones of 225.
  Image board({60, 60}, 1);
  for (std::uint32_t y = 0; y < 60; ++y) {
    for (std::uint32_t x = 0; x < 60; ++x) board.texel(x, y)[0] = (x + y) % 2 == 0 ? 1.0F : 0.0F;
  }
  const Image mean = exact_truth(board, {4, 4}).image;
  EXPECT_EQ(mean.texel(0, 0)[0], 113.0F / 225);
  EXPECT_EQ(mean.texel(1, 0)[0], 112.0F / 225);
  // A step 7 texels beyond a pixel border leaves a column of 8/15.
  Image step({60, 15}, 1);
  for (std::uint32_t y = 0; y < 15; ++y) {
    for (std::uint32_t x = 37; x < 60; ++x) step.texel(x, y)[0] = 1;
  }
  EXPECT_EQ(exact_truth(step, {4, 1}).image.texels, (std::vector<float>{0, 0, 8.0F / 15, 1}));
  // One bright texel.
  Image firefly({15, 15}, 1);
  for (float& texel : firefly.texels) texel = 0.5F;
  firefly.texel(3, 4)[0] = 1e4F;
  EXPECT_FLOAT_EQ(exact_truth(firefly, {1, 1}).image.texels[0], static_cast<float>((224 * 0.5 + 1e4) / 225));
  // Twelve decades from left to right.
  Image decades({3000, 2}, 1);
  for (std::uint32_t x = 0; x < 3000; ++x) {
    decades.texel(x, 0)[0] = decades.texel(x, 1)[0] = static_cast<float>(std::pow(10.0, 12.0 * x / 3000 - 6));
  }
  const Image bright = exact_truth(decades, {200, 1}).image;
  for (std::uint32_t o = 0; o < 200; ++o) {
    const double expected = brute_nearest(decades, {200, 1}, o, 0, 0);
    EXPECT_NEAR(bright.texels[o], expected, 6.1e-8 * expected);
  }
}

TEST(ExactTruth, ThreadsDoNotMatter) {
  const Image image = noise({301, 299}, 3);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const auto one = exact_truth(image, {40, 31}).image.texels;
  const auto one_block = exact_truth(image, {43, 23}).image.texels;
  const auto one_random = monte_carlo_truth(ImageIntegrand(image, {9, 7}), 33, 5).image.texels;
  omp_set_num_threads(3);
  EXPECT_EQ(exact_truth(image, {40, 31}).image.texels, one);
  EXPECT_EQ(exact_truth(image, {43, 23}).image.texels, one_block);
  EXPECT_EQ(monte_carlo_truth(ImageIntegrand(image, {9, 7}), 33, 5).image.texels, one_random);
  omp_set_num_threads(threads);
}

TEST(MonteCarloTruth, LiesAroundTheExactTruthByItsStandardError) {
  const Image image = noise({90, 90}, 3);
  const Extent to{15, 15};
  for (const auto interpolation : {Interpolation::nearest, Interpolation::bilinear}) {
    const Image exact = exact_truth(image, to, interpolation).image;
    const ImageIntegrand integrand(image, to, interpolation);
    const GroundTruth random = monte_carlo_truth(integrand, 3000, 7);
    EXPECT_EQ(random.method, "monte_carlo:3000");
    double squares = 0;
    double worst = 0;
    for (std::size_t i = 0; i < exact.texels.size(); ++i) {
      const double z = (random.image.texels[i] - exact.texels[i]) / random.standard_error.texels[i];
      squares += z * z;
      worst = std::max(worst, std::abs(z));
    }
    // 675 standard normal numbers: their mean square is 1 +- .054, one beyond 5 has p = 4e-4.
    EXPECT_NEAR(squares / static_cast<double>(exact.texels.size()), 1.0, 4 * 0.055);
    EXPECT_LT(worst, 5);
  }
}

TEST(MonteCarloTruth, StandardErrorIsThatOfTheTexels) {
  // Two texels, 0 and 1, share a pixel: the variance is 1/4, on any offset.
  for (const float offset : {0.0F, 1000.0F}) {
    Image image({2, 1}, 1);
    image.texels = {offset, offset + 1};
    const GroundTruth truth = monte_carlo_truth(ImageIntegrand(image, {1, 1}), 10'000, 1);
    EXPECT_NEAR(truth.standard_error.texels[0], 0.005, 1e-5);
    EXPECT_NEAR(truth.image.texels[0] - offset, 0.5, 5 * 0.005);
  }
  Image flat({4, 4}, 1);
  for (float& texel : flat.texels) texel = 0.1F;
  const GroundTruth truth = monte_carlo_truth(ImageIntegrand(flat, {2, 2}), 100, 1);
  EXPECT_EQ(truth.image.texels, std::vector<float>(4, 0.1F));
  EXPECT_EQ(truth.standard_error.texels, std::vector<float>(4, 0.0F));
}

TEST(MonteCarloTruth, SeedsDifferAndTooFewSamplesAreRefused) {
  const Image image = noise({30, 30}, 1);
  const ImageIntegrand integrand(image, {2, 2});
  EXPECT_NE(monte_carlo_truth(integrand, 10, 1).image.texels, monte_carlo_truth(integrand, 10, 2).image.texels);
  EXPECT_THROW(monte_carlo_truth(integrand, 1, 1), ConfigError);
  EXPECT_THROW(monte_carlo_truth(integrand, 0, 1), ConfigError);
}

TEST(GroundTruth, StandardErrorIsSummedUpOverPixelsAndChannels) {
  GroundTruth truth;
  EXPECT_EQ(standard_error_rms(truth), 0);  // exact
  truth.standard_error = Image({2, 1}, 1);
  truth.standard_error.texels = {3.0F, 4.0F};
  EXPECT_DOUBLE_EQ(standard_error_rms(truth), std::sqrt(12.5));
}

}  // namespace
}  // namespace abn::harness
