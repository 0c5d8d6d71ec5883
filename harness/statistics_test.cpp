#include "harness/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "sampling/rng.h"

namespace abn::harness {
namespace {

TEST(Quantiles, MatchPublishedTables) {
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-12);
  EXPECT_NEAR(normal_quantile(0.5), 0.0, 1e-12);
  EXPECT_NEAR(normal_quantile(1e-6), -4.753424308822899, 1e-9);
  // Student's t, 97.5 %: tan(pi .475) for one degree, closed form for two, tables for the rest.
  EXPECT_NEAR(student_quantile(0.975, 1), std::tan(3.14159265358979323846 * 0.475), 1e-9);
  EXPECT_NEAR(student_quantile(0.975, 2), 0.95 * std::sqrt(2.0 / (1.0 - 0.95 * 0.95)), 1e-10);
  EXPECT_NEAR(student_quantile(0.975, 9), 2.2621571627, 1e-8);
  EXPECT_NEAR(student_quantile(0.975, 19), 2.0930240544, 1e-8);
  EXPECT_NEAR(student_quantile(0.005, 29), -2.7563859037, 1e-8);
  EXPECT_NEAR(student_quantile(0.975, 1e6), normal_quantile(0.975), 1e-5);
}

TEST(Summary, MatchesHandComputedValues) {
  const double values[] = {1, 2, 3, 4};
  const Summary summary = summarize(values);
  EXPECT_DOUBLE_EQ(summary.mean, 2.5);
  EXPECT_DOUBLE_EQ(summary.standard_deviation, std::sqrt(5.0 / 3.0));
  const double half = 3.182446305284263 * std::sqrt(5.0 / 12.0);  // t of 3 degrees
  EXPECT_NEAR(summary.interval.low, 2.5 - half, 1e-9);
  EXPECT_NEAR(summary.interval.high, 2.5 + half, 1e-9);
}

TEST(Summary, TooFewValuesAreUnknownNotZero) {
  const double one[] = {3};
  EXPECT_EQ(summarize(one).mean, 3.0);
  EXPECT_TRUE(std::isnan(summarize(one).standard_deviation));
  EXPECT_TRUE(std::isnan(summarize(one).interval.low));
  EXPECT_TRUE(std::isnan(summarize({}).mean));
  EXPECT_TRUE(std::isnan(bootstrap_mean_interval(one).low));
}

TEST(Wilcoxon, MatchesPublishedExamples) {
  // Cushny's depression scores, Hollander and Wolfe 1973, p. 29: one-sided .01953 without ties.
  const double first[] = {1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30};
  const double second[] = {0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29};
  std::vector<double> depression;
  for (int i = 0; i < 9; ++i) depression.push_back(first[i] - second[i]);
  EXPECT_DOUBLE_EQ(wilcoxon_signed_rank(depression), 2 * 10.0 / 512.0);
  // Darwin's maize, Cramer's example, n = 15, W- = 24.
  const double maize[] = {6, 8, 14, 16, 23, 24, 28, 29, 41, -48, 49, 56, 60, -67, 75};
  EXPECT_DOUBLE_EQ(wilcoxon_signed_rank(maize), 0.041259765625);
}

TEST(Wilcoxon, ZerosAreLeftOutAndSignsAreSymmetric) {
  const double values[] = {0, 1, 2, 3, 0};
  const double mirrored[] = {-1, -2, -3};
  EXPECT_DOUBLE_EQ(wilcoxon_signed_rank(values), 0.25);
  EXPECT_DOUBLE_EQ(wilcoxon_signed_rank(mirrored), 0.25);
  const double zeros[] = {0, 0};
  EXPECT_EQ(wilcoxon_signed_rank(zeros), 1.0);
  EXPECT_EQ(wilcoxon_signed_rank({}), 1.0);
}

// The test by its definition: mid-ranks by counting, then all 2^n signs.
double enumerated_p(const std::vector<double>& differences) {
  const std::size_t n = differences.size();
  std::vector<double> ranks(n);
  double observed = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const double a = std::abs(differences[i]);
      const double b = std::abs(differences[j]);
      ranks[i] += b < a ? 1.0 : b == a ? 0.5 : 0.0;
    }
    ranks[i] += 0.5;
    if (differences[i] > 0) observed += ranks[i];
  }
  double below = 0;
  double above = 0;
  for (std::size_t signs = 0; signs < (std::size_t{1} << n); ++signs) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += (signs >> i & 1) != 0 ? ranks[i] : 0.0;
    below += sum <= observed ? 1 : 0;
    above += sum >= observed ? 1 : 0;
  }
  return std::min(1.0, 2 * std::min(below, above) / static_cast<double>(std::size_t{1} << n));
}

