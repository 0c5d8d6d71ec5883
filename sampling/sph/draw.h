// White points inside cells of equal mass: starts that have a given density and no long waves.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace abn::sph {

/// A position on the unit square [0,1)^2.
struct UnitPosition {
  double x = 0, y = 0;
};

/// `count` points of relative density `density` (u,v) >= 0 over the unit square. The square is walked along a Hilbert
/// curve, cut where the mass of `per_cell` points is reached, and every piece gets that many independent points: the
/// counterpart of coarse_cell_positions() for any density. `aspect` = width / height of what the square stands for, so
/// that the pieces are compact there. Throws ConfigError if the density is nowhere > 0, somewhere < 0 or not finite. It
/// is taken as constant in each of at least 65536 and at most 4 million rectangles.
std::vector<UnitPosition> draw_by_density(const std::function<double(double, double)>& density, double aspect,
                                          std::uint64_t count, std::uint64_t seed, double per_cell = 16);

}  // namespace abn::sph
