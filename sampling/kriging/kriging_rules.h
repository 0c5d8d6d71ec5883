// What kriging on the host and on a device have in common: its numbers, and the parts that work on single points.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "sampling/hd.h"
#include "sampling/kriging/pixel_estimates.h"

namespace abn::kriging_rules {

inline constexpr std::uint32_t usual_neighbours = 40;  // more only if they are the pixel's own, and 12 beyond those
inline constexpr std::uint32_t most_neighbours = 110;
inline constexpr std::uint32_t extra_neighbours = 12;
inline constexpr std::uint32_t merge_cells = 9;  // per side, for pixels with more samples of their own than fit
inline constexpr float growth = 1.6F;            // of the margin
inline constexpr int growths = 7;
inline constexpr float least_nugget = 1e-3F;  // keeps coincident samples solvable in single precision

inline constexpr int quadrature = 5;  // cells per side, over the pixel
// The mean distance to a square cell of side h is sqrt(r^2 + h^2/12) to leading order in h/r: h^2/12 is the transverse
// variance of a point of the cell. The second term makes up for the cell that holds the point, where this is too short:
// errors stay below 5e-4 px, of either sign.
inline constexpr float cell_spread = 1.0F / (12 * quadrature * quadrature) + 3.5e-4F;
inline constexpr float mean_square_distance = 0.52140543F;  // of two points of the unit square
inline constexpr float least_pivot = 1e-6F;
inline constexpr float least_variance = 1e-5F;  // rounding; reached by some hundred samples
inline constexpr float fewest_for_trend = 6;
inline constexpr float collinear = 1e-3F;  // 1 - correlation^2 of the points' x and y below which no trend is fitted
inline constexpr std::uint32_t fewest_for_gaps = 4;

/// The nugget of one sample. A film of few samples would get one that drowns the variogram.
inline float nugget_of(double samples_per_pixel, const KrigingOptions& options) {
  const double per_pixel = samples_per_pixel > 0.25 ? samples_per_pixel : 0.25;
  const auto nugget = static_cast<float>(options.nugget_at_6_spp * std::sqrt(6 / per_pixel));
  return nugget > least_nugget ? nugget : least_nugget;
}

/// The nugget of the mean of `count` samples.
ABN_HD inline float merged_nugget(float nugget, double count) {
  const float merged = nugget / static_cast<float>(count);
  return merged < least_nugget ? least_nugget : merged;
}

/// The cell of a pixel in which samples are merged, from their place in the pixel [px].
ABN_HD inline std::uint32_t merge_cell(float x, float y) {
  const auto along = [](float t) {
    const float cell = t * merge_cells;
    const auto last = static_cast<float>(merge_cells - 1);
    return static_cast<std::uint32_t>(cell < 0 ? 0.0F : (last < cell ? last : cell));
  };
  return along(y) * merge_cells + along(x);
}

/// The covariance sill - |r| is positive definite if the sill exceeds .64 times the diameter of the disc that holds the
/// points (their largest mean distance under any weights of sum 1: that of the uniform circle, 4 R / pi). Weights and
/// variance do not depend on it; the smaller it is, the better the condition.
ABN_HD inline float sill_for(float margin) { return 0.75F * std::sqrt(2.0F) * (1 + 2 * margin); }

/// The mean distance of (x, y) from the points of the unit square [px], by 5 x 5 cells.
ABN_HD inline float mean_distance(float x, float y) {
  float sum = 0;
  for (int v = 0; v < quadrature; ++v) {
    for (int u = 0; u < quadrature; ++u) {
      const float dx = (static_cast<float>(u) + 0.5F) / quadrature - x;
      const float dy = (static_cast<float>(v) + 0.5F) / quadrature - y;
      sum += std::sqrt(dx * dx + dy * dy + cell_spread);
    }
  }
  return sum / (quadrature * quadrature);
}

/// The scale of one sample and its weight in the mean over gaps.
struct GapScale {
  double scale, weight;
};

/// Where samples were added because values differ, the scale of all samples is that of the crowd, while the error comes
/// from the gaps. Every sample has a scale of its own, its squared difference to the nearest other one over their
/// distance; it stands for a cell of that distance squared, whose error goes with the cell's area squared times the
/// distance.
ABN_HD inline GapScale gap_scale(const float* x, const float* y, const float* light, std::uint32_t count,
                                 std::uint32_t i) {
  float nearest = std::numeric_limits<float>::max();
  std::uint32_t other = i;
  for (std::uint32_t k = 0; k < count; ++k) {
    const float dx = x[k] - x[i];
    const float dy = y[k] - y[i];
    const float squared = dx * dx + dy * dy;
    if (squared < nearest && k != i) {
      nearest = squared;
      other = k;
    }
  }
  const double distance = std::sqrt(static_cast<double>(nearest)) + 1e-3;  // [px]; coincident samples
  const double difference = static_cast<double>(light[i]) - static_cast<double>(light[other]);
  return {difference * difference / distance, distance * distance * distance * distance * distance};
}

/// The scale at gaps relative to that of all samples alike; 1 where samples are even, or few.
class GapMean {
 public:
  /// The scales of all points of a pixel, in their order.
  ABN_HD void add(GapScale own) {
    weighted_ += own.weight * own.scale;
    weights_ += own.weight;
    plain_ += own.scale;
  }
  ABN_HD float ratio(std::uint32_t count) const {
    if (!(plain_ > 0)) return 1;
    return static_cast<float>(weighted_ / weights_ / (plain_ / count));
  }

 private:
  double weighted_ = 0, weights_ = 0, plain_ = 0;
};

}  // namespace abn::kriging_rules
