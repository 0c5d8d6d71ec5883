#include "harness/metrics.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "harness/color.h"
#include "harness/image_io.h"
#include "harness/oiio_compare.h"
#include "harness/ssim.h"
#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::harness {
namespace {

Image image(Extent size, std::uint32_t channels, std::initializer_list<float> texels) {
  Image result(size, channels);
  result.texels.assign(texels);
  return result;
}

Image noise(Extent size, std::uint32_t channels, std::uint64_t seed, float scale = 1.0F) {
  Image result(size, channels);
  Rng rng(seed, stream_id("metrics_test"));
  for (float& texel : result.texels) texel = scale * rng.uniform();
  return result;
}

double score(const char* name, const Image& test, const Image& reference, bool high_dynamic_range = false) {
  return find_metric(name).score({test, reference, high_dynamic_range});
}

// One row of two RGB pixels, with values that are exact in float.
const Image hand_test = image({2, 1}, 3, {0.5F, 0.25F, 1.0F, 0.0F, 0.75F, 2.0F});
const Image hand_reference = image({2, 1}, 3, {0.25F, 0.5F, 1.0F, 0.0F, 0.25F, 4.0F});

TEST(Metrics, ScoresMatchHandComputedValues) {
  // differences .25 -.25 0 | 0 .5 -2
  EXPECT_DOUBLE_EQ(score("rmse", hand_test, hand_reference), std::sqrt((0.0625 + 0.0625 + 0.25 + 4.0) / 6.0));
  EXPECT_DOUBLE_EQ(score("mae", hand_test, hand_reference), 3.0 / 6.0);
  EXPECT_DOUBLE_EQ(score("bias", hand_test, hand_reference), -1.5 / 6.0);
  EXPECT_DOUBLE_EQ(score("psnr", hand_test, hand_reference), -20.0 * std::log10(std::sqrt(4.375 / 6.0)));
  EXPECT_DOUBLE_EQ(score("relmse", hand_test, hand_reference),
                   (0.0625 / 0.0725 + 0.0625 / 0.26 + 0.25 / 0.0725 + 4.0 / 16.01) / 6.0);
  EXPECT_DOUBLE_EQ(score("smape", hand_test, hand_reference),
                   (0.25 / 0.76 + 0.25 / 0.76 + 0.5 / 1.01 + 2.0 / 6.01) / 6.0);
  const double tone_mapped = std::pow(1.0 / 3.0 - 0.2, 2) + std::pow(0.2 - 1.0 / 3.0, 2) +
                             std::pow(0.75 / 1.75 - 0.2, 2) + std::pow(2.0 / 3.0 - 0.8, 2);
  EXPECT_NEAR(score("rmse_tonemapped", hand_test, hand_reference), std::sqrt(tone_mapped / 6.0), 1e-15);
}

TEST(Metrics, MapsMatchHandComputedValues) {
  const MetricInput input{hand_test, hand_reference};
  EXPECT_FLOAT_EQ(find_metric("mae").map(input).at(0, 0), 0.5F / 3.0F);
  EXPECT_FLOAT_EQ(find_metric("mae").map(input).at(1, 0), 2.5F / 3.0F);
  EXPECT_FLOAT_EQ(find_metric("rmse").map(input).at(1, 0), std::sqrt(4.25F / 3.0F));
  EXPECT_FLOAT_EQ(find_metric("bias").map(input).at(1, 0), -0.5F);
}

TEST(Metrics, MapsAverageToTheScore) {
  const Image test = noise({23, 17}, 3, 1);
  const Image reference = noise({23, 17}, 3, 2);
  for (const bool high_dynamic_range : {false, true}) {
    const MetricInput input{test, reference, high_dynamic_range};
    for (const Metric& metric : metrics()) {
      if (!metric.map) continue;
      const bool root = metric.name.starts_with("rmse");
      const Grid<float> map = metric.map(input);
      double sum = 0;
      for (float value : map.cells()) sum += root ? double{value} * value : double{value};
      const double mean = sum / static_cast<double>(map.cells().size());
      EXPECT_NEAR(root ? std::sqrt(mean) : mean, metric.score(input), 1e-6) << metric.name;
    }
  }
}

TEST(Metrics, EqualImagesAreBest) {
  const Image same = noise({40, 30}, 3, 3);
  for (const char* name : {"rmse", "mae", "bias", "relmse", "smape", "rmse_tonemapped", "flip", "yee_failures",
                           "differing_pixels", "spectral_peak", "error_run_length"}) {
    EXPECT_EQ(score(name, same, same), 0.0) << name;
  }
  EXPECT_NEAR(score("ssim", same, same), 1.0, 1e-12);
  EXPECT_TRUE(std::isinf(score("psnr", same, same)));
}

TEST(Metrics, BlackAgainstBlackIsNoRelativeError) {
  const Image black({4, 4}, 1);
  EXPECT_EQ(score("relmse", black, black), 0.0);
  EXPECT_EQ(score("smape", black, black), 0.0);
}

TEST(Metrics, BlackAndWhiteHaveClosedForms) {
  const Image black({32, 32}, 1);
  Image white({32, 32}, 1);
  for (float& texel : white.texels) texel = 1.0F;
  EXPECT_DOUBLE_EQ(score("rmse", black, white), 1.0);
  EXPECT_DOUBLE_EQ(score("psnr", black, white), 0.0);
  EXPECT_DOUBLE_EQ(score("bias", black, white), -1.0);
  EXPECT_NEAR(score("ssim", black, white), 1e-4 / (1.0 + 1e-4), 1e-9);  // C1/(1+C1)
  EXPECT_NEAR(score("flip", black, white), 0.967345, 1e-4);
}

TEST(Metrics, HighDynamicRangeHasNoPeak) {
  EXPECT_TRUE(std::isnan(score("psnr", hand_test, hand_reference, true)));
  const Image test = noise({32, 32}, 3, 5, 20.0F);
  const Image reference = noise({32, 32}, 3, 6, 20.0F);
  EXPECT_NE(score("flip", test, reference, true), score("flip", test, reference, false));
}

TEST(Metrics, NegativeValuesStayFinite) {
  const Image test = image({2, 1}, 1, {-1.0F, -0.5F});
  const Image reference = image({2, 1}, 1, {0.0F, 0.0F});
  for (const Metric& metric : metrics()) EXPECT_TRUE(std::isfinite(metric.score({test, reference}))) << metric.name;
  EXPECT_DOUBLE_EQ(score("rmse_tonemapped", test, reference), std::sqrt((0.25 + 1.0 / 9.0) / 2.0));
}

TEST(Metrics, NonFiniteValuesGiveNonFiniteScores) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Image test = noise({20, 20}, 3, 7);
    const Image reference = noise({20, 20}, 3, 8);
    test.texel(4, 5)[2] = bad;
    for (const bool high_dynamic_range : {false, true}) {
      for (const Metric& metric : metrics()) {
        const double value = metric.score({test, reference, high_dynamic_range});
        const bool clamps = std::isinf(bad) && metric.name == "flip" && !high_dynamic_range;  // a display shows white
        const bool counts = metric.unit == "px" && metric.name != "error_run_length";  // a number of pixels is finite
        if (!counts && !clamps) {
          EXPECT_FALSE(std::isfinite(value)) << metric.name;
        }
        if (metric.map) metric.map({test, reference, high_dynamic_range});
      }
    }
  }
}

