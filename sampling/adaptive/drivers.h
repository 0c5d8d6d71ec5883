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

/// At least 1 and in all `count` points in every pixel, their numbers by `density` [1/px^2] and seeded systematic
/// rounding, inside a pixel the first points of an Owen-scrambled Sobol sequence with its own seed: each is uniform in
/// its pixel whatever the others are, so that the mean of a pixel has no bias. Precondition: count >= plane.area().
std::vector<Vec2f> draw_per_pixel(const Grid<float>& density, std::uint64_t count, Extent plane, std::uint64_t seed);

}  // namespace abn
