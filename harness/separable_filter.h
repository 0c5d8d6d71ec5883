// Correlation of a raster with a one-dimensional kernel along its rows or columns.
#pragma once

#include <cstddef>
#include <span>

#include "sampling/grid.h"

namespace abn::harness {

/// Rasters of fewer pixels are not worth the waking of threads.
inline constexpr std::size_t smallest_parallel_raster = 65536;

/// Correlates every row with an odd-length kernel [taps]; beyond the border the nearest texel is repeated. The sum runs
/// over the taps in order for every pixel, so the result is bit-identical for any number of threads.
Grid<float> filter_rows(const Grid<float>& plane, std::span<const float> kernel);

/// The same along the columns.
Grid<float> filter_columns(const Grid<float>& plane, std::span<const float> kernel);

}  // namespace abn::harness
