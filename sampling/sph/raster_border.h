// Cells beyond the border of a raster.
#pragma once

#include <cstdint>

#include "sampling/hd.h"

namespace abn::sph {

/// Index in [0,count) of cell i of an endless row: repeated, or mirrored (which for the neighbour of a border cell is
/// the border cell itself).
ABN_HD inline std::uint32_t beyond_border(std::int64_t i, std::uint32_t count, bool periodic) {
  if (count <= 1) return 0;
  const std::int64_t n = count;
  if (i >= 0 && i < n) return static_cast<std::uint32_t>(i);  // mostly; a division is slow
  if (periodic) return static_cast<std::uint32_t>(((i % n) + n) % n);
  const std::int64_t folded = ((i % (2 * n)) + 2 * n) % (2 * n);
  return static_cast<std::uint32_t>(folded < n ? folded : 2 * n - 1 - folded);
}

}  // namespace abn::sph
