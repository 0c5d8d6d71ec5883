// Sums over many values on a device, in the order of sampling/sph/fixed_sum.h.
#pragma once

#include <cstdint>
#include <vector>

#include "sph_cuda/sum_kernels.h"

namespace abn::sph_cuda {

/// LoadTotals{pointer} reads the totals of chunks, as SumOfChunk does.
template <class Device, class LoadTotals>
class Sum {
 public:
  using Value = typename LoadTotals::Value;

  /// Makes room for sums of n >= 1 values: what find() is recorded with stays where it is until the next reset().
  void reset(std::uint32_t n) {
    std::size_t level = 0;
    do {
      n = (n - 1) / sph::sum_chunk + 1;
      if (level == levels_.size()) levels_.emplace_back();
      levels_[level++].reset(n);
    } while (n > 1);
    levels_.resize(level);
  }

  /// Sums load(i), i < n, into total(), on the device. With a control that is done nothing happens.
  template <class Load>
  void find(Device& device, const sph::RelaxControl* control, std::uint32_t n, const Load& load) {
    const Value* below = nullptr;
    for (auto& level : levels_) {
      const auto blocks = static_cast<std::uint32_t>(level.size());
      if (below == nullptr) {
        device.launch_blocks(blocks, SumChunks<Load>{control, load, n, level.data()});
      } else {
        device.launch_blocks(blocks, SumChunks<LoadTotals>{control, {below}, n, level.data()});
      }
      n = blocks;
      below = level.data();
    }
  }
  const Value* total() const { return levels_.back().data(); }
  Value read() const { return levels_.back().download(1)[0]; }

 private:
  std::vector<typename Device::template Buffer<Value>> levels_;
};

}  // namespace abn::sph_cuda
