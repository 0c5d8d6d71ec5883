// Whether one straight edge crosses a pixel (straight_edges.h), for host and device.
#pragma once

#include <cmath>
#include <cstdint>

#include "sampling/hd.h"
#include "sampling/vec.h"

namespace abn {

struct PixelSample {
  double x = 0, y = 0;  // [px], inside the pixel
  double value = 0;     // mean of the channels
};

/// value [channels] is that of the sample at `position` [px].
ABN_HD inline PixelSample pixel_sample(Vec2f position, const float* value, std::uint32_t channels) {
  double mean = 0;
  for (std::uint32_t c = 0; c < channels; ++c) mean += static_cast<double>(value[c]) / channels;
  return {static_cast<double>(position.x - std::floor(position.x)),
          static_cast<double>(position.y - std::floor(position.y)), mean};
}

/// The order in which two classes are looked for. Samples of which none is before the other are the same.
ABN_HD constexpr bool before(const PixelSample& a, const PixelSample& b) {
  return a.value != b.value ? a.value < b.value : a.x != b.x ? a.x < b.x : a.y < b.y;
}

/// Sum of squared deviations of the values of n >= 1 samples.
ABN_HD inline double squared_deviations(const PixelSample* sample, std::uint32_t n) {
  double mean = 0;
  for (std::uint32_t k = 0; k < n; ++k) mean += sample[k].value;
  mean /= n;
  double sum = 0;
  for (std::uint32_t k = 0; k < n; ++k) sum += (sample[k].value - mean) * (sample[k].value - mean);
  return sum;
}

/// The error that n samples leave, V n^-1.5 up to a constant.
ABN_HD inline double error_left(double squared_deviations, std::uint32_t n) {
  const double count = n;
  return squared_deviations / (count * count * std::sqrt(count));
}

inline constexpr std::uint32_t least_edge_samples = 10;

/// How many of the samples, in order, form the lower class; 0 if two classes do not explain enough of `total`, the sum
/// of squared deviations.
ABN_HD inline std::uint32_t lower_class(const PixelSample* sample, std::uint32_t n, double total) {
  constexpr std::uint32_t least_class = 3;
  constexpr double explained = 0.92;
  double sum = 0;
  for (std::uint32_t k = 0; k < n; ++k) sum += sample[k].value;
  const double count = n;
  double lower = 0;
  double best = 0;
  std::uint32_t at = 0;
  for (std::uint32_t k = 1; k < n; ++k) {
    lower += sample[k - 1].value - sum / count;
    if (sample[k].value <= sample[k - 1].value) continue;
    const double below = k;
    const double between = lower * lower * count / (below * (count - below));
    if (between > best) {
      best = between;
      at = k;
    }
  }
  return best >= explained * total && at >= least_class && n - at >= least_class ? at : 0;
}

/// Whether a straight line, but for .05 px, has the first `at` samples on one side and the others on the other.
ABN_HD inline bool separated(const PixelSample* sample, std::uint32_t n, std::uint32_t at) {
  constexpr double overlap = 0.05;  // [px]
  const auto centre = [&](std::uint32_t begin, std::uint32_t end, double& x, double& y) {
    const double count = end - begin;
    for (std::uint32_t k = begin; k < end; ++k) {
      x += sample[k].x / count;
      y += sample[k].y / count;
    }
  };
  double low_x = 0;
  double low_y = 0;
  double high_x = 0;
  double high_y = 0;
  centre(0, at, low_x, low_y);
  centre(at, n, high_x, high_y);
  double xx = 1e-4;  // [px^2], so that classes on a line have a discriminant too
  double yy = 1e-4;
  double xy = 0;
  for (std::uint32_t k = 0; k < n; ++k) {
    const double x = sample[k].x - (k < at ? low_x : high_x);
    const double y = sample[k].y - (k < at ? low_y : high_y);
    xx += x * x;
    yy += y * y;
    xy += x * y;
  }
  const double dx = high_x - low_x;
  const double dy = high_y - low_y;
  if (dx * dx + dy * dy < 1e-8) return false;  // one on the other
  double nx = yy * dx - xy * dy;
  double ny = xx * dy - xy * dx;
  const double length = std::sqrt(nx * nx + ny * ny);  // > 0: the scatter is positive definite
  nx /= length;
  ny /= length;
  double most = -1e30;
  double least = 1e30;
  for (std::uint32_t k = 0; k < n; ++k) {
    const double along = sample[k].x * nx + sample[k].y * ny;
    if (k < at) {
      most = along > most ? along : most;
    } else {
      least = along < least ? along : least;
    }
  }
  return least - most > -overlap;
}

}  // namespace abn
