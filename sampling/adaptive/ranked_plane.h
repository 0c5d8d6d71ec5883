// The stage of adaptive sampling that no image influences: a blue-noise plane, and in which order to spend it.
#pragma once

#include <cstdint>
#include <vector>

#include "sampling/sph/solver.h"
#include "sampling/vec.h"

namespace abn {

struct RankedPlaneOptions {
  sph::Boundary boundary = sph::Boundary::periodic;  // as `sph_blue_noise`; ghosts take twice the time
  int iterations = 25;                               // of the relaxation
  double per_cell = 16;                              // of the start, coarse_cell_positions()
};

struct RankedPlane {
  std::vector<Vec2f> position;  // [count] [px], inside the plane
  bool cached = false;          // whether it came from the disk
};

/// `count` (1 to 2^32 - 2) points of SPH blue noise over the plane, ordered such that the first k of them are spread
/// evenly for every k: what is evaluated first at any share of the budget. All together they are the points that
/// `sph_blue_noise` relaxes from the same start; the beginnings are subsets of them, farthest_first_order(), and so
/// less regular than points relaxed for their number would be (nearest neighbours .73 instead of .87 of the hexagonal
/// lattice's distance at a half, .77 at a quarter; smallest distance .60 to .65).
///
/// `solver` is the engine, null = CPU. With `use_cache` and the CPU engine, the points are looked up in the disk cache
/// and kept there, under a key of all arguments and of a small plane made in the same way: if the method changes, or a
/// machine computes something else, so does the key. Throws ConfigError as the engine does.
RankedPlane ranked_plane(Extent plane, std::uint64_t count, std::uint64_t seed, const RankedPlaneOptions& options,
                         bool use_cache, const sph::SolverFactory& solver = nullptr);

}  // namespace abn
