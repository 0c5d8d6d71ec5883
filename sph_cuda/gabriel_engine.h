// gabriel_midpoints() on a device of engine.h.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "sampling/adaptive/gabriel.h"
#include "sampling/error.h"
#include "sampling/vec.h"
#include "sph_cuda/channel_sums.h"
#include "sph_cuda/gabriel_kernels.h"
#include "sph_cuda/sample_cells.h"

namespace abn::sph_cuda {

template <class Device>
class GabrielEngine {
 public:
  /// gabriel_midpoints() for samples on the device: `position` [n] [px], inside the plane, `value` [n * channels],
  /// finite. The same bits, except that the C library's pow() and the device's may differ for a length_exponent that
  /// is not 2. Memory is kept for the next time. Throws DeviceError where numbers of edges exceed 32 bits.
  GabrielMidpoints midpoints(Device& device, const Vec2f* position, const float* value, std::uint32_t n,
                             std::uint32_t channels, Extent plane, std::size_t wanted, std::uint64_t seed,
                             const GabrielOptions& options) {
    assert(channels >= 1 && options.neighbours >= 1 && options.neighbours < NearestFound::most);
    assert(options.floor >= 0 && options.min_length >= 0 && options.jitter >= 0 && options.activity >= 0);
    check_size(n, channels, wanted, options);
    GabrielMidpoints midpoints;
    if (wanted == 0) return midpoints;
    const auto most = static_cast<std::uint32_t>(wanted);
    std::uint32_t pairs = 0;
    if (n >= 2) {
      sort_samples(device, position, value, n, channels, plane);
      find_edges(device, n, channels, options);
      pairs = std::min(most, find_candidates(device, n, channels, most, seed, options));
    }
    midpoint_.reset(most);
    device.launch(most, PlaceMidpoints{sort_.samples().position, n, slot_sorted_.data(), end_.data(), pairs,
                                       static_cast<float>(options.jitter), plane, seed, midpoint_.data()});
    midpoints.position = midpoint_.download(most);
    midpoints.pairs = pairs;
    return midpoints;
  }

 private:
  template <class T>
  using Buffer = typename Device::template Buffer<T>;

  static void check_size(std::uint32_t n, std::uint32_t channels, std::size_t wanted, const GabrielOptions& options) {
    const std::uint64_t numbers =
        (std::uint64_t{n} + sph::sum_chunk) * std::max(channels, static_cast<std::uint32_t>(options.neighbours));
    if (std::max<std::uint64_t>(numbers, wanted) > std::numeric_limits<std::uint32_t>::max()) {
      throw DeviceError("refinement on a device: " + std::to_string(n) +
                        " samples have too many edges or values; ask for fewer samples or use --backend cpu");
    }
  }

  /// The samples in the order by which gabriel_midpoints() numbers them.
  void sort_samples(Device& device, const Vec2f* position, const float* value, std::uint32_t n, std::uint32_t channels,
                    Extent plane) {
    sort_.sort(device, position, n, cells_of_samples(n, plane, pair_samples_per_cell));
    if (const double per_cell = pair_samples_per_cell_of(sort_.crowd(device)); per_cell < pair_samples_per_cell) {
      sort_.sort(device, position, n, cells_of_samples(n, plane, per_cell));
    }
    value_.reset(std::size_t{n} * channels);
    device.launch(n * channels, OrderValues{value, sort_.samples().index, channels, value_.data()});
  }

  void find_edges(Device& device, std::uint32_t n, std::uint32_t channels, const GabrielOptions& options) {
    const std::uint32_t neighbours = std::min(static_cast<std::uint32_t>(options.neighbours), n - 1);
    const bool active = options.activity > 0;
    last_.reset(n);
    edges_.reset(n);
    end_.reset(std::size_t{n} * neighbours);
    activity_.reset(active ? n : 0);
    SamplesInCells samples = sort_.samples();
    samples.index = nullptr;
    device.launch(n, FindEdges{samples, n, static_cast<int>(neighbours),
                               static_cast<float>(options.min_length * options.min_length), value_.data(), channels,
                               last_.data(), edges_.data(), end_.data(), active ? activity_.data() : nullptr});
    const ValueOfChannel values{value_.data(), channels};
    mean_sums_.find(device, channels, n, values);
    square_sums_.find(device, channels, n, SquaredDeviation{values, mean_sums_.total(), static_cast<double>(n)});
    floor_.reset(1);
    device.launch(1, FindFloor{square_sums_.total(), channels, static_cast<double>(std::uint64_t{n} * channels),
                               options.floor, floor_.data()});
  }

  /// The pairs of the classes that hold the `wanted` most urgent ones, in slot_sorted_, the most urgent first; their
  /// number. Waits for the device.
  std::uint32_t find_candidates(Device& device, std::uint32_t n, std::uint32_t channels, std::uint32_t wanted,
                                std::uint64_t seed, const GabrielOptions& options) {
    priority_.reset(end_.size());
    in_class_.reset(priority_classes + 1);
    above_.reset(priority_classes + 1);
    count_.reset(std::size_t{n} + 1);
    start_.reset(std::size_t{n} + 1);
    device.prepare_sums(std::max(priority_classes, n) + 1);
    device.launch(priority_classes + 1, Fill<std::uint32_t>{in_class_.data(), 0});
    device.launch(n, RatePairs{sort_.samples().position, n, value_.data(), channels, last_.data(), edges_.data(),
                               end_.data(), options.activity > 0 ? activity_.data() : nullptr, floor_.data(),
                               options.activity, options.length_exponent, priority_.data(), in_class_.data()});
    device.exclusive_sum(in_class_.data(), above_.data(), priority_classes + 1);
    const NeededClasses needed{above_.data(), wanted};
    device.launch(n + 1, CountCandidates{needed, n, edges_.data(), priority_.data(), count_.data()});
    device.exclusive_sum(count_.data(), start_.data(), n + 1);
    const std::uint32_t candidates = start_.download_at(n, 1)[0];
    for (auto* buffer : {&key_, &key_sorted_}) buffer->reset(candidates);
    for (auto* buffer : {&slot_, &slot_sorted_}) buffer->reset(candidates);
    device.prepare_sort(candidates);
    // By lot, then by priority, of which equal ones keep their order.
    device.launch(n, WriteCandidates{needed, n, edges_.data(), end_.data(), priority_.data(), start_.data(), seed,
                                     key_.data(), slot_.data()});
    device.sort_pairs(key_.data(), key_sorted_.data(), slot_.data(), slot_sorted_.data(), candidates);
    device.launch(candidates, KeyByPriority{priority_.data(), slot_sorted_.data(), key_.data()});
    std::swap(slot_, slot_sorted_);
    device.sort_pairs(key_.data(), key_sorted_.data(), slot_.data(), slot_sorted_.data(), candidates);
    return candidates;
  }

  SampleSort<Device> sort_;
  ChannelSums<Device> mean_sums_, square_sums_;
  Buffer<Vec2f> midpoint_;
  Buffer<float> value_;  // in the order of the samples
  Buffer<float> activity_, priority_;
  Buffer<double> floor_;
  Buffer<std::uint64_t> last_, key_, key_sorted_;
  Buffer<std::uint32_t> edges_, end_, in_class_, above_, count_, start_, slot_, slot_sorted_;
};

}  // namespace abn::sph_cuda
