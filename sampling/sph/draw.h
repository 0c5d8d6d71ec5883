// White points inside cells of equal mass: starts that have a given density and no long waves.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "sampling/hd.h"
#include "sampling/rng.h"
#include "sampling/vec.h"

namespace abn::sph {

/// A position on the unit square [0,1)^2.
struct UnitPosition {
  double x = 0, y = 0;
  ABN_HD Vec2f rounded() const { return {static_cast<float>(x), static_cast<float>(y)}; }
};

/// `count` points of relative density `density` (u,v) >= 0 over the unit square. The square is walked along a Hilbert
/// curve, cut where the mass of `per_cell` points is reached, and every piece gets that many independent points: the
/// counterpart of coarse_cell_positions() for any density. `aspect` = width / height of what the square stands for, so
/// that the pieces are compact there. Throws ConfigError if the density is nowhere > 0, somewhere < 0 or not finite. It
/// is taken as constant in each of at least 65536 and at most 4 million rectangles.
std::vector<UnitPosition> draw_by_density(const std::function<double(double, double)>& density, double aspect,
                                          std::uint64_t count, std::uint64_t seed, double per_cell = 16);

/// Those rectangles, numbered along the curve; and the parts of the drawing, for host and device.
class DrawCells {
 public:
  /// For `count` points.
  DrawCells(double aspect, std::uint64_t count);

  std::uint64_t size() const { return squares_ << (2 * level_); }
  /// The upper left corner of a rectangle.
  ABN_HD UnitPosition corner(std::uint64_t cell) const {
    // From the smallest square of the curve the cell lies in to the largest: two bits of its number say which quarter
    // it is of the next.
    std::uint64_t quarters = cell;
    std::uint32_t x = 0;
    std::uint32_t y = 0;
    for (unsigned level = 0; level < level_; ++level, quarters >>= 2U) {
      const std::uint32_t half = 1U << level;
      const std::uint32_t right = static_cast<std::uint32_t>(quarters >> 1U) & 1U;
      const std::uint32_t below = static_cast<std::uint32_t>(quarters ^ (quarters >> 1U)) & 1U;
      // The first quarter and the last one are turned, and the last one is walked back.
      const std::uint32_t back = (half - 1) & (0U - (right & (1U ^ below)));
      const std::uint32_t turn = (x ^ y) & (0U - (1U ^ below));
      x = (x ^ back ^ turn) | (half & (0U - right));
      y = (y ^ back ^ turn) | (half & (0U - below));
    }
    return corner_at(quarters, x, y);
  }
  /// Calls f(corner) for all of them in their order, which is faster.
  template <class F>
  void for_each_corner(const F& f) const {
    for (std::uint64_t square = 0; square < squares_; ++square) {
      along_curve(level_, 0, 0, 1, 0, 0, 1,
                  [&](std::int64_t column, std::int64_t row) { f(corner_at(square, column, row)); });
    }
  }
  ABN_HD UnitPosition centre(UnitPosition corner) const {
    return {corner.x + 0.5 * width(), corner.y + 0.5 * height()};
  }
  /// A random place in a rectangle for point `number`.
  ABN_HD UnitPosition place(Vec2f corner, std::uint64_t seed, std::uint64_t number) const {
    constexpr std::uint32_t stream = stream_id("place of a drawn point");
    const Vec2f unit = Rng(seed, stream, number).uniform2();
    return {static_cast<double>(corner.x) + static_cast<double>(unit.x) * width(),
            static_cast<double>(corner.y) + static_cast<double>(unit.y) * height()};
  }

 private:
  /// Calls f(column, row) for the cells of a 2^level square along a Hilbert curve from the upper left to the upper
  /// right corner. (a) is the curve's first direction, (b) the other one, unit steps.
  template <class F>
  static void along_curve(unsigned level, std::int64_t x, std::int64_t y, std::int64_t ax, std::int64_t ay,
                          std::int64_t bx, std::int64_t by, const F& f) {
    if (level == 0) {
      f(x, y);
      return;
    }
    const std::int64_t half = std::int64_t{1} << (level - 1);
    along_curve(level - 1, x, y, bx, by, ax, ay, f);
    along_curve(level - 1, x + half * bx, y + half * by, ax, ay, bx, by, f);
    along_curve(level - 1, x + half * (ax + bx), y + half * (ay + by), ax, ay, bx, by, f);
    // The last quarter is walked from its far corner back.
    along_curve(level - 1, x + (2 * half - 1) * ax + (half - 1) * bx, y + (2 * half - 1) * ay + (half - 1) * by, -bx,
                -by, -ax, -ay, f);
  }
  ABN_HD UnitPosition corner_at(std::uint64_t square, std::int64_t column, std::int64_t row) const {
    const double along = static_cast<double>((static_cast<std::int64_t>(square) << level_) + column) * cell_along_;
    const double across = static_cast<double>(row) * cell_across_;
    return {wide_ ? along : across, wide_ ? across : along};
  }
  ABN_HD double width() const { return wide_ ? cell_along_ : cell_across_; }
  ABN_HD double height() const { return wide_ ? cell_across_ : cell_along_; }

  bool wide_;
  unsigned level_;         // squares of 2^level cells a side, side by side along the longer side
  std::uint64_t squares_;  // a power of two
  double cell_along_, cell_across_;
};

/// The mass at which point `number` lies: anywhere in its piece of `count` points from `first` on. scale: the mass of a
/// point.
ABN_HD inline double drawn_mass(std::uint64_t seed, std::uint64_t number, std::uint64_t first, std::uint64_t count,
                                double scale) {
  constexpr std::uint32_t stream = stream_id("mass of a drawn point");
  const auto share = static_cast<double>(Rng(seed, stream, number).uniform());
  return (static_cast<double>(first) + share * static_cast<double>(count)) * scale;
}

/// The cell among `cells` at `mass`, at or after `first`, where it is known to be. before [cells+1]: the mass before
/// each of them, of all at the end.
ABN_HD inline std::uint64_t cell_of_mass(const double* before, std::uint64_t cells, double mass, std::uint64_t first) {
  // The first one behind which there is more, searched in steps that double, then by halves: mostly it is near.
  std::uint64_t low = first;
  std::uint64_t high = first;
  for (std::uint64_t step = 1; high < cells && before[high + 1] <= mass; step *= 2) {
    low = high + 1;
    high = low + step < cells ? low + step : cells;
  }
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (before[middle + 1] <= mass) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  if (low >= cells) low = cells - 1;
  while (low > 0 && !(before[low + 1] > before[low])) --low;  // rounding at the very end: never into empty land
  return low;
}

}  // namespace abn::sph
