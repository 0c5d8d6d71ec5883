// The lattice alarm: a regular lattice hidden in a point set shows as single tall peaks on the frequency axes, which a
// radial mean dilutes and a random choice of frequencies misses.
#pragma once

#include <cstddef>
#include <vector>

#include "sampling/analysis/harmonic_products.h"
#include "sampling/analysis/points.h"

namespace abn::analysis {

/// P(f) = |sum_j exp(-2 pi i f.x_j)|^2 / N along the axes and, as information, along the diagonals; index k =
/// frequency, k = 1..reach, index 0 holds 0.
struct AxisPower {
  enum class Axis { x, y };
  std::vector<double> x;              // [reach + 1] P(k, 0)
  std::vector<double> y;              // [reach + 1] P(0, k)
  std::vector<double> diagonal;       // [reach + 1] P(k, k)
  std::vector<double> anti_diagonal;  // [reach + 1] P(k, -k)

  // The tallest peak on the axes: the alarm. A lattice of N points has N there.
  double largest = 0;
  Axis axis = Axis::x;
  std::size_t frequency = 0;
  double largest_diagonal = 0;         // of both diagonals; no alarm: many good nets have it
  double expected_of_white_noise = 0;  // of `largest`: the harmonic number of 2 reach, about ln(2 reach) + 0.58
};

/// `reach` = 0 means 4 sqrt(N), rounded up. O(N reach), in double, bit-identical for any number of threads. Throws
/// ConfigError for no points or a reach above 2^20.
AxisPower axis_power(Points points, std::size_t reach = 0, VectorUnit unit = vector_units().back());

}  // namespace abn::analysis
