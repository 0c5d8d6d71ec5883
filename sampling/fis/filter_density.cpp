#include "sampling/fis/filter_density.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>

#include "sampling/error.h"

namespace abn {
namespace {

constexpr std::size_t kInverseSteps = 4096;
constexpr std::size_t kSteps = 2048;  // of the distributions; even, for Simpson's rule

/// Integral of the values at equal steps h, an even number of them, by Simpson's rule.
template <class Function>
double simpson(double from, double to, std::size_t steps, const Function& function) {
  const double h = (to - from) / static_cast<double>(steps);
  double sum = function(from) + function(to);
  for (std::size_t i = 1; i < steps; ++i) sum += (i % 2 == 1 ? 4 : 2) * function(from + h * static_cast<double>(i));
  return sum * h / 3;
}

std::shared_ptr<const PixelFilter> require_density(std::shared_ptr<const PixelFilter> filter,
                                                   std::string_view strategy) {
  if (!filter) return make_filter("box");
  if (!filter->non_negative()) {
    throw ConfigError(std::string(strategy) + ": filter '" + filter->words() +
                      "' has negative lobes, so it is no density to draw samples from; take box, triangle or gaussian, "
                      "or share the samples of another strategy under this filter");
  }
  return filter;
}

}  // namespace

LinearTable::LinearTable(double first, double last, std::vector<float> values)
    : first_(static_cast<float>(first)),
      steps_per_unit_(static_cast<float>(static_cast<double>(values.size() - 1) / (last - first))),
      steps_(static_cast<float>(values.size() - 1)),
      last_interval_(values.size() - 2),
      values_(std::move(values)) {
  assert(values_.size() >= 2 && last > first);
}

FilterDensity::FilterDensity(std::shared_ptr<const PixelFilter> filter, std::string_view strategy)
    : filter_(require_density(std::move(filter), strategy)), radius_(static_cast<float>(filter_->radius())) {
  if (disc()) {
    tabulate_disc();
  } else {
    tabulate_square();
  }
}

void FilterDensity::tabulate_square() {
  const double radius = filter_->radius();
  std::vector<float> inverse(kInverseSteps + 1);
  for (std::size_t i = 0; i <= kInverseSteps; ++i) {
    inverse[i] = static_cast<float>(filter_->inverse(static_cast<double>(i) / kInverseSteps));
  }
  inverse_ = LinearTable(0, 1, std::move(inverse));
  std::vector<float> marginal(kSteps + 1);
  for (std::size_t i = 0; i <= kSteps; ++i) {
    marginal[i] = static_cast<float>(filter_->integral(radius * (2 * static_cast<double>(i) / kSteps - 1)));
  }
  marginal_ = LinearTable(-radius, radius, std::move(marginal));

  // E x^2 = R^2 - 2 int x F(x) dx, by parts: F is continuous where a profile may jump.
  const double x_squared =
      radius * radius - 2 * simpson(-radius, radius, kSteps, [&](double x) { return x * filter_->integral(x); });
  second_moment_ = 2 * x_squared;

  // P(r <= R) as the mean over |x| of P(|y| <= sqrt(R^2 - x^2)), at values of |x| that share the mass equally.
  constexpr std::size_t kStrips = 256;
  std::vector<double> strip(kStrips);
  for (std::size_t i = 0; i < kStrips; ++i) {
    strip[i] = filter_->inverse(0.5 + (static_cast<double>(i) + 0.5) / (2 * kStrips));
  }
  const double corner = radius * std::numbers::sqrt2;
  std::vector<float> radial(kSteps / 2 + 1);
  for (std::size_t k = 0; k < radial.size(); ++k) {
    const double r = corner * static_cast<double>(k) / (kSteps / 2);
    double sum = 0;
    for (const double x : strip) {
      if (x >= r) break;
      sum += 2 * static_cast<double>(marginal_(static_cast<float>(std::sqrt(r * r - x * x)))) - 1;
    }
    radial[k] = static_cast<float>(sum / kStrips);
  }
  radial.back() = 1;
  radial_ = LinearTable(0, corner, std::move(radial));
}

void FilterDensity::tabulate_disc() {
  const double radius = filter_->radius();
  const auto density = [&](double x, double y) { return filter_->value(x, y); };
  // The share within r, by Simpson's rule on every step.
  std::vector<double> share(kSteps + 1);
  const double step = radius / kSteps;
  const auto ring = [&](double r) { return 2 * std::numbers::pi * r * density(std::min(r, radius), 0); };
  for (std::size_t i = 0; i < kSteps; ++i) {
    const double r = step * static_cast<double>(i);
    share[i + 1] = share[i] + step / 6 * (ring(r) + 4 * ring(r + step / 2) + ring(std::min(r + step, radius)));
  }
  const double total = share.back();
  for (double& s : share) s /= total;
  radial_ = LinearTable(0, radius, std::vector<float>(share.begin(), share.end()));
  second_moment_ = radius * radius;  // - int 2 r F(r) dr, by parts
  for (std::size_t i = 0; i < kSteps; ++i) {
    const double r = step * static_cast<double>(i);
    second_moment_ -= step * (r * share[i] + (r + step) * share[i + 1]);
  }

  std::vector<float> inverse(kInverseSteps + 1);  // r^2: linear in the share near the centre
  std::size_t at = 0;
  for (std::size_t k = 0; k <= kInverseSteps; ++k) {
    const double wanted = static_cast<double>(k) / kInverseSteps;
    while (at + 1 < kSteps && share[at + 1] < wanted) ++at;
    const double a = step * static_cast<double>(at);
    const double b = a + step;
    const double inside = share[at + 1] > share[at] ? (wanted - share[at]) / (share[at + 1] - share[at]) : 1.0;
    inverse[k] = static_cast<float>(a * a + (b * b - a * a) * std::clamp(inside, 0.0, 1.0));
  }
  inverse_ = LinearTable(0, 1, std::move(inverse));

  // The marginal: chords of the disc, summed up by the trapezoidal rule.
  std::vector<double> below(kSteps + 1);
  const double width = 2 * radius / kSteps;
  double previous = 0;
  for (std::size_t i = 1; i <= kSteps; ++i) {
    const double x = width * static_cast<double>(i) - radius;
    const double half_chord = std::sqrt(std::max(0.0, radius * radius - x * x)) * (1 - 1e-12);
    const double chord = half_chord > 0 ? 2 * simpson(0, half_chord, 64, [&](double y) { return density(x, y); }) : 0.0;
    below[i] = below[i - 1] + width / 2 * (previous + chord);
    previous = chord;
  }
  for (double& b : below) b /= below.back();
  marginal_ = LinearTable(-radius, radius, std::vector<float>(below.begin(), below.end()));
}

Vec2f FilterDensity::offset(Vec2f unit) const {
  if (!disc()) return {inverse_(unit.x), inverse_(unit.y)};
  const float r = std::sqrt(inverse_(unit.x));
  const float angle = 2 * std::numbers::pi_v<float> * unit.y;
  return {r * std::cos(angle), r * std::sin(angle)};
}

double FilterDensity::share(double x0, double x1, double y0, double y1) const {
  if (!disc()) {
    return (filter_->integral(x1) - filter_->integral(x0)) * (filter_->integral(y1) - filter_->integral(y0));
  }
  constexpr int kParts = 4;  // midpoints of 4 x 4 parts
  double sum = 0;
  for (int j = 0; j < kParts; ++j) {
    for (int i = 0; i < kParts; ++i) {
      sum += filter_->value(x0 + (x1 - x0) * (i + 0.5) / kParts, y0 + (y1 - y0) * (j + 0.5) / kParts);
    }
  }
  return sum * (x1 - x0) * (y1 - y0) / (kParts * kParts);
}

}  // namespace abn