TEST(Metrics, DifferentShapesAreRefusedByEveryRow) {
  const Image small({4, 3}, 3);
  const Image large({5, 3}, 3);
  const Image grey({4, 3}, 1);
  for (const Metric& metric : metrics()) {
    EXPECT_THROW(metric.score({small, large}), ConfigError) << metric.name;
    EXPECT_THROW(metric.score({small, grey}), ConfigError) << metric.name;
    EXPECT_THROW(metric.score({Image(), Image()}), ConfigError) << metric.name;
    if (metric.map) {
      EXPECT_THROW(metric.map({small, large}), ConfigError) << metric.name;
    }
  }
  EXPECT_THROW(worst_pixel(small, large), ConfigError);
  try {
    require_comparable(small, large);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("4x3"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("5x3"), std::string::npos);
  }
}

TEST(Metrics, TableHasUniqueNamesAndUnknownOnesAreListed) {
  std::set<std::string> names;
  for (const Metric& metric : metrics()) {
    EXPECT_TRUE(names.insert(metric.name).second) << metric.name;
    EXPECT_FALSE(metric.summary.empty()) << metric.name;
    EXPECT_EQ(&find_metric(metric.name), &metric);
  }
  EXPECT_EQ(metrics().front().name, "rmse");
  try {
    find_metric("rms");
    FAIL();
  } catch (const ConfigError& error) {
    for (const std::string& name : names) EXPECT_NE(std::string(error.what()).find(name), std::string::npos);
  }
}

TEST(Metrics, ScoresDoNotDependOnThreads) {
  const Image test = noise({219, 301}, 3, 9);
  const Image reference = noise({219, 301}, 3, 10);
  const int threads = omp_get_max_threads();
  for (const Metric& metric : metrics()) {
    omp_set_num_threads(1);
    const double one = metric.score({test, reference});
    omp_set_num_threads(3);
    EXPECT_EQ(metric.score({test, reference}), one) << metric.name;
  }
  omp_set_num_threads(threads);
}

