// How far a particle must look for neighbours in a size field.
#pragma once

#include <cstdint>

#include "sampling/grid.h"
#include "sampling/hd.h"

namespace abn::sph {

/// Squares a side of the blocks of reach_by_block().
inline constexpr std::uint32_t reach_block = 2;
/// Blocks a side of the coarser blocks that bound how far the finer ones have to look.
inline constexpr std::uint32_t reach_factor = 4;

/// Blocks of `side` squares along one axis of a torus of `squares`, each `cell` [d] long; the last may be narrower.
struct BlockAxis {
  std::uint32_t count = 1, side = 1, squares = 1;
  double cell = 1;

  /// Calls f(index, squared gap [d^2]) for `block` and those that are closer to it than `radius` [d]; some twice. Once
  /// around the torus in both directions meets the nearest image of every block.
  template <class F>
  ABN_HD void for_each_near(std::uint32_t block, double radius, const F& f) const {
    f(block, 0.0);
    std::uint32_t i = block;
    std::int64_t image = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
      if (++i == count) {
        i = 0;
        image = squares;
      }
      const double gap = static_cast<double>(begin(i) + image - end(block)) * cell;
      if (gap >= radius) break;
      f(i, gap * gap);
    }
    i = block;
    image = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
      if (i-- == 0) {
        i = count - 1;
        image = squares;
      }
      const double gap = static_cast<double>(begin(block) + image - end(i)) * cell;
      if (gap >= radius) break;
      f(i, gap * gap);
    }
  }

 private:
  ABN_HD std::int64_t begin(std::uint32_t block) const { return std::int64_t{block} * side; }
  ABN_HD std::int64_t end(std::uint32_t block) const {
    const std::int64_t last = begin(block) + side;
    return last < std::int64_t{squares} ? last : std::int64_t{squares};
  }
};

/// How far apart two blocks may be, and how far one has to look: a little more than the distance, so that rounding
/// never hides a neighbour.
ABN_HD inline double reach_distance(double half_support, float own, float there) {
  return half_support * (1 + 1e-6) * (static_cast<double>(own) + static_cast<double>(there));
}

/// An upper bound of s wherever a particle inside a square between neighbouring cell centres of the periodic raster
/// `s` may interact with one: dilation of s by the support. One value per block of reach_block x reach_block squares,
/// from the upper left; the search looks from block to block, so it is a little too wide and never too narrow.
/// cell_x, cell_y: size of a cell; support: H [d].
Grid<float> reach_by_block(const Grid<float>& s, double cell_x, double cell_y, double support);

}  // namespace abn::sph
