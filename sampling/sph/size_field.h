// The size field s(x): the local spacing relative to the mean spacing.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "sampling/error.h"
#include "sampling/grid.h"
#include "sampling/hd.h"

namespace abn::sph {

/// Bilinear between cell centres, periodic. u in [0,width), v in [0,height): position in cells of the raster.
template <class Real>
ABN_HD inline Real bilinear_periodic(const float* cells, std::uint32_t width, std::uint32_t height, Real u, Real v) {
  const Real a = u - Real(0.5);
  const Real b = v - Real(0.5);
  const Real column = std::floor(a);
  const Real row = std::floor(b);
  const Real fx = a - column;
  const Real fy = b - row;
  // u < width may round to width - 0.5 + ulp in a, so both neighbours are wrapped, not only the right one.
  const auto wrapped = [](Real at, std::uint32_t count) {
    const auto i = static_cast<std::int64_t>(at);
    return static_cast<std::uint64_t>(i < 0 ? i + count : i >= std::int64_t{count} ? i - count : i);
  };
  const std::uint64_t x0 = wrapped(column, width);
  const std::uint64_t x1 = wrapped(column + Real(1), width);
  const std::uint64_t y0 = wrapped(row, height) * width;
  const std::uint64_t y1 = wrapped(row + Real(1), height) * width;
  const Real top = static_cast<Real>(cells[y0 + x0]) * (Real(1) - fx) + static_cast<Real>(cells[y0 + x1]) * fx;
  const Real bottom = static_cast<Real>(cells[y1 + x0]) * (Real(1) - fx) + static_cast<Real>(cells[y1 + x1]) * fx;
  return top * (Real(1) - fy) + bottom * fy;
}

/// Mean of s^-2 over the raster, exactly for the bilinear interpolant: over one square between four cell centres the
/// integral of s^-2 is 1 / L(s00 s11, s10 s01), L the logarithmic mean.
inline double mean_inverse_square(const Grid<float>& s) {
  const Extent size = s.size();
  double total = 0;
  for (std::uint32_t y = 0; y < size.height; ++y) {
    const std::uint32_t below = y + 1 == size.height ? 0 : y + 1;
    double row = 0;
    for (std::uint32_t x = 0; x < size.width; ++x) {
      const std::uint32_t right = x + 1 == size.width ? 0 : x + 1;
      const double p = double{s.at(x, y)} * double{s.at(right, below)};
      const double q = double{s.at(right, y)} * double{s.at(x, below)};
      const double t = (p - q) / (p + q);  // L = (p-q) / ln(p/q) = (p+q)/2 * t / atanh(t)
      const double inverse = std::abs(t) < 1e-4 ? 1 + t * t / 3 : std::atanh(t) / t;
      row += inverse / (0.5 * (p + q));
    }
    total += row;
  }
  return total / static_cast<double>(size.area());
}

/// `s` scaled so that the integral of s^-2 over the plane is its area, i.e. the mean of s^-2 is 1: then N particles at
/// density s^-2 fill the plane. A spacing above `largest` [d] is cut to it first. Throws ConfigError unless every value
/// is finite and > 0.
inline Grid<float> normalised_size_field(const Grid<float>& s, double largest) {
  if (s.size().area() == 0) throw ConfigError("size field: it has no cells; give at least 1x1");
  float maximum = 0;
  for (std::size_t i = 0; i < s.cells().size(); ++i) {
    if (!(s[i] > 0 && std::isfinite(s[i]))) {
      throw ConfigError("size field: cell " + std::to_string(i) + " is " + std::to_string(s[i]) +
                        "; every relative spacing must be finite and > 0");
    }
    maximum = std::max(maximum, s[i]);
  }
  Grid<float> result = s;
  const auto scale_by = [&](double factor, double limit) {
    for (float& value : result.cells()) {
      value = static_cast<float>(std::min(std::max(double{value} * factor, 1e-6), limit));
    }
  };
  // Only ratios count: bring the largest value to 1 first, so that no square over- or underflows.
  scale_by(1.0 / double{maximum}, 1.0);
  scale_by(std::sqrt(mean_inverse_square(result)), largest);
  scale_by(std::sqrt(mean_inverse_square(result)), largest);
  return result;
}

}  // namespace abn::sph
