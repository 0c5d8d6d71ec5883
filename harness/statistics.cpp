#include "harness/statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

#include "sampling/rng.h"

namespace abn::harness {
namespace {

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

// Where an increasing function of x in [low, high] reaches `level`: bisection down to neighbouring doubles.
template <class Function>
double solve_increasing(Function function, double low, double high, double level) {
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;
    (function(middle) < level ? low : high) = middle;
  }
}

// Regularised incomplete beta function I_x(a,b): the continued fraction of DiDonato and Morris 1992, evaluated by
// Lentz's method; it converges fast for x < (a+1)/(a+b+2), the other side follows from the symmetry.
double incomplete_beta(double a, double b, double x) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  if (x > (a + 1) / (a + b + 2)) return 1 - incomplete_beta(b, a, 1 - x);
  const double front =
      std::exp(a * std::log(x) + b * std::log1p(-x) + std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b)) / a;
  constexpr double tiny = 1e-300;
  const auto away_from_zero = [](double value) { return std::abs(value) < tiny ? tiny : value; };
  double c = 1;
  double d = 1 / away_from_zero(1 - (a + b) * x / (a + 1));
  double fraction = d;
  for (int m = 1; m < 10000; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / away_from_zero(1 + even * d);
    c = away_from_zero(1 + even / c);
    fraction *= c * d;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / away_from_zero(1 + odd * d);
    c = away_from_zero(1 + odd / c);
    fraction *= c * d;
    if (std::abs(c * d - 1) < 1e-15) break;
  }
  return front * fraction;
}

double student_cdf(double t, double degrees) {
  const double tail = 0.5 * incomplete_beta(0.5 * degrees, 0.5, degrees / (degrees + t * t));
  return t > 0 ? 1 - tail : tail;
}

// Quantile of an ascending sample, interpolated linearly between its values (Hyndman and Fan 1996, type 7).
double quantile_of_sorted(std::span<const double> sorted, double probability) {
  const double position = std::clamp(probability, 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], position - static_cast<double>(below));
}

// Acceleration of BCa from the jackknife: a sixth of the skewness of the leave-one-out means.
double jackknife_acceleration(std::span<const double> values) {
  const double mean = mean_of(values);
  double squares = 0;
  double cubes = 0;
  for (double value : values) {  // leave-one-out means differ from theirs by (mean - value)/(n-1), up to a sign
    squares += (value - mean) * (value - mean);
    cubes += (value - mean) * (value - mean) * (value - mean);
  }
  return squares > 0 ? cubes / (6 * std::pow(squares, 1.5)) : 0.0;
}

// Twice the mid-ranks of the absolute differences, ascending by absolute value, with the signs of the differences.
struct SignedRanks {
  std::vector<std::size_t> doubled;  // [n] twice the rank, so that ties stay whole numbers
  std::vector<bool> positive;        // [n]
  double tie_term = 0;               // sum of t^3 - t over groups of t ties
};

SignedRanks signed_ranks(std::span<const double> differences) {
  std::vector<double> kept;
  for (double value : differences) {
    if (value != 0) kept.push_back(value);
  }
  std::sort(kept.begin(), kept.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  SignedRanks ranks;
  for (std::size_t first = 0; first < kept.size();) {
    std::size_t end = first;
    while (end < kept.size() && std::abs(kept[end]) == std::abs(kept[first])) ++end;
    const auto ties = static_cast<double>(end - first);
    ranks.tie_term += ties * ties * ties - ties;
    for (std::size_t i = first; i < end; ++i) {
      ranks.doubled.push_back(first + 1 + end);  // ranks first+1 ... end
      ranks.positive.push_back(kept[i] > 0);
    }
    first = end;
  }
  return ranks;
}

// Exact two-sided p: every assignment of signs is equally likely, their rank sums are counted by convolution.
double exact_p(const SignedRanks& ranks, std::size_t observed) {
  const std::size_t total = std::accumulate(ranks.doubled.begin(), ranks.doubled.end(), std::size_t{0});
  std::vector<double> probability(total + 1);
  probability[0] = 1;
  for (std::size_t rank : ranks.doubled) {
    for (std::size_t sum = total + 1; sum-- > 0;) {
      probability[sum] = 0.5 * (probability[sum] + (sum >= rank ? probability[sum - rank] : 0.0));
    }
  }
  const auto at = probability.begin() + static_cast<std::ptrdiff_t>(observed);
  const double below = std::accumulate(probability.begin(), at + 1, 0.0);
  const double above = std::accumulate(at, probability.end(), 0.0);
  return std::min(1.0, 2 * std::min(below, above));
}

}  // namespace

double normal_quantile(double probability) {
  assert(probability > 0 && probability < 1);
  // The lower half only: there the distribution function keeps its relative precision.
  if (probability > 0.5) return -normal_quantile(1 - probability);
  return solve_increasing(normal_cdf, -40.0, 0.0, probability);
}

