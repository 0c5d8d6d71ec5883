// Values on the device that is a loop on the host, and samples to put there, for tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "sampling/grid.h"
#include "sampling/rng.h"
#include "sampling/vec.h"
#include "sph_cuda/host_device.h"

namespace abn::sph_cuda {

template <class T>
HostDevice::Buffer<T> on_device(const std::vector<T>& values) {
  HostDevice::Buffer<T> buffer;
  buffer.reset(values.size());
  buffer.upload(values);
  return buffer;
}
template <class T>
HostDevice::Buffer<T> on_device(const Grid<T>& map) {
  return on_device(std::vector<T>(map.cells().begin(), map.cells().end()));
}

/// Whether `count` values in the device's memory are these to the bit.
template <class T>
bool same_bits(const T* on_device, const T* expected, std::size_t count) {
  const HostMemory::Access access;
  return count == 0 || std::memcmp(on_device, expected, count * sizeof(T)) == 0;
}

/// position [n] [px], value [n * channels].
struct Samples {
  std::vector<Vec2f> position;
  std::vector<float> value;
};

/// A fifth of them crowded in a corner, some at the same place, some on the borders, many of equal values.
inline Samples samples_of(Extent plane, std::uint32_t n, std::uint32_t channels) {
  Samples samples;
  const auto w = static_cast<float>(plane.width);
  const auto h = static_cast<float>(plane.height);
  for (std::uint32_t i = 0; i < n; ++i) {
    Rng rng(5, 6, i);
    Vec2f at = to_plane(rng.uniform2(), plane);
    if (i % 5 == 0) at = at * 0.02F;
    if (i % 50 == 1) at = {w / 2, 0.5F};
    if (i % 50 == 2) at.x = just_below(w);
    if (i % 50 == 3) at.y = just_below(h);
    samples.position.push_back(at);
    for (std::uint32_t c = 0; c < channels; ++c) samples.value.push_back(rng.uniform() > 0.7F ? rng.uniform() : 0.25F);
  }
  return samples;
}

}  // namespace abn::sph_cuda
