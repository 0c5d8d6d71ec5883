// What the density of an adaptive plane can follow beside the variance.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sampling/grid.h"
#include "sampling/vec.h"

namespace abn {

/// The samples' mean over channels as a raster over the plane: every cell the mean of the samples around it, weighted
/// by a bell some `reach` cells wide that widens where there are none. `position` [px], `value` [n * channels], finite.
Grid<float> local_mean(std::span<const Vec2f> position, std::span<const float> value, std::uint32_t channels,
                       Extent plane, Extent map, int reach);

/// The squared gradient of a raster [1/cell^2], by central differences.
Grid<float> squared_gradient(const Grid<float>& map);

/// ((1 - share) a^e / mean a^e + share b^e / mean b^e)^(1/e) per cell: the driver by which that share of the density
/// goes where b would have it and the rest where a would, where density grows with driver^e. Values >= 0; one that is 0
/// everywhere counts for nothing. Precondition: equal sizes, e > 0, share in [0, 1].
Grid<float> both_drivers(const Grid<float>& a, const Grid<float>& b, double exponent, double share);

/// At least 1 and in all `count` points in every pixel, their numbers by `density` [1/px^2] and seeded systematic
/// rounding, inside a pixel the first points of an Owen-scrambled Sobol sequence with its own seed: each is uniform in
/// its pixel whatever the others are, so that the mean of a pixel has no bias. Precondition: count >= plane.area().
std::vector<Vec2f> draw_per_pixel(const Grid<float>& density, std::uint64_t count, Extent plane, std::uint64_t seed);

}  // namespace abn
