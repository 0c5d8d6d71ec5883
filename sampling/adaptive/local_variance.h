// How much the integrand varies from place to place, estimated from the samples: what an adaptive plane follows.
#pragma once

#include <cstdint>
#include <span>

#include "sampling/grid.h"
#include "sampling/vec.h"

namespace abn {

/// The variance of the `neighbours` samples nearest to each cell's centre of a raster over the plane.
///
/// `position` [px], [n], inside the plane; `value` [n * channels], finite; `map` is the raster's size, usually finer
/// than the pixels (two cells per pixel side adapt better than one, even than the true variance per pixel);
/// 1 <= neighbours <= 32. With several channels the mean of their variances.
///
/// Sum of squared deviations over n - 1, in double around the mean: exactly 0 for equal values, and at most 1e36,
/// whatever the values. Fewer samples than `neighbours` all count; one sample or none has variance 0. Samples equally
/// far are taken by index. The result does not depend on the number of threads.
Grid<float> local_variance(std::span<const Vec2f> position, std::span<const float> value, std::uint32_t channels,
                           Extent plane, Extent map, int neighbours = 8);

/// Smooths `map` by 1-2-1 in both directions, `passes` >= 0 times, mirrored at the border; a constant stays the same to
/// the bit.
void blur(Grid<float>& map, int passes);

}  // namespace abn
