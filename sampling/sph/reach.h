// How far a particle must look for neighbours in a size field.
#pragma once

#include <cstdint>

#include "sampling/grid.h"

namespace abn::sph {

/// Squares a side of the blocks of reach_by_block().
inline constexpr std::uint32_t reach_block = 2;

/// An upper bound of s wherever a particle inside a square between neighbouring cell centres of the periodic raster
/// `s` may interact with one: dilation of s by the support. One value per block of reach_block x reach_block squares,
/// from the upper left; the search looks from block to block, so it is a little too wide and never too narrow.
/// cell_x, cell_y: size of a cell; support: H [d].
Grid<float> reach_by_block(const Grid<float>& s, double cell_x, double cell_y, double support);

}  // namespace abn::sph
