#include "sampling/analysis/axis_power.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "sampling/error.h"

namespace abn::analysis {
namespace {

// Every frequency is coarse + fine or coarse - fine, with coarse a multiple of kCoarse and fine <= kFine: one product
// of tables serves both signs, and the tables cost next to nothing.
constexpr std::size_t kFine = 23;  // with 0: one panel
constexpr std::size_t kCoarse = 2 * kFine + 1;

// |sum_j exp(-2 pi i k t_j)|^2 / N, k = 0..reach
std::vector<double> line_power(std::span<const double> t, std::size_t reach, VectorUnit unit) {
  HarmonicProducts sums({(reach + kFine) / kCoarse + 1, kCoarse}, {kFine + 1, 1}, unit);
  sums.add(t, t);
  std::vector<double> power(reach + 1);
  const auto n = static_cast<double>(t.size());
  for (std::size_t k = 1; k <= reach; ++k) {
    const std::size_t coarse = (k + kFine) / kCoarse;
    const bool above = k >= coarse * kCoarse;
    const std::size_t fine = above ? k - coarse * kCoarse : coarse * kCoarse - k;
    const double sign = above ? 1 : -1;
    const double cosine = sums.cos_cos(coarse, fine) - sign * sums.sin_sin(coarse, fine);
    const double sine = sums.sin_cos(coarse, fine) + sign * sums.cos_sin(coarse, fine);
    power[k] = (cosine * cosine + sine * sine) / n;
  }
  return power;
}

}  // namespace

AxisPower axis_power(Points points, std::size_t reach, VectorUnit unit) {
  if (points.empty()) throw ConfigError("axis power: the set has no points; give at least 1");
  if (reach > std::size_t{1} << 20) {
    throw ConfigError("axis power: reach " + std::to_string(reach) + " is above 2^20; give a lower one");
  }
  if (reach == 0) reach = static_cast<std::size_t>(std::ceil(4 * std::sqrt(static_cast<double>(points.size()))));
  constexpr double kDirections[4][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
  std::vector<double> power[4];
#pragma omp parallel for schedule(static, 1)
  for (int line = 0; line < 4; ++line) {
    std::vector<double> phase(points.size());
    for (std::size_t j = 0; j < points.size(); ++j) {
      phase[j] = kDirections[line][0] * points[j].x + kDirections[line][1] * points[j].y;
    }
    power[line] = line_power(phase, reach, unit);
  }
  AxisPower result;
  result.x = std::move(power[0]);
  result.y = std::move(power[1]);
  result.diagonal = std::move(power[2]);
  result.anti_diagonal = std::move(power[3]);
  for (std::size_t k = 1; k <= reach; ++k) {
    if (result.x[k] > result.largest) {
      result.largest = result.x[k];
      result.axis = AxisPower::Axis::x;
      result.frequency = k;
    }
    if (result.y[k] > result.largest) {
      result.largest = result.y[k];
      result.axis = AxisPower::Axis::y;
      result.frequency = k;
    }
    result.largest_diagonal = std::max({result.largest_diagonal, result.diagonal[k], result.anti_diagonal[k]});
  }
  for (std::size_t k = 2 * reach; k >= 1; --k) result.expected_of_white_noise += 1 / static_cast<double>(k);
  return result;
}

}  // namespace abn::analysis
