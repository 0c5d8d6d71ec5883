// Values on the device that is a loop on the host, for tests.
#pragma once

#include <cstring>
#include <span>
#include <vector>

#include "sampling/grid.h"
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

}  // namespace abn::sph_cuda
