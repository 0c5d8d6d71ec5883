// fixed_order_prefix() on a device.
#pragma once

#include <cstdint>

#include "sampling/fixed_prefix.h"
#include "sampling/hd.h"

namespace abn::sph_cuda {

/// The total of every chunk. load(i) gives value i.
template <class Load>
struct AddChunk {
  Load load;
  std::uint32_t n;
  double* total;  // [chunks]
  ABN_HD void operator()(std::uint32_t chunk) const {
    const std::uint64_t begin = std::uint64_t{chunk} * prefix_chunk;
    double sum = 0;
    for (std::uint64_t i = begin; i < begin + prefix_chunk && i < n; ++i) sum += load(static_cast<std::uint32_t>(i));
    total[chunk] = sum;
  }
};

/// One thread: what comes before every chunk, in the place of its total; the sum of all after the last value.
struct AddTotals {
  double* total;  // [chunks]
  std::uint32_t chunks;
  double* before;  // [n + 1]
  std::uint32_t n;
  ABN_HD void operator()(std::uint32_t) const {
    double base = 0;
    for (std::uint32_t chunk = 0; chunk < chunks; ++chunk) {
      const double sum = total[chunk];
      total[chunk] = base;
      base += sum;
    }
    before[n] = base;
  }
};

template <class Load>
struct FillChunk {
  Load load;
  std::uint32_t n;
  const double* base;  // [chunks]
  double* before;      // [n + 1]
  ABN_HD void operator()(std::uint32_t chunk) const {
    const std::uint64_t begin = std::uint64_t{chunk} * prefix_chunk;
    double sum = 0;
    for (std::uint64_t i = begin; i < begin + prefix_chunk && i < n; ++i) {
      before[i] = base[chunk] + sum;
      sum += load(static_cast<std::uint32_t>(i));
    }
  }
};

template <class Device>
class Prefix {
 public:
  /// before() is then [n + 1], on the device.
  template <class Load>
  void find(Device& device, std::uint32_t n, const Load& load) {
    const auto chunks = static_cast<std::uint32_t>((std::uint64_t{n} + prefix_chunk - 1) / prefix_chunk);
    total_.reset(chunks);
    before_.reset(std::size_t{n} + 1);
    device.launch(chunks, AddChunk<Load>{load, n, total_.data()});
    device.launch(1, AddTotals{total_.data(), chunks, before_.data(), n});
    device.launch(chunks, FillChunk<Load>{load, n, total_.data(), before_.data()});
  }
  const double* before() const { return before_.data(); }
  double total(std::uint32_t n) const { return before_.download_at(n, 1)[0]; }

 private:
  typename Device::template Buffer<double> total_, before_;
};

}  // namespace abn::sph_cuda
