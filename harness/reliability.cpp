#include "harness/reliability.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/chart.h"
#include "harness/film.h"
#include "harness/metrics.h"
#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::harness {
namespace {

double square(double value) { return value * value; }

/// One pixel's errors.
struct Errors {
  double estimated = 0;
  double actual = 0;
};

std::vector<Errors> sorted_errors(const Grid<float>& standard_error, const Image& test, const Image& truth) {
  std::vector<Errors> errors;
  errors.reserve(standard_error.size().area());
  for (std::size_t i = 0; i < standard_error.size().area(); ++i) {
    const std::size_t first = i * test.channels;
    const Errors pixel{double{standard_error[i]}, double{luminance(&test.texels[first], test.channels)} -
                                                      double{luminance(&truth.texels[first], truth.channels)}};
    if (std::isfinite(pixel.estimated) && std::isfinite(pixel.actual)) errors.push_back(pixel);
  }
  std::stable_sort(errors.begin(), errors.end(),
                   [](const Errors& a, const Errors& b) { return a.estimated < b.estimated; });
  return errors;
}

ReliabilityBin bin_of(const Errors* first, std::size_t count) {
  double estimated = 0;
  double actual = 0;
  double fourth = 0;
  for (const Errors* pixel = first; pixel != first + count; ++pixel) {
    estimated += square(pixel->estimated);
    actual += square(pixel->actual);
    fourth += square(square(pixel->actual));
  }
  const auto n = static_cast<double>(count);
  const double mean = actual / n;
  // Of the mean square error; the quantile 1.96 because a bin has hundreds of pixels.
  const double half = 1.96 * std::sqrt(std::max(0.0, fourth / n - square(mean)) / n);
  return {.pixels = count,
          .estimated = std::sqrt(estimated / n),
          .actual = std::sqrt(mean),
          .low = std::sqrt(std::max(0.0, mean - half)),
          .high = std::sqrt(mean + half)};
}

/// A bin's shares of all squared errors.
struct Share {
  double estimated = 0;
  double actual = 0;
  bool matters() const { return std::max(estimated, actual) >= 0.01; }
};

std::vector<Share> shares_of(const std::vector<ReliabilityBin>& bins) {
  Share sum;
  for (const auto& bin : bins) {
    sum.estimated += static_cast<double>(bin.pixels) * square(bin.estimated);
    sum.actual += static_cast<double>(bin.pixels) * square(bin.actual);
  }
  std::vector<Share> shares;
  for (const auto& bin : bins) {
    const auto share = [&](double error, double of) {
      return of > 0 ? static_cast<double>(bin.pixels) * square(error) / of : 0.0;
    };
    shares.push_back({share(bin.estimated, sum.estimated), share(bin.actual, sum.actual)});
  }
  return shares;
}

}  // namespace

double Reliability::rmse_ratio() const {
  return true_rmse > 0 ? estimated_rmse / true_rmse : std::numeric_limits<double>::quiet_NaN();
}

double Reliability::worst_bin_factor() const {
  double worst = 1;
  const std::vector<Share> shares = shares_of(bins);
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (!shares[i].matters()) continue;
    const auto [smaller, larger] = std::minmax(bins[i].estimated, bins[i].actual);
    worst = std::max(worst, smaller > 0 ? larger / smaller : std::numeric_limits<double>::infinity());
  }
  return worst;
}

double Reliability::log2_deviation() const {
  double sum = 0;
  double weights = 0;
  const std::vector<Share> shares = shares_of(bins);
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (!shares[i].matters()) continue;
    const double weight = 0.5 * (shares[i].estimated + shares[i].actual);
    sum += weight * square(std::log2(bins[i].actual / bins[i].estimated));
    weights += weight;
  }
  return weights > 0 ? std::sqrt(sum / weights) : 0.0;
}

