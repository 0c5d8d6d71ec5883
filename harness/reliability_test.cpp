#include "harness/reliability.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include "harness/film.h"
#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::harness {
namespace {

constexpr Extent plane{200, 200};

/// Estimates from 1e-4 to 1e-1, and errors drawn from the normal distributions of `scale` times these deviations, added
/// to a truth of three unequal channels such that the luminance is off by just as much.
struct Case {
  Grid<float> estimate{plane};
  Image test{plane, 3};
  Image truth{plane, 3};
};

Case make_case(double scale) {
  Case made;
  for (std::size_t i = 0; i < plane.area(); ++i) {
    Rng rng(1, stream_id("reliability_test"), i);
    const double sigma = std::pow(10.0, -4 + 3 * double{rng.uniform()});
    const double radius = std::sqrt(-2 * std::log(1 - double{rng.uniform()}));
    const double normal = radius * std::cos(2 * std::numbers::pi * double{rng.uniform()});
    made.estimate[i] = static_cast<float>(sigma);
    const auto error = static_cast<float>(scale * sigma * normal);
    for (std::size_t c = 0; c < 3; ++c) {
      made.truth.texels[3 * i + c] = 0.5F + 0.1F * static_cast<float>(c);
      made.test.texels[3 * i + c] = made.truth.texels[3 * i + c] + error;
    }
  }
  return made;
}

TEST(Reliability, CalibratedErrorsLieOnTheDiagonal) {
  const Case made = make_case(1);
  const Reliability curve = reliability(made.estimate, made.test, made.truth);
  ASSERT_EQ(curve.bins.size(), 20U);
  std::size_t pixels = 0;
  double last = 0;
  std::size_t covered = 0;
  for (const ReliabilityBin& bin : curve.bins) {
    pixels += bin.pixels;
    EXPECT_EQ(bin.pixels, 2000U);
    EXPECT_GT(bin.estimated, last);
    last = bin.estimated;
    // 2000 squared normal numbers: their mean is off by sqrt(2/2000) = 3.2 %, its root by 1.6 %.
    EXPECT_NEAR(bin.actual / bin.estimated, 1, 0.07);
    covered += bin.low <= bin.estimated && bin.estimated <= bin.high ? 1U : 0U;
  }
  EXPECT_EQ(pixels, plane.area());
  EXPECT_GE(covered, 16U);  // 19 expected; 15 or fewer has a probability of 3e-4
  EXPECT_NEAR(curve.rmse_ratio(), 1, 0.03);
  EXPECT_LT(curve.worst_bin_factor(), 1.07);
  EXPECT_LT(curve.log2_deviation(), 0.05);
}

TEST(Reliability, AnEstimateTwiceTooSmallIsAFactorOfTwo) {
  const Case made = make_case(2);
  const Reliability curve = reliability(made.estimate, made.test, made.truth);
  for (const ReliabilityBin& bin : curve.bins) EXPECT_NEAR(bin.actual / bin.estimated, 2, 0.14);
  EXPECT_NEAR(curve.rmse_ratio(), 0.5, 0.015);
  EXPECT_NEAR(curve.worst_bin_factor(), 2, 0.14);
  EXPECT_NEAR(curve.log2_deviation(), 1, 0.05);
  const Case large = make_case(0.5);
  const Reliability other = reliability(large.estimate, large.test, large.truth);
  EXPECT_NEAR(other.rmse_ratio(), 2, 0.06);
  EXPECT_NEAR(other.worst_bin_factor(), 2, 0.14);
}

TEST(Reliability, ABinTheEstimateMissesIsTheWorst) {
  Case made = make_case(1);
  // The largest tenth of the errors is said to be small.
  for (float& sigma : made.estimate.cells()) sigma = sigma > 0.05F ? sigma / 1000 : sigma;
  const Reliability curve = reliability(made.estimate, made.test, made.truth);
  EXPECT_GT(curve.worst_bin_factor(), 100);
  EXPECT_LT(curve.rmse_ratio(), 0.7);
}

TEST(Reliability, BinsWithoutErrorsDoNotMatter) {
  Case made = make_case(1);
  for (std::size_t i = 0; i < plane.area() / 2; ++i) {
    made.estimate[i] = 0;
    for (std::size_t c = 0; c < 3; ++c) made.test.texels[3 * i + c] = made.truth.texels[3 * i + c] + 1e-7F;
  }
  const Reliability curve = reliability(made.estimate, made.test, made.truth);
  EXPECT_EQ(curve.bins.front().estimated, 0);
  EXPECT_GT(curve.bins.front().actual, 0);
  EXPECT_LT(curve.worst_bin_factor(), 1.1);
  EXPECT_TRUE(std::isfinite(curve.log2_deviation()));
}

TEST(Reliability, AnErrorNobodyEstimatedIsInfinitelyFarOff) {
  const Case made = make_case(1);
  const Reliability curve = reliability(Grid<float>(plane), made.test, made.truth);
  EXPECT_EQ(curve.rmse_ratio(), 0);
  EXPECT_EQ(curve.worst_bin_factor(), std::numeric_limits<double>::infinity());
}

TEST(Reliability, NoErrorAtAllIsNoFault) {
  const Image image({5, 5}, 1);
  const Reliability curve = reliability(Grid<float>({5, 5}), image, image);
  EXPECT_EQ(curve.bins.size(), 20U);
  EXPECT_TRUE(std::isnan(curve.rmse_ratio()));
  EXPECT_EQ(curve.worst_bin_factor(), 1);
  EXPECT_EQ(curve.log2_deviation(), 0);
  EXPECT_GT(draw_reliability(curve, "no error").rgb.size(), 0U);
}

TEST(Reliability, ValuesThatAreNotFiniteAreLeftOut) {
  Case made = make_case(1);
  made.estimate[0] = std::numeric_limits<float>::quiet_NaN();
  made.test.texels[3] = std::numeric_limits<float>::infinity();
  const Reliability curve = reliability(made.estimate, made.test, made.truth);
  std::size_t pixels = 0;
  for (const ReliabilityBin& bin : curve.bins) pixels += bin.pixels;
  EXPECT_EQ(pixels, plane.area() - 2);
  EXPECT_NEAR(curve.rmse_ratio(), 1, 0.03);
}

TEST(Reliability, FewPixelsGiveFewBins) {
  const Image image({3, 1}, 1);
  EXPECT_EQ(reliability(Grid<float>({3, 1}), image, image).bins.size(), 3U);
}

TEST(Reliability, OtherSizesAreRefused) {
  const Image image({3, 1}, 1);
  EXPECT_THROW(reliability(Grid<float>({1, 3}), image, image), ConfigError);
  EXPECT_THROW(reliability(Grid<float>({3, 1}), image, Image({3, 1}, 3)), ConfigError);
}

TEST(Reliability, CsvHoldsTheBins) {
  const Case made = make_case(1);
  const Reliability curve = reliability(made.estimate, made.test, made.truth, 7);
  std::istringstream csv(reliability_csv(curve));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "pixels,estimated,true,true_low,true_high");
  for (const ReliabilityBin& bin : curve.bins) {
    ASSERT_TRUE(std::getline(csv, line));
    std::istringstream cells(line);
    std::vector<double> numbers;
    for (std::string cell; std::getline(cells, cell, ',');) numbers.push_back(std::stod(cell));
    ASSERT_EQ(numbers.size(), 5U);
    EXPECT_EQ(numbers[0], static_cast<double>(bin.pixels));
    EXPECT_NEAR(numbers[1], bin.estimated, 1e-8 * bin.estimated);
    EXPECT_NEAR(numbers[2], bin.actual, 1e-8 * bin.actual);
    EXPECT_LE(numbers[3], numbers[2]);
    EXPECT_GE(numbers[4], numbers[2]);
  }
  EXPECT_FALSE(std::getline(csv, line));
}

TEST(Reliability, ARowWithoutEstimatesIsKnownBeforeTheRun) {
  EXPECT_FALSE(estimates_errors({.name = "none", .summary = "", .develop = [](const Film& film) {
                                   Developed developed = film.develop();
                                   developed.standard_error = {};
                                   return developed;
                                 }}));
  EXPECT_TRUE(estimates_errors({.name = "some", .summary = "", .develop = [](const Film& film) {
                                  Developed developed = film.develop();
                                  developed.standard_error = Grid<float>(film.sums().size());
                                  return developed;
                                }}));
}

}  // namespace
}  // namespace abn::harness
