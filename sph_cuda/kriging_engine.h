// Kriging on a device of relaxation.h: samples into pixels, steps, the points of every pixel, a system each. The host
// adds what is left: pixels that no sample reaches, and errors (krige() in harness/kriging.cpp).
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sampling/error.h"
#include "sampling/kriging/kriging_rules.h"
#include "sampling/kriging/pixel_estimates.h"
#include "sph_cuda/bins_engine.h"
#include "sph_cuda/kriging_gather.h"
#include "sph_cuda/kriging_solve.h"
#include "sph_cuda/step_engine.h"

namespace abn::sph_cuda {

/// Systems of similar size are solved together, so that small ones do not take the memory of large ones: those of more
/// points than one limit, up to the next. Behind them come the merged ones.
inline constexpr std::array<std::uint32_t, 6> system_sizes{0, 16, 24, 40, 64, kriging_rules::most_neighbours};

/// Where the systems of every size end among the sorted ones; one more: how many points there are in all.
struct FindSizes {
  const std::uint64_t* sorted_key;
  std::uint32_t pixels;
  const std::uint32_t* start;  // [pixels + 1]
  std::uint32_t* sizes;        // [system_sizes + 1]
  ABN_HD void operator()(std::uint32_t k) const {
    constexpr std::array<std::uint32_t, system_sizes.size()> limits = system_sizes;
    sizes[k] = k < limits.size() ? lower_bound_of(sorted_key, pixels, std::uint64_t{limits[k]} + 1) : start[pixels];
  }
};

template <class Device>
class KrigingEngine {
 public:
  explicit KrigingEngine(Device device = {}) : device_(std::move(device)) {}

  /// PixelEstimates as krige() finds them, after find_steps() or without; see SampleEstimator. `pixels_at_once` bounds
  /// the memory for systems. Throws
  /// DeviceError for more samples than counters can count, and without memory for them.
  PixelEstimates operator()(std::span<const Vec2f> position, std::span<const float> value,
                            std::span<const float> weight, std::uint32_t channels, Extent plane, bool steps,
                            std::uint32_t pixels_at_once = 1U << 17U) {
    assert(channels >= 1 && channels <= 3 && pixels_at_once > 0);
    PixelEstimates estimates;
    estimates.scale = Grid<PixelScale>(plane);
    estimates.samples =
        static_cast<std::uint64_t>(std::count_if(weight.begin(), weight.end(), [](float w) { return w > 0; }));
    estimates.empty_pixels = plane.area();
    if (steps) estimates.step = Grid<PixelStep>(plane);
    if (estimates.samples == 0) {
      estimates.value.resize(plane.area() * channels);
      return estimates;
    }
    constexpr std::uint64_t most = 1U << 28U;  // nine times as many are still counted in 32 bits
    if (position.size() > most || plane.area() > most) {
      throw DeviceError("the GPU reconstructs at most " + std::to_string(most) +
                        " samples and pixels at once; use --backend cpu");
    }
    bins_.sort(position, value, weight, channels, plane, static_cast<std::uint32_t>(estimates.samples));
    const auto pixels = static_cast<std::uint32_t>(plane.area());
    value_.reset(std::size_t{pixels} * channels);
    scale_.reset(pixels);
    empty_.reset(1);
    device_.launch(1, Fill<std::uint32_t>{empty_.data(), 0});
    if (steps) {
      step_.reset(pixels);
      steps_.look_at(bins_, EdgeOptions());
    }
    const EstimateArrays out{value_.data(), scale_.data(), steps ? step_.data() : nullptr};
    const KrigingOptions options;
    const float nugget =
        kriging_rules::nugget_of(static_cast<double>(estimates.samples) / static_cast<double>(plane.area()), options);
    for (std::uint32_t first = 0; first < pixels; first += pixels_at_once) {
      const std::uint32_t here = std::min(pixels_at_once, pixels - first);
      if (steps) steps_.find(first, here, step_.data());
      solve(first, here, nugget, options, out);
    }
    estimates.value = value_.download(value_.size());
    const std::vector<PixelScale> scale = scale_.download(pixels);
    std::copy(scale.begin(), scale.end(), estimates.scale.cells().begin());
    if (steps) {
      const std::vector<PixelStep> step = step_.download(pixels);
      std::copy(step.begin(), step.end(), estimates.step.cells().begin());
    }
    estimates.empty_pixels = empty_.download(1)[0];
    estimates.luminance_squares = bins_.luminance_squares_on_host();
    return estimates;
  }

 private:
  template <class T>
  using Buffer = typename Device::template Buffer<T>;

  /// The pixels [first, first + pixels).
  void solve(std::uint32_t first, std::uint32_t pixels, float nugget, const KrigingOptions& options,
             const EstimateArrays& out) {
    const BinnedSamples samples = bins_.samples();
    margin_.reset(pixels);
    for (auto* buffer : {&found_, &number_, &sorted_number_}) buffer->reset(pixels);
    for (auto* buffer : {&count_, &start_}) buffer->reset(std::size_t{pixels} + 1);
    for (auto* buffer : {&key_, &sorted_key_}) buffer->reset(pixels);
    sizes_.reset(system_sizes.size() + 1);
    device_.prepare_sums(pixels + 1);
    device_.prepare_sort(pixels);
    const PixelSystems systems{first, margin_.data(), found_.data(), count_.data(), start_.data()};
    device_.launch(pixels + 1, CountPoints{samples, options.margin, static_cast<std::uint32_t>(options.wanted), pixels,
                                           systems, out, key_.data(), number_.data(), empty_.data()});
    device_.exclusive_sum(count_.data(), start_.data(), pixels + 1);
    device_.sort_pairs(key_.data(), sorted_key_.data(), number_.data(), sorted_number_.data(), pixels);
    device_.launch(static_cast<std::uint32_t>(sizes_.size()),
                   FindSizes{sorted_key_.data(), pixels, start_.data(), sizes_.data()});
    const std::vector<std::uint32_t> sizes = sizes_.download(sizes_.size());

    for (auto* buffer : {&x_, &y_, &nugget_, &luminance_}) buffer->reset(sizes.back());
    point_value_.reset(std::size_t{sizes.back()} * samples.channels);
    const SystemPoints points{x_.data(), y_.data(), nugget_.data(), luminance_.data(), point_value_.data()};
    device_.launch(pixels, WritePoints{samples, systems, key_.data(), out, points, nugget});
    const auto solve_some = [&](std::uint32_t begin, std::uint32_t end, std::uint32_t most_points) {
      if (begin == end) return;
      device_.launch_blocks(
          end - begin, SolvePixels{systems, sorted_number_.data() + begin, points, samples.channels, most_points, out});
    };
    for (std::size_t k = 1; k < system_sizes.size(); ++k) solve_some(sizes[k - 1], sizes[k], system_sizes[k]);
    const std::uint32_t merged = sizes[system_sizes.size() - 1];
    if (merged == pixels) return;
    device_.launch_blocks(pixels - merged,
                          MergePoints{samples, systems, sorted_number_.data() + merged, out, points, nugget});
    solve_some(merged, pixels, merged_points);
  }

  Device device_;
  BinsEngine<Device> bins_{device_};
  StepEngine<Device> steps_{device_};
  Buffer<float> value_, margin_, x_, y_, nugget_, luminance_, point_value_;
  Buffer<PixelScale> scale_;
  Buffer<PixelStep> step_;
  Buffer<std::uint32_t> empty_, found_, number_, sorted_number_, count_, start_, sizes_;
  Buffer<std::uint64_t> key_, sorted_key_;
};

}  // namespace abn::sph_cuda
