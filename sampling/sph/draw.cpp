#include "sampling/sph/draw.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::sph {
namespace {

/// Calls f(column, row) for the cells of a 2^level square along a Hilbert curve from the upper left to the upper right
/// corner. (a) is the curve's first direction, (b) the other one.
template <class F>
void along_hilbert_curve(int level, std::int64_t x, std::int64_t y, std::int64_t ax, std::int64_t ay, std::int64_t bx,
                         std::int64_t by, const F& f) {
  if (level == 0) {
    f(x, y);
    return;
  }
  // (ax,ay) and (bx,by) are unit directions; half a side is 2^(level-1) cells.
  const std::int64_t half = std::int64_t{1} << (level - 1);
  along_hilbert_curve(level - 1, x, y, bx, by, ax, ay, f);
  along_hilbert_curve(level - 1, x + half * bx, y + half * by, ax, ay, bx, by, f);
  along_hilbert_curve(level - 1, x + half * (ax + bx), y + half * (ay + by), ax, ay, bx, by, f);
  // The last quarter is walked from its far corner back.
  along_hilbert_curve(level - 1, x + (2 * half - 1) * ax + (half - 1) * bx, y + (2 * half - 1) * ay + (half - 1) * by,
                      -bx, -by, -ax, -ay, f);
}

}  // namespace

std::vector<UnitPosition> draw_by_density(const std::function<double(double, double)>& density, double aspect,
                                          std::uint64_t count, std::uint64_t seed, double per_cell) {
  const bool wide = aspect >= 1;
  // Squares of 2^level cells a side, side by side along the longer side.
  const int squares_log2 = std::clamp(static_cast<int>(std::lround(std::log2(wide ? aspect : 1 / aspect))), 0, 20);
  const double wanted = std::clamp(4.0 * static_cast<double>(count), 65536.0, 4194304.0);
  const int level = std::max(0, static_cast<int>(std::lround((std::log2(wanted) - squares_log2) / 2)));
  const std::int64_t side = std::int64_t{1} << level;
  const std::int64_t squares = std::int64_t{1} << squares_log2;
  const double cell_along = 1.0 / static_cast<double>(side * squares);
  const double cell_across = 1.0 / static_cast<double>(side);

  struct Cell {
    float x, y;
    double mass;
  };
  std::vector<Cell> cells;
  cells.reserve(static_cast<std::size_t>(side * side * squares));
  double total = 0;
  for (std::int64_t square = 0; square < squares; ++square) {
    along_hilbert_curve(level, 0, 0, 1, 0, 0, 1, [&](std::int64_t column, std::int64_t row) {
      const double along = static_cast<double>(square * side + column) * cell_along;
      const double across = static_cast<double>(row) * cell_across;
      const double x = wide ? along : across;
      const double y = wide ? across : along;
      const double mass =
          density(x + 0.5 * (wide ? cell_along : cell_across), y + 0.5 * (wide ? cell_across : cell_along));
      if (mass < 0) throw ConfigError("density: " + std::to_string(mass) + " is below 0; every value must be >= 0");
      total += mass;
      cells.push_back({static_cast<float>(x), static_cast<float>(y), mass});
    });
  }
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
  std::size_t cell = 0;
  double before = 0;  // mass of all cells before `cell`
  for (std::uint64_t first = 0; first < count; first += piece) {
    const std::uint64_t here = std::min(piece, count - first);
    at.clear();
    for (std::uint64_t k = 0; k < here; ++k) {
      const double u = double{Rng(seed, stream_id("mass of a drawn point"), first + k).uniform()};
      at.push_back((static_cast<double>(first) + u * static_cast<double>(here)) * scale);
    }
    std::sort(at.begin(), at.end());
    for (const double mass : at) {
      while (cell + 1 < cells.size() && before + cells[cell].mass <= mass) before += cells[cell++].mass;
      while (cell > 0 && !(cells[cell].mass > 0)) --cell;  // rounding at the very end: never into empty land
      Rng rng(seed, stream_id("place of a drawn point"), points.size());
      const Vec2f unit = rng.uniform2();
      points.push_back({double{cells[cell].x} + double{unit.x} * (wide ? cell_along : cell_across),
                        double{cells[cell].y} + double{unit.y} * (wide ? cell_across : cell_along)});
    }
  }
  return points;
}

}  // namespace abn::sph
