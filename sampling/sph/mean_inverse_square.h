// The mean of s^-2 over a rectangle, for host and device.
#pragma once

#include <bit>
#include <cstdint>

#include "sampling/hd.h"

namespace abn::sph {

inline constexpr double series_below = 0.02;  // of t^2: there the series of atanh(t) / t has converged

/// atanh(t) / t for u = t^2 < series_below.
ABN_HD inline double inverse_logarithmic_mean_by_series(double u) {
  return 1 + u * (1.0 / 3 + u * (1.0 / 5 + u * (1.0 / 7 + u * (1.0 / 9 + u * (1.0 / 11 + u / 13)))));
}

/// ln x, x > 0 and normal. By operations that every machine rounds alike: the logarithms of libraries differ.
ABN_HD inline double logarithm(double x) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  auto exponent = static_cast<double>(bits >> 52U) - 1023;
  auto factor = std::bit_cast<double>((bits & 0xFFFFFFFFFFFFFU) | 0x3FF0000000000000U);
  if (factor > 1.4142135623730951) {
    factor *= 0.5;
    exponent += 1;
  }
  const double t = (factor - 1) / (factor + 1);  // ln factor = 2 atanh(t), |t| < 0.172
  const double u = t * t;
  const double tail = u * (1.0 / 13 + u * (1.0 / 15 + u * (1.0 / 17 + u * (1.0 / 19 + u / 21))));
  const double series = u * (1.0 / 3 + u * (1.0 / 5 + u * (1.0 / 7 + u * (1.0 / 9 + u * (1.0 / 11 + tail)))));
  return exponent * 0.69314718055994531 + (2 * t + 2 * t * series);
}

/// atanh(t) / t, |t| <= 1, by its series where that converges at once. Finite where t rounds to 1.
ABN_HD inline double inverse_logarithmic_mean(double t) {
  const double u = t * t;
  if (u < series_below) return inverse_logarithmic_mean_by_series(u);
  return 0.5 * logarithm((1 + t) / (1 - t)) / t;
}

/// Mean of s^-2 over a rectangle of the bilinear interpolant, from its values > 0 at the corners.
ABN_HD inline double mean_inverse_square(double upper_left, double upper_right, double lower_left, double lower_right) {
  const double p = upper_left * lower_right;
  const double q = upper_right * lower_left;
  const double t = (p - q) / (p + q);  // L = (p-q) / ln(p/q) = (p+q)/2 * t / atanh(t)
  return inverse_logarithmic_mean(t) / (0.5 * (p + q));
}

}  // namespace abn::sph
