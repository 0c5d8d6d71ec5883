#include "sampling/adaptive/local_variance.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sampling/adaptive/map_rules.h"
#include "sampling/adaptive/nearest_samples.h"
#include "sampling/adaptive/variance_of_samples.h"

namespace abn {
namespace {

/// Fewer samples than this per cell cost empty cells, more cost distances.
constexpr double samples_per_cell = 2;

/// One row of the raster, smoothed along itself.
void blur_row(const float* row, std::size_t width, float* out) {
  for (std::size_t x = 1; x + 1 < width; ++x) out[x] = blurred(row[x - 1], row[x], row[x + 1]);
  const std::size_t last = width - 1;
  out[0] = blurred(row[0], row[0], row[std::min<std::size_t>(1, last)]);
  out[last] = blurred(row[last - std::min<std::size_t>(1, last)], row[last], row[last]);
}

}  // namespace

Grid<float> local_variance(std::span<const Vec2f> position, std::span<const float> value, std::uint32_t channels,
                           Extent plane, Extent map, int neighbours) {
  assert(channels >= 1 && value.size() == position.size() * channels);
  assert(std::all_of(value.begin(), value.end(), [](float v) { return std::isfinite(v); }));
  assert(neighbours >= 1 && neighbours <= NearestSamples::most_neighbours);
  Grid<float> variance(map);
  if (position.size() < 2 || map.area() == 0) return variance;
  const NearestSamples samples(position, plane, samples_per_cell);
  const double cell_width = static_cast<double>(plane.width) / map.width;
  const double cell_height = static_cast<double>(plane.height) / map.height;
  const auto rows = static_cast<std::int64_t>(map.height);
#pragma omp parallel for schedule(dynamic, 8)
  for (std::int64_t y = 0; y < rows; ++y) {
    NearestSamples::Search search;
    const auto row = static_cast<std::uint32_t>(y);
    search.y.fill(static_cast<float>((row + 0.5) * cell_height));
    for (std::uint32_t x = 0; x < map.width; x += NearestSamples::lanes) {
      for (std::uint32_t lane = 0; lane < NearestSamples::lanes; ++lane) {
        search.x[lane] = static_cast<float>((std::min(x + lane, map.width - 1) + 0.5) * cell_width);
      }
      samples.find(neighbours, search);
      if (search.count() < 2) continue;
      const std::uint32_t used = std::min<std::uint32_t>(NearestSamples::lanes, map.width - x);
      for (std::uint32_t lane = 0; lane < used; ++lane) {
        variance.at(x + lane, row) = variance_of_samples(
            search.count(), [&](int k) { return search.index(static_cast<int>(lane), k); }, value.data(), channels);
      }
    }
  }
  return variance;
}

void blur(Grid<float>& map, int passes) {
  const std::size_t width = map.size().width;
  const std::size_t height = map.size().height;
  if (width == 0 || height == 0) return;
  std::vector<float> along(width * height);
  float* cells = map.cells().data();
  const auto rows = static_cast<std::int64_t>(height);
  for (int pass = 0; pass < passes; ++pass) {
#pragma omp parallel
    {
#pragma omp for schedule(static)
      for (std::int64_t y = 0; y < rows; ++y) {
        const std::size_t at = static_cast<std::size_t>(y) * width;
        blur_row(cells + at, width, along.data() + at);
      }
#pragma omp for schedule(static)
      for (std::int64_t y = 0; y < rows; ++y) {
        const auto row = static_cast<std::size_t>(y);
        const float* above = along.data() + (row == 0 ? 0 : row - 1) * width;
        const float* here = along.data() + row * width;
        const float* below = along.data() + std::min(row + 1, height - 1) * width;
        float* out = cells + row * width;
        for (std::size_t x = 0; x < width; ++x) out[x] = blurred(above[x], here[x], below[x]);
      }
    }
  }
}

}  // namespace abn