TEST(WorstPixel, LargestDifferenceIsFound) {
  const WorstPixel worst = worst_pixel(hand_test, hand_reference);
  EXPECT_EQ(worst.x, 1U);
  EXPECT_EQ(worst.y, 0U);
  EXPECT_EQ(worst.channel, 2U);
  EXPECT_EQ(worst.difference, -2.0);
  EXPECT_EQ(worst_pixel(hand_test, hand_test).difference, 0.0);
  Image broken = hand_test;
  broken.texel(0, 0)[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(worst_pixel(broken, hand_reference).channel, 1U);
}

// SSIM by its definition: a direct sum over the 11x11 window of every pixel, borders mirrored.
double direct_similarity(const Image& test, const Image& reference) {
  const auto width = static_cast<int>(test.size.width);
  const auto height = static_cast<int>(test.size.height);
  const auto mirrored = [](int i, int n) { return i < 0 ? -i : i >= n ? 2 * n - 2 - i : i; };
  double norm = 0;
  for (int i = -5; i <= 5; ++i) norm += std::exp(-i * i / 4.5);
  double total = 0;
  for (std::uint32_t c = 0; c < test.channels; ++c) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        double mx = 0, my = 0, xx = 0, yy = 0, xy = 0;
        for (int dy = -5; dy <= 5; ++dy) {
          for (int dx = -5; dx <= 5; ++dx) {
            const double weight = std::exp(-(dx * dx + dy * dy) / 4.5) / (norm * norm);
            const auto u = static_cast<std::uint32_t>(mirrored(x + dx, width));
            const auto v = static_cast<std::uint32_t>(mirrored(y + dy, height));
            const double a = linear_to_srgb(test.texel(u, v)[c]);
            const double b = linear_to_srgb(reference.texel(u, v)[c]);
            mx += weight * a, my += weight * b, xx += weight * a * a, yy += weight * b * b, xy += weight * a * b;
          }
        }
        total += (2 * mx * my + 1e-4) * (2 * (xy - mx * my) + 9e-4) /
                 ((mx * mx + my * my + 1e-4) * (xx - mx * mx + yy - my * my + 9e-4));
      }
    }
  }
  return total / static_cast<double>(test.texels.size());
}

TEST(Similarity, MatchesADirectSumOverEveryWindow) {
  for (const std::uint32_t channels : {1U, 3U}) {
    const Image reference = noise({31, 24}, channels, 11);
    Image test = reference;
    Rng rng(12, stream_id("similarity"));
    for (float& texel : test.texels) texel += 0.2F * rng.uniform();
    EXPECT_NEAR(structural_similarity(test, reference).mean, direct_similarity(test, reference), 1e-10);
  }
}

TEST(Similarity, MatchesOpenCvQuality) {
  const std::string folder = std::string(ABN_TEST_DATA_DIR) + "/flip/";
  const Image test = load_image(folder + "apple200-test.png").image;
  const Image reference = load_image(folder + "apple200-ref.png").image;
  EXPECT_NEAR(structural_similarity(test, reference).mean, 0.8924715, 2e-7);  // QualitySSIM of OpenCV 4.6, mean of RGB
}

TEST(OiioCompare, CountsAndWorstPlaceMatchHandComputedValues) {
  const ThresholdComparison result = compare_thresholds(hand_test, hand_reference, 0.3F, 0.2F);
  EXPECT_EQ(result.warnings, 2U);
  EXPECT_EQ(result.failures, 1U);
  EXPECT_EQ(result.max_error, 2.0);
  EXPECT_EQ(result.max_x, 1U);
  EXPECT_EQ(result.max_y, 0U);
  EXPECT_EQ(result.max_channel, 2U);
  EXPECT_NEAR(result.rms_error, score("rmse", hand_test, hand_reference), 1e-6);
  EXPECT_NEAR(result.mean_error, score("mae", hand_test, hand_reference), 1e-6);
}

TEST(OiioCompare, CountsMatchIdiff) {
  const std::string folder = std::string(ABN_TEST_DATA_DIR) + "/flip/";
  const Image test = load_image(folder + "apple200-test.exr").image;
  const Image reference = load_image(folder + "apple200-ref.exr").image;
  EXPECT_EQ(compare_thresholds(test, reference).failures, 29535U);  // idiff apple200-test.exr apple200-ref.exr
  EXPECT_EQ(compare_perceptual(test, reference).failures, 1132U);   // idiff -p
  EXPECT_EQ(score("yee_failures", test, reference, true), 1132.0);
  EXPECT_EQ(score("differing_pixels", test, reference, true), 29535.0);
}

TEST(OiioCompare, GreyIsReplicatedForTheViewer) {
  const Image test = noise({24, 24}, 1, 13);
  const Image reference = noise({24, 24}, 1, 14);
  Image test3({24, 24}, 3);
  Image reference3({24, 24}, 3);
  for (std::size_t i = 0; i < test3.texels.size(); ++i) {
    test3.texels[i] = test.texels[i / 3];
    reference3.texels[i] = reference.texels[i / 3];
  }
  EXPECT_EQ(compare_perceptual(test, reference).failures, compare_perceptual(test3, reference3).failures);
  for (std::size_t i = 0; i < test3.texels.size(); i += 3) test3.texels[i] = 0.0F;  // now the colour differs
  EXPECT_GT(compare_perceptual(test3, reference3).failures, 0U);
}

}  // namespace
}  // namespace abn::harness
