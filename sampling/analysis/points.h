// Points of the unit torus, which every measure of this folder takes.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "sampling/vec.h"

namespace abn::analysis {

/// A point of the unit torus [0,1)^2, in double: a frequency of thousands multiplies the rounding of a coordinate.
struct Point {
  double x = 0;
  double y = 0;
};

/// A view of points of one set; the caller keeps them.
using Points = std::span<const Point>;

/// `positions` [px] divided by the sides of `plane` (both >= 1), each side apart: a plane that is not square is
/// stretched. Positions outside the plane are wrapped; they must be finite.
inline std::vector<Point> to_unit(std::span<const Vec2f> positions, Extent plane) {
  const auto wrapped = [](double position, double length) {
    const double unit = position / length;
    const double rest = unit - std::floor(unit);
    return rest < 1 ? rest : 0.0;  // -1e-30 rounds up to 1
  };
  std::vector<Point> points;
  points.reserve(positions.size());
  for (const Vec2f p : positions) points.push_back({wrapped(p.x, plane.width), wrapped(p.y, plane.height)});
  return points;
}

}  // namespace abn::analysis
