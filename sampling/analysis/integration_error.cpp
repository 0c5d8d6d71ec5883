#include "sampling/analysis/integration_error.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::analysis {
namespace {

constexpr std::uint64_t seed = 99;
constexpr std::ptrdiff_t integrands = 400;

/// The squared error of one estimate, and its expectation for independent points.
struct SquaredError {
  double measured = 0;
  double white = 0;
};

/// The mean of f(x, y) over the points shifted by `shift`, in the order of the points.
template <class F>
double mean_over(Points points, Vec2f shift, const F& f) {
  const double shift_x = shift.x;
  const double shift_y = shift.y;
  double sum = 0;
  for (const Point& p : points) {
    double x = p.x + shift_x;
    double y = p.y + shift_y;
    x -= x >= 1 ? 1 : 0;
    y -= y >= 1 ? 1 : 0;
    sum += f(x, y);
  }
  return sum / static_cast<double>(points.size());
}

SquaredError squared_error(double estimate, double integral, double integral_of_square, Points points) {
  return {(estimate - integral) * (estimate - integral),
          (integral_of_square - integral * integral) / static_cast<double>(points.size())};
}

/// Area of {(x, y) in the unit square : a x + b y < c}: the polygon left after clipping.
double half_plane_area(double a, double b, double c) {
  constexpr std::array<Point, 4> corners{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  std::vector<Point> polygon;
  for (std::size_t i = 0; i < 4; ++i) {
    const Point& from = corners[i];
    const Point& to = corners[(i + 1) % 4];
    const double at_from = a * from.x + b * from.y - c;
    const double at_to = a * to.x + b * to.y - c;
    if (at_from < 0) polygon.push_back(from);
    if ((at_from < 0) != (at_to < 0)) {
      const double t = at_from / (at_from - at_to);
      polygon.push_back({from.x + t * (to.x - from.x), from.y + t * (to.y - from.y)});
    }
  }
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point& from = polygon[i];
    const Point& to = polygon[(i + 1) % polygon.size()];
    twice += from.x * to.y - to.x * from.y;
  }
  return std::abs(twice) / 2;
}

SquaredError half_plane(Points points, std::uint64_t t) {
  Rng rng(seed, stream_id("half planes"), t);
  const Vec2f shift = rng.uniform2();
  const Vec2f through = rng.uniform2();
  const double angle = 2 * std::numbers::pi * static_cast<double>(rng.uniform());
  const double a = std::cos(angle);
  const double b = std::sin(angle);
  const double c = a * static_cast<double>(through.x) + b * static_cast<double>(through.y);
  const double inside = mean_over(points, shift, [=](double x, double y) { return a * x + b * y < c ? 1.0 : 0.0; });
  const double area = half_plane_area(a, b, c);
  return squared_error(inside, area, area, points);
}

/// Integral of exp(-(x - centre)^2 / (2 sigma^2)) over [0, 1].
double gaussian_integral(double centre, double sigma) {
  const double scale = 1 / (sigma * std::numbers::sqrt2);
  return sigma * std::sqrt(std::numbers::pi / 2) * (std::erf((1 - centre) * scale) + std::erf(centre * scale));
}

SquaredError gaussian(Points points, std::uint64_t t) {
  Rng rng(seed, stream_id("gaussians"), t);
  const Vec2f shift = rng.uniform2();
  const double centre_x = rng.uniform();
  const double centre_y = rng.uniform();
  const double sigma = 0.05 + 0.2 * static_cast<double>(rng.uniform());
  const double factor = -0.5 / (sigma * sigma);
  const double mean = mean_over(points, shift, [=](double x, double y) {
    return std::exp(factor * ((x - centre_x) * (x - centre_x) + (y - centre_y) * (y - centre_y)));
  });
  // The square of a Gaussian is one of sigma / sqrt(2).
  const double narrow = sigma / std::numbers::sqrt2;
  return squared_error(mean, gaussian_integral(centre_x, sigma) * gaussian_integral(centre_y, sigma),
                       gaussian_integral(centre_x, narrow) * gaussian_integral(centre_y, narrow), points);
}

SquaredError disc(Points points, std::uint64_t t) {
  Rng rng(seed, stream_id("discs"), t);
  const Vec2f shift = rng.uniform2();
  const double centre_x = rng.uniform();
  const double centre_y = rng.uniform();
  const double radius = 0.05 + 0.35 * static_cast<double>(rng.uniform());
  const double inside = mean_over(points, shift, [=](double x, double y) {
    const double across_x = std::abs(x - centre_x);
    const double across_y = std::abs(y - centre_y);
    const double dx = across_x < 1 - across_x ? across_x : 1 - across_x;
    const double dy = across_y < 1 - across_y ? across_y : 1 - across_y;
    return dx * dx + dy * dy < radius * radius ? 1.0 : 0.0;
  });
  const double area = std::numbers::pi * radius * radius;
  return squared_error(inside, area, area, points);
}

using Integrand = SquaredError (*)(Points, std::uint64_t);

double relative_error(Points points, Integrand integrand) {
  std::array<SquaredError, integrands> errors;
#pragma omp parallel for schedule(dynamic, 1)
  for (std::ptrdiff_t t = 0; t < integrands; ++t) {
    errors[static_cast<std::size_t>(t)] = integrand(points, static_cast<std::uint64_t>(t));
  }
  SquaredError sum;
  for (const SquaredError& error : errors) {
    sum.measured += error.measured;
    sum.white += error.white;
  }
  return std::sqrt(sum.measured / sum.white);
}

}  // namespace

IntegrationError integration_error(Points points) {
  if (points.empty()) throw ConfigError("integration error: the point set is empty; give at least one point");
  return {.half_planes = relative_error(points, half_plane),
          .gaussians = relative_error(points, gaussian),
          .discs = relative_error(points, disc)};
}

}  // namespace abn::analysis
