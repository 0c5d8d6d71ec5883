// The variance of a few samples, for host and device.
#pragma once

#include <cstdint>

#include "sampling/hd.h"

namespace abn {

inline constexpr int most_variance_samples = 32;
// Far enough below the largest float that sums over a window stay finite.
inline constexpr double largest_variance = 1e36;

/// Mean over channels of the variance of 2 <= count <= most_variance_samples samples; index_of(k) names the k-th of
/// them in value [samples * channels]. In double around the mean: exactly 0 for equal values.
template <class IndexOf>
ABN_HD inline float variance_of_samples(int count, const IndexOf& index_of, const float* value,
                                        std::uint32_t channels) {
  double sum = 0;
  for (std::uint32_t channel = 0; channel < channels; ++channel) {
    double v[most_variance_samples];
    double mean = 0;
    for (int k = 0; k < count; ++k) {
      v[k] = static_cast<double>(value[std::uint64_t{index_of(k)} * channels + channel]);
      mean += v[k];
    }
    mean /= count;
    for (int k = 0; k < count; ++k) {
      const double deviation = v[k] - mean;
      sum += deviation * deviation;
    }
  }
  const double variance = sum / ((count - 1.0) * channels);
  return static_cast<float>(variance < largest_variance ? variance : largest_variance);
}

}  // namespace abn
