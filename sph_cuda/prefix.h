// fixed_order_prefix() on a device.
#pragma once

#include <cstddef>
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

/// One block: what comes before every chunk, in the place of its total; the sum of all after the last value. The totals
/// come through shared memory, where one thread adds them up.
struct AddTotals {
  static constexpr std::uint32_t threads = 256;

  double* total;  // [chunks]
  std::uint32_t chunks;
  double* before;  // [n + 1]
  std::uint32_t n;

  /// For every `threads` totals: they are loaded, added up, and stored.
  ABN_HD int phases(std::uint32_t) const { return static_cast<int>(3 * ((chunks + threads - 1) / threads) + 1); }
  std::size_t shared_bytes() const { return (threads + 1) * sizeof(double); }
  ABN_HD void operator()(int phase, std::uint32_t, std::uint32_t thread, void* memory) const {
    auto* shared = static_cast<double*>(memory);
    double& base = shared[threads];
    const std::uint32_t chunk = static_cast<std::uint32_t>(phase / 3) * threads + thread;
    if (phase == 0 && thread == 0) base = 0;
    if (chunk - thread >= chunks) {
      if (thread == 0) before[n] = base;
    } else if (phase % 3 == 0) {
      if (chunk < chunks) shared[thread] = total[chunk];
    } else if (phase % 3 == 1) {
      for (std::uint32_t k = 0; thread == 0 && k < threads && chunk + k < chunks; ++k) {
        const double sum = shared[k];
        shared[k] = base;
        base += sum;
      }
    } else if (chunk < chunks) {
      total[chunk] = shared[thread];
    }
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
    device.launch_blocks(1, AddTotals{total_.data(), chunks, before_.data(), n});
    device.launch(chunks, FillChunk<Load>{load, n, total_.data(), before_.data()});
  }
  const double* before() const { return before_.data(); }
  double total(std::uint32_t n) const { return before_.download_at(n, 1)[0]; }

 private:
  typename Device::template Buffer<double> total_, before_;
};

}  // namespace abn::sph_cuda