TEST(Wilcoxon, ExactValueEqualsEnumerationWithTies) {
  Rng rng(1, stream_id("wilcoxon"));
  for (std::size_t n = 1; n <= 12; ++n) {
    std::vector<double> differences(n);
    for (double& value : differences) value = (1.0 + rng.below(5)) * (rng.below(3) == 0 ? -1.0 : 1.0);  // many ties
    EXPECT_NEAR(wilcoxon_signed_rank(differences), enumerated_p(differences), 1e-14) << n;
  }
}

TEST(Wilcoxon, NormalApproximationContinuesTheExactValue) {
  // At the end of the exact range the approximation must be close.
  std::vector<double> differences(25);
  for (std::size_t i = 0; i < 25; ++i) differences[i] = (i % 3 == 0 ? -1.0 : 1.0) * static_cast<double>(i + 1);
  const double exact = wilcoxon_signed_rank(differences);
  // n = 25, W+ = 208 (sum 325 less the ranks 1, 4, ..., 25 = 117): z = (208-162.5-.5)/sqrt(1381.25)
  const double approximate = std::erfc((208 - 162.5 - 0.5) / std::sqrt(1381.25) / std::sqrt(2.0));
  EXPECT_NEAR(exact, 0.23036134243011475, 1e-12);  // counted over all 2^25 signs
  EXPECT_NEAR(exact, approximate, 5e-3);
  std::vector<double> ties(30, 1.0);
  for (std::size_t i = 0; i < 8; ++i) ties[i] = -1.0;
  // All ranks 15.5: W+ = 341, mean 232.5, variance 30*31*61/24 - (27000-30)/48 = 2363.75 - 561.875.
  EXPECT_NEAR(wilcoxon_signed_rank(ties), std::erfc((341 - 232.5 - 0.5) / std::sqrt(1801.875) / std::sqrt(2.0)), 1e-12);
}

TEST(Bootstrap, IntervalAgreesWithTheTheoryOfNormalValues) {
  // 40 standard normal quantiles: mean 0, so the percentile interval is about +-1.96 s/sqrt(n).
  std::vector<double> values;
  for (int i = 0; i < 40; ++i) values.push_back(normal_quantile((i + 0.5) / 40));
  const Summary summary = summarize(values);
  const double half = 1.96 * summary.standard_deviation * std::sqrt(39.0 / 40.0) / std::sqrt(40.0);
  const Interval interval = bootstrap_mean_interval(values);
  EXPECT_NEAR(interval.low, -half, 0.08 * half);
  EXPECT_NEAR(interval.high, half, 0.08 * half);
}

TEST(Bootstrap, SmallSkewedSamplesAreCorrectedTowardsTheTail) {
  std::vector<double> values(19, 0.0);
  values.push_back(1.0);  // one outlier: the mean's error is skewed to the right
  std::vector<double> mirrored;
  for (double value : values) mirrored.push_back(-value);
  const Interval interval = bootstrap_mean_interval(values);
  EXPECT_GT(interval.high - 0.05, 0.05 - interval.low);
  const Interval negative = bootstrap_mean_interval(mirrored);
  EXPECT_NEAR(negative.low, -interval.high, 1e-12);  // same draws, mirrored
  EXPECT_NEAR(negative.high, -interval.low, 1e-12);
}

