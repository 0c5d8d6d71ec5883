// The distance test of every Poisson-disk method: points on a torus, no two closer than a radius.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sampling/rng.h"
#include "sampling/vec.h"

namespace abn {

/// More points than this would need more than 12 GB; the strategies refuse a larger budget.
inline constexpr std::uint64_t max_disk_points = 1U << 28;

/// Uniform on [0, length) with 32 bits, rounded to float [px].
inline float uniform_position(Rng& rng, std::uint32_t length) {
  const double position = rng.next() * 0x1p-32 * static_cast<double>(length);
  return place(0.0F, static_cast<float>(position), static_cast<float>(length));
}

/// Squared distance of two positions on the torus [px^2]: opposite sides of the plane are joined.
inline double torus_distance_squared(Vec2f a, Vec2f b, double width, double height) {
  const double direct_x = std::abs(static_cast<double>(a.x) - static_cast<double>(b.x));
  const double direct_y = std::abs(static_cast<double>(a.y) - static_cast<double>(b.y));
  const double dx = std::fmin(direct_x, width - direct_x);
  const double dy = std::fmin(direct_y, height - direct_y);
  return dx * dx + dy * dy;
}

/// The distance [px] against which "relative radius" is measured: the largest that `count` points can keep from each
/// other. On a plane wide enough that is the hexagonal lattice's, sqrt(2 area / (sqrt(3) count)) (Lagae & Dutre 2008);
/// on a plane so narrow that the points line up, its longer side / count.
double reference_radius(Extent plane, std::uint64_t count);

/// Points [px] of which no two are closer than radius() on the torus, in cells that hold one point each, so that the
/// question whether another one fits costs constant time. The test is made on the float positions as stored, in double:
/// whatever measures them afterwards finds the radius kept.
class DiskGrid {
 public:
  /// `radius` > 0 [px]; cells take about 16 area / radius^2 bytes.
  DiskGrid(Extent plane, double radius);

  /// Adds `point` (inside the plane) if it keeps the distance from all others; tells whether it did.
  bool try_add(Vec2f point);
  /// From now on points may be as close as `radius` [px], at most the present radius; 0 lets every point in.
  void lower_radius(double radius);

  double radius() const { return radius_; }
  const std::vector<Vec2f>& points() const { return points_; }
  /// Hands the points over; the grid is spent.
  std::vector<Vec2f> take_points() { return std::move(points_); }

 private:
  struct Axis {
    double length = 1;  // [px]
    double cells_per_px = 1;
    std::int32_t cells = 1;
    std::int32_t reach = 0;  // how many cells away a point too close may be
    std::int32_t cell_of(float position) const;
  };

  static Axis make_axis(double length, double radius);
  void build_cells();
  bool fits_inside(Vec2f point, std::int32_t cell_x, std::int32_t cell_y) const;
  bool fits_across_border(Vec2f point, std::int32_t cell_x, std::int32_t cell_y) const;
  std::size_t cell_index(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(x_.cells) + static_cast<std::size_t>(x);
  }

  double radius_;
  double squared_ = 0;  // smallest admitted squared distance
  Axis x_;
  Axis y_;
  std::vector<Vec2f> points_;
  std::vector<Vec2f> cells_;                // the point in each cell; x < 0: none
  std::vector<std::ptrdiff_t> neighbours_;  // cell index differences, nearest first; for cells away from the border
};

}  // namespace abn
