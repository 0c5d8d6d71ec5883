#include "sampling/disk_grid.h"

#include <algorithm>
#include <cassert>
#include <numbers>
#include <utility>

namespace abn {
namespace {

constexpr Vec2f no_point{-1.0F, -1.0F};

}  // namespace

double reference_radius(Extent plane, std::uint64_t count) {
  const double n = static_cast<double>(std::max<std::uint64_t>(count, 1));
  const double hexagonal = std::sqrt(2.0 * static_cast<double>(plane.area()) / (std::numbers::sqrt3 * n));
  return std::max(hexagonal, static_cast<double>(std::max(plane.width, plane.height)) / n);
}

DiskGrid::Axis DiskGrid::make_axis(double length, double radius) {
  Axis axis;
  axis.length = length;
  // A little narrower than radius / sqrt(2): two points of one cell are then closer than the radius however their cell
  // numbers were rounded, and a cell holds one point at most.
  const double cells = std::floor(length / (0.999 * radius / std::numbers::sqrt2)) + 1.0;
  assert(cells < 2147483648.0);  // 5.7 max_disk_points at the lowest relative radius, on the narrowest plane
  axis.cells = static_cast<std::int32_t>(cells);
  axis.cells_per_px = static_cast<double>(axis.cells) / length;
  // The 1e-9: a cell number may have been rounded across a border.
  axis.reach = static_cast<std::int32_t>(std::min(std::ceil(radius * axis.cells_per_px + 1e-9), cells));
  return axis;
}

std::int32_t DiskGrid::Axis::cell_of(float position) const {
  return std::min(static_cast<std::int32_t>(static_cast<double>(position) * cells_per_px), cells - 1);
}

DiskGrid::DiskGrid(Extent plane, double radius) : radius_(radius) {
  assert(plane.area() > 0 && radius > 0);
  x_.length = plane.width;
  y_.length = plane.height;
  build_cells();
}

void DiskGrid::lower_radius(double radius) {
  assert(radius >= 0 && radius <= radius_);
  radius_ = radius;
  build_cells();
}

void DiskGrid::build_cells() {
  // A hair above radius^2, so that the square root of an admitted squared distance is never below the radius.
  squared_ = radius_ * radius_ * (1.0 + 0x1p-50);
  cells_.clear();
  neighbours_.clear();
  if (radius_ == 0) return;

  x_ = make_axis(x_.length, radius_);
  y_ = make_axis(y_.length, radius_);
  cells_.assign(static_cast<std::size_t>(x_.cells) * static_cast<std::size_t>(y_.cells), no_point);
  for (const Vec2f point : points_) cells_[cell_index(x_.cell_of(point.x), y_.cell_of(point.y))] = point;

  // Most candidates fail, and most of those at a near cell: nearest first finds out early.
  if (x_.cells <= 2 * x_.reach || y_.cells <= 2 * y_.reach) return;
  std::vector<std::pair<double, std::ptrdiff_t>> order;
  for (std::int32_t dy = -y_.reach; dy <= y_.reach; ++dy) {
    for (std::int32_t dx = -x_.reach; dx <= x_.reach; ++dx) {
      const double away_x = dx / x_.cells_per_px;
      const double away_y = dy / y_.cells_per_px;
      order.emplace_back(away_x * away_x + away_y * away_y, std::ptrdiff_t{dy} * x_.cells + dx);
    }
  }
  std::sort(order.begin(), order.end());
  for (const auto& [distance, difference] : order) neighbours_.push_back(difference);
}

bool DiskGrid::fits_inside(Vec2f point, std::int32_t cell_x, std::int32_t cell_y) const {
  const Vec2f* const centre = cells_.data() + cell_index(cell_x, cell_y);
  for (const std::ptrdiff_t difference : neighbours_) {
    const Vec2f other = centre[difference];
    if (other.x < 0) continue;
    const double dx = static_cast<double>(point.x) - static_cast<double>(other.x);
    const double dy = static_cast<double>(point.y) - static_cast<double>(other.y);
    if (dx * dx + dy * dy < squared_) return false;
  }
  return true;
}

bool DiskGrid::fits_across_border(Vec2f point, std::int32_t cell_x, std::int32_t cell_y) const {
  // Each row and column of cells once, even where the plane is narrower than the reach.
  const std::int32_t columns = std::min(2 * x_.reach + 1, x_.cells);
  const std::int32_t rows = std::min(2 * y_.reach + 1, y_.cells);
  const std::int32_t first_x = ((cell_x - x_.reach) % x_.cells + x_.cells) % x_.cells;
  const std::int32_t first_y = ((cell_y - y_.reach) % y_.cells + y_.cells) % y_.cells;
  for (std::int32_t row = 0, y = first_y; row < rows; ++row, y = y + 1 == y_.cells ? 0 : y + 1) {
    for (std::int32_t column = 0, x = first_x; column < columns; ++column, x = x + 1 == x_.cells ? 0 : x + 1) {
      const Vec2f other = cells_[cell_index(x, y)];
      if (other.x >= 0 && torus_distance_squared(point, other, x_.length, y_.length) < squared_) return false;
    }
  }
  return true;
}

bool DiskGrid::try_add(Vec2f point) {
  assert(point.x >= 0 && point.x < x_.length && point.y >= 0 && point.y < y_.length);
  if (radius_ > 0) {
    const std::int32_t cell_x = x_.cell_of(point.x);
    const std::int32_t cell_y = y_.cell_of(point.y);
    const bool inside = cell_x >= x_.reach && cell_x < x_.cells - x_.reach &&  //
                        cell_y >= y_.reach && cell_y < y_.cells - y_.reach;
    if (!(inside ? fits_inside(point, cell_x, cell_y) : fits_across_border(point, cell_x, cell_y))) return false;
    cells_[cell_index(cell_x, cell_y)] = point;
  }
  points_.push_back(point);
  return true;
}

}  // namespace abn
