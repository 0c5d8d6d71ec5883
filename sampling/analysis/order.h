// How crystalline a point set is, and how well it covers the torus: measures from its Voronoi cells.
#pragma once

#include "sampling/analysis/points.h"

namespace abn::analysis {

/// Over all points that own a cell (of coincident points, one); the unit of length is hexagonal_spacing(count).
///
/// For orientation, psi_6 of a point is the mean of exp(6 i angle) over the directions to its neighbours across Voronoi
/// edges (Halperin & Nelson 1978); edges shorter than 1e-9 are left out, because four points on a circle make one by
/// rounding alone.
struct BondOrder {
  double local_order = 0;  // mean of |psi_6|: 1 on the hexagonal lattice, 0.36 in white noise
  double global_order =
      0;  // |mean of psi_6|: 1 if all crystals have one orientation, about 0.5 / sqrt(count) in a liquid
  double six_valent = 0;       // share of points with six neighbours: the crystallisation alarm; 0.295 in white noise
  double coverage_radius = 0;  // radius of the largest empty circle; 1/sqrt(3) on the hexagonal lattice
};

/// Measures `points`. Throws ConfigError for an empty set.
BondOrder bond_order(Points points);

}  // namespace abn::analysis
