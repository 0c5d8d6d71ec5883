// An order of given points in which every beginning is spread evenly.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sampling/vec.h"

namespace abn {

/// The indices of `position` (inside the plane [px]) such that the first k of them are far apart from each other for
/// every k: each is, to 1.6 %, the farthest one from all before it (Gonzalez 1985; on images Eldar et al. 1997, "The
/// farthest point strategy"). No two of the first k are then closer than every other point is to one of them. Distances
/// are those of the torus, also for a plane with walls: without a neighbour beyond the wall, points at it would always
/// be among the first. `seed` chooses the first one and between equals.
///
/// Points wait in one list per 1/32 octave of the squared distance, and move down when it is their turn and their
/// distance has shrunk; the work is proportional to n log n.
std::vector<std::uint32_t> farthest_first_order(std::span<const Vec2f> position, Extent plane, std::uint64_t seed);

}  // namespace abn
