#include "harness/separable_filter.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <vector>

namespace abn::harness {
namespace {

// out[i] += weight * in[i]
void accumulate(float weight, const float* in, float* out, std::size_t count) {
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i) out[i] += weight * in[i];
}

}  // namespace

Grid<float> filter_rows(const Grid<float>& plane, std::span<const float> kernel) {
  assert(kernel.size() % 2 == 1);
  const std::size_t radius = kernel.size() / 2;
  const std::size_t width = plane.size().width;
  const auto height = static_cast<int>(plane.size().height);
  Grid<float> filtered(plane.size());
  if (width == 0) return filtered;
#pragma omp parallel if (plane.cells().size() >= smallest_parallel_raster)
  {
    std::vector<float> padded(width + 2 * radius);  // the row with its border repeated
#pragma omp for schedule(static)
    for (int y = 0; y < height; ++y) {
      const float* in = plane.cells().data() + static_cast<std::size_t>(y) * width;
      float* out = filtered.cells().data() + static_cast<std::size_t>(y) * width;
      std::fill_n(padded.begin(), radius, in[0]);
      std::copy_n(in, width, padded.data() + radius);
      std::fill_n(padded.data() + radius + width, radius, in[width - 1]);
      for (std::size_t tap = 0; tap < kernel.size(); ++tap) accumulate(kernel[tap], padded.data() + tap, out, width);
    }
  }
  return filtered;
}

Grid<float> filter_columns(const Grid<float>& plane, std::span<const float> kernel) {
  assert(kernel.size() % 2 == 1);
  const int radius = static_cast<int>(kernel.size() / 2);
  const std::size_t width = plane.size().width;
  const auto height = static_cast<int>(plane.size().height);
  Grid<float> filtered(plane.size());
#pragma omp parallel for schedule(static) if (plane.cells().size() >= smallest_parallel_raster)
  for (int y = 0; y < height; ++y) {
    float* out = filtered.cells().data() + static_cast<std::size_t>(y) * width;
    for (int tap = -radius; tap <= radius; ++tap) {
      const auto row = static_cast<std::size_t>(std::clamp(y + tap, 0, height - 1));
      accumulate(kernel[static_cast<std::size_t>(tap + radius)], plane.cells().data() + row * width, out, width);
    }
  }
  return filtered;
}

}  // namespace abn::harness
