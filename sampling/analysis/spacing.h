// Distances of nearest neighbours on the torus, relative to those of the hexagonal lattice.
//
// The smallest of them is the relative radius rho of Lagae & Dutre (2008, "A comparison of methods for generating
// Poisson disk distributions"): about 0.01 for white noise of thousands of points, 0.65 to 0.85 for good Poisson-disk
// sets, 1 for the hexagonal lattice.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sampling/analysis/points.h"

namespace abn::analysis {

/// The largest distance `count` >= 1 points of the unit torus can keep from each other, r_max = sqrt(2 / (sqrt(3)
/// count)): the hexagonal lattice's (which fits the torus for no count exactly).
double hexagonal_spacing(std::size_t count);

/// All distances are relative to hexagonal_spacing(count).
struct Spacing {
  std::vector<double> nearest;  // [count] from each point to the nearest other one
  double smallest = 0;          // the relative radius
  double mean = 0;
  double quantile_01 = 0;  // the smallest distance that at least 1 % of the points have or fall below
  double median = 0;       // the same for 50 %
};

/// Measures `points`; a single point has its own image as neighbour, coincident points have distance 0.
///
/// `local_spacing` [count], all > 0, is for adaptive sets: the spacing the set should have at each point, in any unit
/// (the root of the inverse density). The distance of a pair is then divided by the mean of its two values, scaled such
/// that their mean square is 1, so that the points' shares of area fill the torus: an ideal adaptive set measures like
/// an ideal uniform one. "Nearest" is nearest by that distance.
///
/// Exact for any clustering; the time is proportional to the number of points where densities differ by less than about
/// 1 : 1000. Throws ConfigError for an empty set, or a local spacing of another length, not finite or not positive.
Spacing spacing(Points points, std::span<const double> local_spacing = {});

}  // namespace abn::analysis
