// How a budget is shared out over the plane, and how points are drawn where samples are missing.
#pragma once

#include <cstdint>
#include <vector>

#include "sampling/grid.h"
#include "sampling/vec.h"

namespace abn {

/// (driver + floor * mean driver)^exponent per cell: what density shall be proportional to. Values >= 0.
Grid<float> density_weights(const Grid<float>& driver, double floor, double exponent);

/// Densities [samples/px^2] per cell of a map over `plane`: proportional to `weight` >= 0, but never less than what
/// `have` says is there already and never more than `most`, so that they add up to `total` samples (water-filling). If
/// `total` does not fit under `most`, every cell has that; if it is less than what is there, `have` is returned.
/// Precondition: equal sizes.
Grid<float> allocate(const Grid<float>& weight, const Grid<float>& have, double total, double most, Extent plane);

/// Samples under a density map over `plane`.
double samples_of(const Grid<float>& density, Extent plane);

/// (mean of sqrt V)^2 / mean V in (0,1]: the error variance that the best allocation of independent samples has left,
/// relative to a uniform one. 1 for V = 0 everywhere: nothing to adapt to.
double uniform_share(const Grid<float>& variance);

/// `count` points, white inside the cells of the map, cell by cell in proportion to max(0, wanted - have), by running
/// rounding along strips, so that every compact region has its share within a few points. Where nothing is wanted
/// anywhere: uniformly. Positions [px], inside the plane.
std::vector<Vec2f> draw_deficit(const Grid<float>& wanted, const Grid<float>& have, std::uint64_t count, Extent plane,
                                std::uint64_t seed, std::uint32_t stream);

}  // namespace abn
