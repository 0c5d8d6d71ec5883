// What the tests of strategies that relax all samples together measure. Every measure is relative to a known one: the
// densest packing, or white noise.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "sampling/rng.h"
#include "sampling/vec.h"

namespace abn {

/// Distances between nearest neighbours on the torus, relative to that of the hexagonal lattice, r_max.
struct Spacing {
  double least = 0;
  double mean = 0;
};

inline Spacing nearest_neighbours(const std::vector<Vec2f>& points, Extent plane) {
  const double largest =
      std::sqrt(2 / std::sqrt(3.0) * static_cast<double>(plane.area()) / static_cast<double>(points.size()));
  const auto width = static_cast<float>(plane.width);
  const auto height = static_cast<float>(plane.height);
  std::vector<Vec2f> by_y = points;
  std::sort(by_y.begin(), by_y.end(), [](Vec2f a, Vec2f b) { return a.y < b.y; });
  const std::size_t n = by_y.size();
  Spacing spacing{1e30, 0};
  for (std::size_t i = 0; i < n; ++i) {
    float best = 1e30F;
    for (const bool up : {false, true}) {
      for (std::size_t step = 1; step < n; ++step) {
        const Vec2f other = by_y[(i + (up ? n - step : step)) % n];
        float dy = up ? by_y[i].y - other.y : other.y - by_y[i].y;
        if (dy < 0) dy += height;
        if (dy * dy >= best) break;
        float dx = std::abs(by_y[i].x - other.x);
        dx = std::min(dx, width - dx);
        best = std::min(best, dx * dx + dy * dy);
      }
    }
    const double nearest = std::sqrt(double{best}) / largest;
    spacing.least = std::min(spacing.least, nearest);
    spacing.mean += nearest / static_cast<double>(n);
  }
  return spacing;
}

/// The largest power at the frequencies (k,0) and (0,k), k up to 2 sqrt N: where a square lattice shows. White is 1.
inline double largest_axis_power(const std::vector<Vec2f>& points, Extent plane) {
  const auto highest = static_cast<std::size_t>(2 * std::sqrt(static_cast<double>(points.size())));
  std::vector<std::complex<double>> x(highest + 1), y(highest + 1);
  for (const Vec2f p : points) {
    const auto turn_x = std::polar(1.0, 2 * std::numbers::pi * double{p.x} / plane.width);
    const auto turn_y = std::polar(1.0, 2 * std::numbers::pi * double{p.y} / plane.height);
    std::complex<double> at_x = 1, at_y = 1;
    for (std::size_t k = 1; k <= highest; ++k) {
      x[k] += at_x *= turn_x;
      y[k] += at_y *= turn_y;
    }
  }
  double largest = 0;
  for (std::size_t k = 1; k <= highest; ++k) largest = std::max({largest, std::norm(x[k]), std::norm(y[k])});
  return largest / static_cast<double>(points.size());
}

/// Area of {(x,y) in the unit square : a x + b y < c}: the polygon left after clipping.
inline double half_plane_area(double a, double b, double c) {
  const double corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  std::vector<std::pair<double, double>> polygon;
  for (int i = 0; i < 4; ++i) {
    const auto& [x0, y0] = corners[i];
    const auto& [x1, y1] = corners[(i + 1) % 4];
    const double f0 = a * x0 + b * y0 - c;
    const double f1 = a * x1 + b * y1 - c;
    if (f0 < 0) polygon.emplace_back(x0, y0);
    if ((f0 < 0) != (f1 < 0)) {
      const double t = f0 / (f0 - f1);
      polygon.emplace_back(x0 + t * (x1 - x0), y0 + t * (y1 - y0));
    }
  }
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto& [x0, y0] = polygon[i];
    const auto& [x1, y1] = polygon[(i + 1) % polygon.size()];
    twice += x0 * y1 - x1 * y0;
  }
  return std::abs(twice) / 2;
}

/// Root of the summed squared errors of 400 half-planes, the points shifted on the torus for each, relative to the
/// same of independent points: where long waves of the density show.
inline double half_plane_error(const std::vector<Vec2f>& points, Extent plane) {
  const auto n = static_cast<double>(points.size());
  double error = 0;
  double white = 0;
  for (std::uint64_t t = 0; t < 400; ++t) {
    Rng rng(99, stream_id("half planes"), t);
    const Vec2f shift = rng.uniform2();
    const Vec2f through = rng.uniform2();
    const double angle = 2 * std::numbers::pi * double{rng.uniform()};
    const double a = std::cos(angle);
    const double b = std::sin(angle);
    const double c = a * double{through.x} + b * double{through.y};
    double inside = 0;
    for (const Vec2f p : points) {
      double x = double{p.x} / plane.width + double{shift.x};
      double y = double{p.y} / plane.height + double{shift.y};
      x -= x >= 1 ? 1 : 0;
      y -= y >= 1 ? 1 : 0;
      inside += a * x + b * y < c ? 1 : 0;
    }
    const double area = half_plane_area(a, b, c);
    error += (inside / n - area) * (inside / n - area);
    white += area * (1 - area) / n;
  }
  return std::sqrt(error / white);
}

}  // namespace abn
