// Statistics over seeds: one strategy's mean with its interval, and two strategies compared seed by seed.
//
// Numerical trouble is data: what cannot be known (an interval from one value) is NaN, never 0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace abn::harness {

/// A confidence interval; both ends NaN where it is unknown.
struct Interval {
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
};

/// One sample of values.
struct Summary {
  std::size_t count = 0;
  double mean = std::numeric_limits<double>::quiet_NaN();
  double standard_deviation = std::numeric_limits<double>::quiet_NaN();  // of the sample, divisor n-1; needs 2 values
  Interval interval;                                                     // of the mean, Student's t; needs 2 values
};

/// Mean and Student's t interval of the mean; confidence in (0,1).
Summary summarize(std::span<const double> values, double confidence = 0.95);

/// How `a` compares with `b` over common seeds, in ratios: .9 means a is 10 % smaller.
struct PairedComparison {
  std::size_t count = 0;    // pairs used
  std::size_t dropped = 0;  // pairs whose log-ratio is not finite (one of them 0, negative or not finite)
  double ratio = std::numeric_limits<double>::quiet_NaN();  // geometric mean of a/b
  double log_ratio_sd = std::numeric_limits<double>::quiet_NaN();
  Interval interval;                                          // of the ratio, bootstrap
  double p_value = std::numeric_limits<double>::quiet_NaN();  // Wilcoxon signed rank, two-sided
  bool interval_excludes_one() const { return interval.low > 1.0 || interval.high < 1.0; }
};

/// Compares paired results (same seed at the same index) through r = ln(a/b): geometric mean ratio, bootstrap interval
/// (2000 resamples; bias-corrected and accelerated for fewer than 30 pairs, percentiles otherwise) and the Wilcoxon
/// signed-rank p. A pair of two zeros has r = 0. Precondition: equal lengths. Method: literature in Efron 1987 (BCa)
/// and Wilcoxon 1945.
PairedComparison compare_paired(std::span<const double> a, std::span<const double> b, double confidence = 0.95,
                                std::uint64_t seed = 1);

/// Bootstrap interval of the mean of `values`; the same numbers for the same seed. Needs 2 values.
Interval bootstrap_mean_interval(std::span<const double> values, double confidence = 0.95, std::uint64_t seed = 1,
                                 std::size_t resamples = 2000);

/// Two-sided p of the Wilcoxon signed-rank test that `differences` are symmetric about 0. Zeros are left out, ties get
/// their mean rank. Exact (also with ties) up to 25 differences, above that the normal approximation with tie and
/// continuity correction. 1 when nothing is left to rank.
double wilcoxon_signed_rank(std::span<const double> differences);

/// p values of a family of comparisons, adjusted by Holm 1979, in the order given.
std::vector<double> holm_adjusted(std::span<const double> p_values);

/// Quantile of the standard normal distribution; probability in (0,1).
double normal_quantile(double probability);

/// Quantile of Student's t distribution; probability in (0,1), degrees > 0.
double student_quantile(double probability, double degrees);

}  // namespace abn::harness
