#include "sampling/sph/draw.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "sampling/error.h"
#include "sampling/fixed_prefix.h"

namespace abn::sph {

DrawCells::DrawCells(double aspect, std::uint64_t count) : wide_(aspect >= 1) {
  const int squares_log2 = std::clamp(static_cast<int>(std::lround(std::log2(wide_ ? aspect : 1 / aspect))), 0, 20);
  const double wanted = std::clamp(4.0 * static_cast<double>(count), 65536.0, 4194304.0);
  level_ = static_cast<unsigned>(std::max(0L, std::lround((std::log2(wanted) - squares_log2) / 2)));
  squares_ = std::uint64_t{1} << static_cast<unsigned>(squares_log2);
  const auto side = std::uint64_t{1} << level_;
  cell_along_ = 1.0 / static_cast<double>(side * squares_);
  cell_across_ = 1.0 / static_cast<double>(side);
}

std::vector<UnitPosition> draw_by_density(const std::function<double(double, double)>& density, double aspect,
                                          std::uint64_t count, std::uint64_t seed, double per_cell) {
  const DrawCells cells(aspect, count);
  std::vector<double> masses;
  std::vector<Vec2f> corners;
  masses.reserve(cells.size());
  corners.reserve(cells.size());
  cells.for_each_corner([&](UnitPosition corner) {
    const UnitPosition centre = cells.centre(corner);
    const double mass = density(centre.x, centre.y);
    if (mass < 0) throw ConfigError("density: " + std::to_string(mass) + " is below 0; every value must be >= 0");
    masses.push_back(mass);
    corners.push_back(corner.rounded());
  });
  const std::vector<double> before = fixed_order_prefix(masses);
  const double total = before.back();
  if (!(total > 0 && std::isfinite(total))) {
    throw ConfigError("density: it sums to " + std::to_string(total) +
                      "; every value must be finite and >= 0, and some above 0");
  }

  // Point i is placed at mass (its piece's start + a random share of the piece); the pieces are walked in order.
  const double scale = total / static_cast<double>(count);
  const auto piece = static_cast<std::uint64_t>(std::max(1.0, std::round(per_cell)));
  std::vector<UnitPosition> points;
  points.reserve(count);
  std::vector<double> at;
  std::uint64_t cell = 0;
  for (std::uint64_t first = 0; first < count; first += piece) {
    const std::uint64_t here = std::min(piece, count - first);
    at.clear();
    for (std::uint64_t k = 0; k < here; ++k) at.push_back(drawn_mass(seed, first + k, first, here, scale));
    std::sort(at.begin(), at.end());
    for (const double mass : at) {
      cell = cell_of_mass(before.data(), cells.size(), mass, cell);
      points.push_back(cells.place(corners[cell], seed, points.size()));
    }
  }
  return points;
}

}  // namespace abn::sph
