// The inverse of a distribution function that has none in closed form.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace abn {

/// Inverts a function that rises from 0 at -radius to 1/2 at 0: a table of x at equidistant u, cubic Hermite between
/// its entries where that was checked to be accurate to 4e-9, else Newton's method between two entries. Monotone.
/// Immutable once built; both functions must be the same in every call.
class InverseTable {
 public:
  /// `integral` is the function, `density` >= 0 its derivative.
  void build(double radius, const auto& integral, const auto& density) {
    x_.resize(cells + 1);
    slope_.resize(cells + 1);
    smooth_.resize(cells);
    x_[0] = -radius;
    x_[cells] = 0;
    for (std::size_t i = 1; i < cells; ++i) {
      x_[i] = solve(step * static_cast<double>(i), x_[i - 1], 0, integral, density);
    }
    for (std::size_t i = 0; i <= cells; ++i) {
      const double height = density(x_[i]);
      slope_[i] = height > 0 ? step / height : -1;
    }
    for (std::size_t i = 0; i < cells; ++i) smooth_[i] = is_smooth(i, integral, density) ? 1 : 0;
  }

  /// x with integral(x) = u. Preconditions: built; u in (0, 1/2].
  double operator()(double u, const auto& integral, const auto& density) const {
    const double place = u / step;
    const auto cell = std::min(static_cast<std::size_t>(place), cells - 1);
    if (smooth_[cell] != 0) return cubic(cell, place - static_cast<double>(cell));
    return solve(u, x_[cell], x_[cell + 1], integral, density);
  }

 private:
  static constexpr std::size_t cells = 2048;
  static constexpr double step = 0.5 / cells;

  double cubic(std::size_t i, double t) const {
    const double rise = x_[i + 1] - x_[i];
    const double s = 1 - t;
    return x_[i] + t * (rise * t * (1 + 2 * s) + s * (slope_[i] * s - slope_[i + 1] * t));
  }

  /// Accurate, and monotone: slopes within three times the rise (Fritsch and Carlson 1980).
  bool is_smooth(std::size_t i, const auto& integral, const auto& density) const {
    const double rise = x_[i + 1] - x_[i];
    if (slope_[i] < 0 || slope_[i + 1] < 0 || std::max(slope_[i], slope_[i + 1]) > 3 * rise) return false;
    for (const double t : {0.25, 0.5, 0.75}) {
      const double exact = solve(step * (static_cast<double>(i) + t), x_[i], x_[i + 1], integral, density);
      if (std::abs(cubic(i, t) - exact) > 4e-9) return false;
    }
    return true;
  }

  /// Newton's method from the middle of [low, high], halving it instead wherever a step would leave it.
  static double solve(double u, double low, double high, const auto& integral, const auto& density) {
    double x = 0.5 * (low + high);
    for (int i = 0; i < 100 && low < high; ++i) {
      const double excess = integral(x) - u;
      (excess > 0 ? high : low) = x;
      const double height = density(x);
      double next = height > 0 ? x - excess / height : low;
      if (!(next > low && next < high)) next = 0.5 * (low + high);
      const double change = std::abs(next - x);
      x = next;
      if (change < 1e-14) break;
    }
    return x;
  }

  std::vector<double> x_, slope_;      // at u = i step; dx/du * step, -1 where it is infinite
  std::vector<unsigned char> smooth_;  // [cells]
};

}  // namespace abn