Reliability reliability(const Grid<float>& standard_error, const Image& test, const Image& truth, std::size_t bins) {
  require_comparable(test, truth);
  if (standard_error.size() != test.size) {
    throw ConfigError(fmt::format("the estimated errors are {}x{}, the image is {}x{}; they must be equal",
                                  standard_error.size().width, standard_error.size().height, test.size.width,
                                  test.size.height));
  }
  const std::vector<Errors> errors = sorted_errors(standard_error, test, truth);
  Reliability curve;
  if (errors.empty()) return curve;
  bins = std::clamp<std::size_t>(bins, 1, errors.size());
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const std::size_t first = bin * errors.size() / bins;
    curve.bins.push_back(bin_of(&errors[first], (bin + 1) * errors.size() / bins - first));
  }
  const ReliabilityBin all = bin_of(errors.data(), errors.size());
  curve.estimated_rmse = all.estimated;
  curve.true_rmse = all.actual;
  return curve;
}

Picture draw_reliability(const Reliability& curve, const std::string& title) {
  Series bins{.label = "bins of equal count, 95 % interval", .x = {}, .y = {}, .colour = series_colour(1)};
  double least = std::numeric_limits<double>::infinity();
  double largest = 0;
  std::size_t left_out = 0;
  for (const ReliabilityBin& bin : curve.bins) {
    if (!(bin.estimated > 0 && bin.actual > 0)) {
      ++left_out;
      continue;
    }
    bins.x.push_back(bin.estimated);
    bins.y.push_back(bin.actual);
    bins.low.push_back(bin.low);
    bins.high.push_back(bin.high);
    least = std::min({least, bin.estimated, bin.actual});
    largest = std::max({largest, bin.estimated, bin.actual, bin.high});
  }
  if (bins.x.empty()) least = 0.001, largest = 1;  // an empty chart is still a chart
  // Both axes alike, so that the diagonal is one; six decades show all that can be seen of a picture.
  least = std::max(least / 1.5, largest * 1e-6);
  largest *= 1.5;
  LineChart chart;
  chart.title = title;
  if (left_out > 0) chart.title += fmt::format(" (not shown: {} of {} bins, error 0)", left_out, curve.bins.size());
  chart.x = {.label = "estimated error of luminance, root mean square of a bin",
             .low = least,
             .high = largest,
             .logarithmic = true};
  chart.y = {.label = "true error of luminance, root mean square of a bin",
             .low = least,
             .high = largest,
             .logarithmic = true};
  const auto line = [&](double factor, const std::string& label, bool dashed) {
    return Series{.label = label,
                  .x = {least, largest},
                  .y = {factor * least, factor * largest},
                  .colour = {120, 120, 120},
                  .dashed = dashed};
  };
  chart.series = {line(1, "perfect", false), line(2, "factor 2", true), line(0.5, "", true), std::move(bins)};
  chart.width = 560;
  chart.height = 590;
  return draw_chart(chart);
}

std::string reliability_csv(const Reliability& curve) {
  std::string csv = "pixels,estimated,true,true_low,true_high\n";
  for (const ReliabilityBin& bin : curve.bins) {
    csv += fmt::format("{},{:.9g},{:.9g},{:.9g},{:.9g}\n", bin.pixels, bin.estimated, bin.actual, bin.low, bin.high);
  }
  return csv;
}

bool estimates_errors(const Reconstruction& reconstruction) {
  constexpr Extent kPlane{4, 4};
  Film film(kPlane, 1, true);
  std::vector<Vec2f> position;
  std::vector<float> value;
  for (std::uint64_t i = 0; i < 6 * kPlane.area(); ++i) {
    Rng rng(1, stream_id("estimates_errors"), i);
    const auto pixel = static_cast<std::uint32_t>(i % kPlane.area());
    const Vec2f inside = rng.uniform2();
    position.push_back(
        {static_cast<float>(pixel % kPlane.width) + inside.x, static_cast<float>(pixel / kPlane.width) + inside.y});
    value.push_back(rng.uniform());
  }
  film.add({.position = position}, value);
  return !reconstruction.develop(film).standard_error.cells().empty();
}

}  // namespace abn::harness