double student_quantile(double probability, double degrees) {
  assert(probability > 0 && probability < 1 && degrees > 0);
  if (probability > 0.5) return -student_quantile(1 - probability, degrees);
  double low = -1;
  while (student_cdf(low, degrees) > probability) low *= 2;
  return solve_increasing([&](double t) { return student_cdf(t, degrees); }, low, 0.0, probability);
}

Summary summarize(std::span<const double> values, double confidence) {
  Summary summary;
  summary.count = values.size();
  if (values.empty()) return summary;
  summary.mean = mean_of(values);
  if (values.size() < 2) return summary;
  double squares = 0;
  for (double value : values) squares += (value - summary.mean) * (value - summary.mean);
  const auto count = static_cast<double>(values.size());
  summary.standard_deviation = std::sqrt(squares / (count - 1));
  const double half =
      student_quantile(0.5 + 0.5 * confidence, count - 1) * summary.standard_deviation / std::sqrt(count);
  summary.interval = {summary.mean - half, summary.mean + half};
  return summary;
}

Interval bootstrap_mean_interval(std::span<const double> values, double confidence, std::uint64_t seed,
                                 std::size_t resamples) {
  if (values.size() < 2) return {};
  std::vector<double> means(resamples);
  for (std::size_t resample = 0; resample < resamples; ++resample) {
    Rng rng(seed, stream_id("bootstrap"), resample);
    double sum = 0;
    for (std::size_t i = 0; i < values.size(); ++i) sum += values[rng.below(static_cast<std::uint32_t>(values.size()))];
    means[resample] = sum / static_cast<double>(values.size());
  }
  std::sort(means.begin(), means.end());
  const double tail = 0.5 * (1 - confidence);
  if (values.size() >= 30) return {quantile_of_sorted(means, tail), quantile_of_sorted(means, 1 - tail)};

  // BCa, Efron 1987: shift the percentiles by the bias and the skewness of the estimate.
  const double mean = mean_of(values);
  const auto [first, last] = std::equal_range(means.begin(), means.end(), mean);
  const auto count = static_cast<double>(resamples);
  const double below = static_cast<double>(first - means.begin()) + 0.5 * static_cast<double>(last - first);
  const double bias = normal_quantile(std::clamp(below / count, 0.5 / count, 1 - 0.5 / count));
  const double acceleration = jackknife_acceleration(values);
  const auto corrected = [&](double probability) {
    const double z = bias + normal_quantile(probability);
    return quantile_of_sorted(means, normal_cdf(bias + z / (1 - acceleration * z)));
  };
  return {corrected(tail), corrected(1 - tail)};
}

double wilcoxon_signed_rank(std::span<const double> differences) {
  const SignedRanks ranks = signed_ranks(differences);
  if (ranks.doubled.empty()) return 1;
  std::size_t doubled_sum = 0;
  for (std::size_t i = 0; i < ranks.doubled.size(); ++i) doubled_sum += ranks.positive[i] ? ranks.doubled[i] : 0;
  if (ranks.doubled.size() <= 25) return exact_p(ranks, doubled_sum);
  const auto n = static_cast<double>(ranks.doubled.size());
  const double expected = n * (n + 1) / 4;
  const double variance = n * (n + 1) * (2 * n + 1) / 24 - ranks.tie_term / 48;
  const double distance = std::abs(0.5 * static_cast<double>(doubled_sum) - expected);
  return std::min(1.0, 2 * normal_cdf(-std::max(0.0, distance - 0.5) / std::sqrt(variance)));
}

PairedComparison compare_paired(std::span<const double> a, std::span<const double> b, double confidence,
                                std::uint64_t seed) {
  assert(a.size() == b.size());
  std::vector<double> log_ratios;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool both_zero = a[i] == 0 && b[i] == 0;
    const bool both_positive = a[i] > 0 && b[i] > 0 && std::isfinite(a[i]) && std::isfinite(b[i]);
    if (both_zero) log_ratios.push_back(0.0);
    if (both_positive) log_ratios.push_back(std::log(a[i] / b[i]));
  }
  PairedComparison comparison;
  comparison.count = log_ratios.size();
  comparison.dropped = a.size() - log_ratios.size();
  if (log_ratios.empty()) return comparison;
  const Summary summary = summarize(log_ratios, confidence);
  const Interval interval = bootstrap_mean_interval(log_ratios, confidence, seed);
  comparison.ratio = std::exp(summary.mean);
  comparison.log_ratio_sd = summary.standard_deviation;
  comparison.interval = {std::exp(interval.low), std::exp(interval.high)};
  comparison.p_value = wilcoxon_signed_rank(log_ratios);
  return comparison;
}

std::vector<double> holm_adjusted(std::span<const double> p_values) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return p_values[i] < p_values[j]; });
  std::vector<double> adjusted(p_values.size());
  double largest = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    largest = std::max(largest, static_cast<double>(order.size() - i) * p_values[order[i]]);
    adjusted[order[i]] = std::min(1.0, largest);
  }
  return adjusted;
}

}  // namespace abn::harness
