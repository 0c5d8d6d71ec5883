// What the tests of blue-noise strategies measure.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "sampling/sampler.h"

namespace abn {

/// All samples of a strategy, batch by batch [px].
inline std::vector<Vec2f> all_positions(Sampler& sampler) {
  const Grid<PixelStats> pixels({1, 1});
  std::vector<Vec2f> positions;
  for (;;) {
    const SampleBatch batch = sampler.next({pixels});
    if (batch.empty()) return positions;
    positions.insert(positions.end(), batch.position.begin(), batch.position.end());
  }
}

/// The value of a diagnostic; NaN if there is none of that name.
inline double diagnostic(const Sampler& sampler, const std::string& name) {
  for (const auto& entry : sampler.diagnostics()) {
    if (entry.name == name) return entry.value;
  }
  return std::nan("");
}

/// The smallest distance of any two points on the torus [px], by a sweep along the longer side; infinite for one.
inline double smallest_torus_distance(std::vector<Vec2f> points, Extent plane) {
  if (plane.width > plane.height) {
    for (auto& point : points) std::swap(point.x, point.y);
    std::swap(plane.width, plane.height);
  }
  std::sort(points.begin(), points.end(), [](Vec2f a, Vec2f b) { return a.y < b.y; });
  const double width = plane.width;
  const double height = plane.height;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t step = 1; step < points.size(); ++step) {
      const std::size_t j = (i + step) % points.size();
      double ahead = static_cast<double>(points[j].y) - static_cast<double>(points[i].y);
      if (j < i) ahead += height;
      if (ahead >= best) break;
      const double dy = std::min(ahead, height - ahead);
      const double aside = std::abs(static_cast<double>(points[j].x) - static_cast<double>(points[i].x));
      const double dx = std::min(aside, width - aside);
      best = std::min(best, std::sqrt(dx * dx + dy * dy));
    }
  }
  return best;
}

/// Mean of the power spectrum |sum exp(-2 pi i f.x)|^2 / N over the frequencies 0 < |f| < sqrt(N) / 2 of the torus;
/// white noise has 1.
inline double low_frequency_power(const std::vector<Vec2f>& points, Extent plane) {
  const auto count = static_cast<double>(points.size());
  const double limit = 0.5 * std::sqrt(count);
  const int reach = static_cast<int>(limit);
  double power = 0;
  double frequencies = 0;
  for (int fy = 0; fy <= reach; ++fy) {
    for (int fx = -reach; fx <= reach; ++fx) {
      if ((fy == 0 && fx <= 0) || fx * fx + fy * fy >= limit * limit) continue;
      double real = 0;
      double imaginary = 0;
      for (const Vec2f point : points) {
        const double angle =
            2 * std::numbers::pi *
            (fx * static_cast<double>(point.x) / plane.width + fy * static_cast<double>(point.y) / plane.height);
        real += std::cos(angle);
        imaginary += std::sin(angle);
      }
      power += (real * real + imaginary * imaginary) / count;
      frequencies += 1;
    }
  }
  return power / frequencies;
}

}  // namespace abn
