// Discrepancies: how far the share of points in boxes is from the boxes' area.
//
// All are of points of the unit square. The L2 discrepancies are given as roots, comparable with each other and with
// the star discrepancy; SciPy's `qmc.discrepancy` returns the root for "L2-star" but the square for "CD" (centred) and
// "WD" (wrap-around).
#pragma once

#include <cstddef>

#include "sampling/analysis/points.h"

namespace abn::analysis {

/// The largest set for star_discrepancy(): its time grows with the square of the number of points.
inline constexpr std::size_t max_star_discrepancy_points = 16384;

/// The star discrepancy, the largest |share of points - area| over boxes from the origin, open and closed: exact.
/// Throws ConfigError for an empty set and for more than max_star_discrepancy_points.
double star_discrepancy(Points points);

/// Roots of mean squared differences of share and area over a class of boxes.
struct L2Discrepancies {
  double star = 0;         // boxes from the origin (Warnock 1972)
  double centred = 0;      // boxes from the nearest corner, and its projections (Hickernell 1998)
  double wraparound = 0;   // boxes anywhere on the torus, and its projections (Hickernell 1998): shifts do not matter
  double generalised = 0;  // boxes from the origin, and their projections (Hickernell 1998, "modified L2-star")
  double unanchored = 0;   // boxes anywhere in the square (Morokoff & Caflisch 1994)
  double symmetric = 0;    // unions of boxes from the corners, by parity, and their projections (Hickernell 1998)
};

/// All L2 discrepancies by Warnock's sums over all pairs; the time grows with the square of the number of points
/// (about 2 ns a pair and core). A root below about 1e-8 is rounding. Throws ConfigError for an empty set.
L2Discrepancies l2_discrepancies(Points points);

}  // namespace abn::analysis
