// Where the strategies begin that relax all samples of the plane together.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sampling/params.h"
#include "sampling/vec.h"

namespace abn {

/// First positions [px], inside the plane: `white`, `coarse_cells` (coarse_cell_positions()), `sobol_owen` or `jitter`
/// (the strategies sobol_owen and jitter_plane over the whole plane). Relaxation moves mass over short distances only,
/// so that the start decides the long waves of the result, and a lattice in the start stays: coarse cells have neither.
/// No two positions coincide up to the resolution of float: every one is moved by up to a thousandth of the spacing
/// sqrt(area/count), because coincident points exert no force on each other and have no cells of their own.
std::vector<Vec2f> relaxation_start(std::string_view start, Extent plane, std::uint64_t count, std::uint64_t seed);

/// Moves every position by up to a thousandth of the spacing sqrt(area/count), or, where float is coarser than that,
/// by up to four of its steps; on the torus. A pure function of the seed and the index.
void separate_coincident(std::vector<Vec2f>& positions, Extent plane, std::uint64_t seed);

/// x [px] wrapped into [0,length) as a float; any finite x.
float wrap_to_plane(double x, std::uint32_t length);

/// Throws ConfigError if `strategy` cannot hold `budget` points: fewer than 1 or more than `most`.
void require_budget(std::string_view strategy, std::uint64_t budget, std::uint64_t most);

/// The `start` parameter of these strategies.
template <class P>
Field<P> start_field() {
  Field<P> field{"start", &P::start, "first positions; coarse_cells: white inside cells of 16 samples"};
  field.choices = {"coarse_cells", "white", "sobol_owen", "jitter"};
  return field;
}

}  // namespace abn
