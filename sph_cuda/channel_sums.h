// The sum of every channel on a device, in the order of sampling/sph/fixed_sum.h.
#pragma once

#include <cstdint>
#include <utility>

#include "sampling/hd.h"
#include "sampling/sph/fixed_sum.h"
#include "sph_cuda/sum_kernels.h"

namespace abn::sph_cuda {

/// The values of all channels one after the other, each followed by zeros to whole chunks, so that no chunk has values
/// of two channels. Zeros leave a sum as it is.
template <class Load>
struct PaddedChannels {
  using Value = double;
  Load load;             // load(channel, i) gives value i of a channel
  std::uint32_t n;       // values of a channel
  std::uint32_t padded;  // to whole chunks
  ABN_HD Value operator()(std::uint32_t at) const {
    const std::uint32_t channel = at / padded;
    const std::uint32_t i = at - channel * padded;
    return i < n ? load(channel, i) : 0.0;
  }
};

/// The totals of a channel's chunks.
struct TotalOfChannel {
  const double* total;   // [channels * chunks]
  std::uint32_t chunks;  // of a channel
  ABN_HD double operator()(std::uint32_t channel, std::uint32_t i) const { return total[channel * chunks + i]; }
};

template <class Device>
class ChannelSums {
 public:
  /// total() is then [channels], on the device: what fixed_order_sum() gives for load(channel, i), i < n. Precondition:
  /// n >= 1, channels * (n + sum_chunk) < 2^32.
  template <class Load>
  void find(Device& device, std::uint32_t channels, std::uint32_t n, const Load& load) {
    std::uint32_t chunks = add_chunks(device, channels, n, load);
    while (chunks > 1) {
      std::swap(total_, below_);
      chunks = add_chunks(device, channels, chunks, TotalOfChannel{below_.data(), chunks});
    }
  }
  const double* total() const { return total_.data(); }
  double total(std::uint32_t channel) const { return total_.download_at(channel, 1)[0]; }

 private:
  template <class Load>
  std::uint32_t add_chunks(Device& device, std::uint32_t channels, std::uint32_t n, const Load& load) {
    const std::uint32_t chunks = (n + sph::sum_chunk - 1) / sph::sum_chunk;
    const std::uint32_t padded = chunks * sph::sum_chunk;
    total_.reset(channels * chunks);
    device.launch_blocks(channels * chunks,
                         SumChunks<PaddedChannels<Load>>{nullptr, {load, n, padded}, channels * padded, total_.data()});
    return chunks;
  }

  typename Device::template Buffer<double> total_, below_;
};

}  // namespace abn::sph_cuda
