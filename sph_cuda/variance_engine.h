// local_variance() on a device of engine.h: the samples nearest to every place of the map.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sampling/adaptive/variance_of_samples.h"
#include "sampling/grid.h"
#include "sampling/hd.h"
#include "sampling/vec.h"
#include "sph_cuda/sample_cells.h"

namespace abn::sph_cuda {

/// The variance of the samples nearest to a cell of the map.
struct FindVariance {
  SamplesInCells samples;
  const float* value;  // [n * channels]
  std::uint32_t channels;
  int wanted;  // 2 <= wanted <= most_variance_samples, at most n
  std::uint32_t map_width;
  double step_x, step_y;  // of the map [px]
  float* variance;        // [map]

  ABN_HD void operator()(std::uint32_t i) const {
    const std::uint32_t row = i / map_width;
    const Vec2f at{static_cast<float>((i - row * map_width + 0.5) * step_x), static_cast<float>((row + 0.5) * step_y)};
    NearestFound nearest;
    find_nearest(samples, at, wanted, no_sample, nearest);
    variance[i] = variance_of_samples(
        wanted, [&](int k) { return nearest.index(k); }, value, channels);
  }
};

struct NoVariance {
  float* variance;
  ABN_HD void operator()(std::uint32_t i) const { variance[i] = 0; }
};

template <class Device>
class VarianceEngine {
 public:
  /// local_variance() on the device: `position` [n] [px], inside the plane, `value` [n * channels], finite; `variance`
  /// [map.area()]. The same bits. Memory is kept for the next time.
  void find(Device& device, const Vec2f* position, const float* value, std::uint32_t n, std::uint32_t channels,
            Extent plane, Extent map, int neighbours, float* variance) {
    assert(channels >= 1 && neighbours >= 1 && neighbours <= most_variance_samples);
    static_assert(most_variance_samples <= NearestFound::most);
    const auto places = static_cast<std::uint32_t>(map.area());
    const auto wanted = static_cast<int>(std::min(static_cast<std::uint32_t>(neighbours), n));
    if (wanted < 2) {
      device.launch(places, NoVariance{variance});
      return;
    }
    constexpr double samples_per_cell = 2;  // as on the host; fewer cost empty cells, more cost distances
    sort_.sort(device, position, n, cells_of_samples(n, plane, samples_per_cell));
    device.launch(places, FindVariance{sort_.samples(), value, channels, wanted, map.width,
                                       static_cast<double>(plane.width) / map.width,
                                       static_cast<double>(plane.height) / map.height, variance});
  }

  /// The same from the host to the host.
  Grid<float> operator()(Device& device, std::span<const Vec2f> position, std::span<const float> value,
                         std::uint32_t channels, Extent plane, Extent map, int neighbours) {
    assert(value.size() == position.size() * channels);
    Grid<float> variance(map);
    if (map.area() == 0) return variance;
    position_.reset(position.size());
    position_.upload(position);
    value_.reset(value.size());
    value_.upload(value);
    variance_.reset(map.area());
    find(device, position_.data(), value_.data(), static_cast<std::uint32_t>(position.size()), channels, plane, map,
         neighbours, variance_.data());
    const std::vector<float> found = variance_.download(map.area());
    std::copy(found.begin(), found.end(), variance.cells().begin());
    return variance;
  }

 private:
  template <class T>
  using Buffer = typename Device::template Buffer<T>;

  SampleSort<Device> sort_;
  Buffer<Vec2f> position_;
  Buffer<float> value_, variance_;
};

}  // namespace abn::sph_cuda