TEST(Bootstrap, IntervalCoversTheMeanAsOftenAsItSays) {
  int covered = 0;
  constexpr int repetitions = 400;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    Rng rng(7, stream_id("coverage"), static_cast<std::uint64_t>(repetition));
    std::vector<double> values(20);
    for (double& value : values) value = normal_quantile(std::max(rng.uniform(), 1e-7F));
    const Interval interval = bootstrap_mean_interval(values, 0.95, static_cast<std::uint64_t>(repetition), 500);
    covered += interval.low <= 0 && 0 <= interval.high ? 1 : 0;
  }
  // The bootstrap of 20 values is known to cover about 93 %; standard error of the count 1.2 %.
  EXPECT_GE(covered, repetitions * 89 / 100);
  EXPECT_LE(covered, repetitions * 97 / 100);
}

TEST(PairedComparison, ConstantRatioIsFoundExactly) {
  std::vector<double> a;
  std::vector<double> b;
  for (int i = 0; i < 20; ++i) {
    b.push_back(0.02 + 0.001 * i);
    a.push_back(0.8 * b.back());
  }
  const PairedComparison comparison = compare_paired(a, b);
  EXPECT_EQ(comparison.count, 20U);
  EXPECT_NEAR(comparison.ratio, 0.8, 1e-12);
  EXPECT_NEAR(comparison.interval.low, 0.8, 1e-12);
  EXPECT_NEAR(comparison.interval.high, 0.8, 1e-12);
  EXPECT_DOUBLE_EQ(comparison.p_value, 2.0 / (1 << 20));
  EXPECT_TRUE(comparison.interval_excludes_one());
}

TEST(PairedComparison, NoiseIsCalledAGainAsOftenAsTheLevelAllows) {
  int false_gains = 0;
  int small_p_values = 0;
  constexpr int repetitions = 300;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    Rng rng(5, stream_id("noise"), static_cast<std::uint64_t>(repetition));
    std::vector<double> a(20);
    std::vector<double> b(20);
    for (double& value : a) value = 1.0 + 0.01 * rng.uniform();
    for (double& value : b) value = 1.0 + 0.01 * rng.uniform();
    const PairedComparison comparison = compare_paired(a, b);
    false_gains += comparison.interval_excludes_one() ? 1 : 0;
    small_p_values += comparison.p_value < 0.05 ? 1 : 0;
  }
  // 5 % expected (bootstrap of 20 values: about 7 %), standard error 1.3 %.
  EXPECT_LE(false_gains, repetitions * 11 / 100);
  EXPECT_GE(false_gains, repetitions * 2 / 100);
  EXPECT_LE(small_p_values, repetitions * 9 / 100);
  EXPECT_GE(small_p_values, repetitions * 1 / 100);
}

TEST(PairedComparison, ExchangingTheSidesInvertsTheRatio) {
  const double a[] = {1.0, 1.2, 0.9, 1.1, 1.05};
  const double b[] = {1.1, 1.1, 1.0, 1.3, 1.01};
  const PairedComparison comparison = compare_paired(a, b);
  const PairedComparison inverse = compare_paired(b, a);
  EXPECT_NEAR(inverse.ratio, 1.0 / comparison.ratio, 1e-12);
  EXPECT_NEAR(inverse.interval.low, 1.0 / comparison.interval.high, 1e-9);
  EXPECT_DOUBLE_EQ(inverse.p_value, comparison.p_value);
}

TEST(PairedComparison, ZerosAndNonFiniteValuesAreCounted) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double a[] = {0, 0, 1, nan, 2};
  const double b[] = {0, 1, 1, 1, 2};
  const PairedComparison comparison = compare_paired(a, b);
  EXPECT_EQ(comparison.count, 3U);
  EXPECT_EQ(comparison.dropped, 2U);
  EXPECT_EQ(comparison.ratio, 1.0);
  EXPECT_EQ(comparison.p_value, 1.0);
  EXPECT_TRUE(std::isnan(compare_paired({}, {}).ratio));
}

TEST(Holm, MatchesHandComputedValues) {
  const double p[] = {0.01, 0.04, 0.03, 0.005};
  const std::vector<double> adjusted = holm_adjusted(p);
  EXPECT_DOUBLE_EQ(adjusted[3], 0.02);
  EXPECT_DOUBLE_EQ(adjusted[0], 0.03);
  EXPECT_DOUBLE_EQ(adjusted[2], 0.06);
  EXPECT_DOUBLE_EQ(adjusted[1], 0.06);  // never below a smaller p's
}

}  // namespace
}  // namespace abn::harness
