#include "sampling/adaptive/straight_edges.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <vector>

#include "sampling/adaptive/edge_pixel.h"
#include "sampling/sph/fixed_sum.h"

namespace abn {

double straight_edge_share(std::span<const Vec2f> position, std::span<const float> value, std::uint32_t channels,
                           Extent plane) {
  assert(value.size() == position.size() * channels);
  std::vector<std::uint32_t> begin(plane.area() + 1, 0);
  std::vector<std::uint32_t> pixel(position.size());
  for (std::size_t i = 0; i < position.size(); ++i) {
    pixel[i] = static_cast<std::uint32_t>(position[i].y) * plane.width + static_cast<std::uint32_t>(position[i].x);
    ++begin[pixel[i] + 1];
  }
  for (std::size_t p = 0; p < plane.area(); ++p) begin[p + 1] += begin[p];
  std::vector<PixelSample> sorted(position.size());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t i = 0; i < position.size(); ++i) {
    sorted[next[pixel[i]]++] = pixel_sample(position[i], value.data() + i * channels, channels);
  }
  std::vector<double> left(plane.area(), 0);
  std::vector<double> crossed(plane.area(), 0);
  for (std::size_t p = 0; p < plane.area(); ++p) {
    PixelSample* samples = sorted.data() + begin[p];
    const std::uint32_t n = begin[p + 1] - begin[p];
    if (n < 2) continue;
    const double total = squared_deviations(samples, n);
    if (!(total > 0)) continue;
    left[p] = error_left(total, n);
    if (n < least_edge_samples) continue;
    std::sort(samples, samples + n, before);
    const std::uint32_t at = lower_class(samples, n, total);
    if (at > 0 && separated(samples, n, at)) crossed[p] = left[p];
  }
  const double all = sph::fixed_order_sum(left);
  return all > 0 ? sph::fixed_order_sum(crossed) / all : 0;
}

}  // namespace abn
