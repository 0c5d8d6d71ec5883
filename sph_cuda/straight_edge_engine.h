// straight_edge_share() on a device of engine.h.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "sampling/adaptive/edge_pixel.h"
#include "sampling/error.h"
#include "sampling/hd.h"
#include "sampling/vec.h"
#include "sph_cuda/channel_sums.h"
#include "sph_cuda/kernels.h"
#include "sph_cuda/sample_cells.h"

namespace abn::sph_cuda {

/// Every sample to its place in its pixel: by index.
struct GatherPixelSamples {
  const Vec2f* position;       // [n], in the order of pixels
  const std::uint32_t* index;  // [n], of the samples in that order
  const float* value;          // [n * channels], by index
  std::uint32_t channels;
  PixelSample* sample;  // [n]
  ABN_HD void operator()(std::uint32_t k) const {
    sample[k] = pixel_sample(position[k], value + std::uint64_t{index[k]} * channels, channels);
  }
};

/// What every pixel has left to gain.
struct FindErrorLeft {
  const std::uint32_t* start;  // [pixels + 1]
  const PixelSample* sample;
  double* total;  // [pixels], sums of squared deviations
  double* left;   // [pixels]
  ABN_HD void operator()(std::uint32_t pixel) const {
    const std::uint32_t n = start[pixel + 1] - start[pixel];
    const double sum = n < 2 ? 0.0 : squared_deviations(sample + start[pixel], n);
    total[pixel] = sum;
    left[pixel] = sum > 0 ? error_left(sum, n) : 0.0;
  }
};

/// The samples of pixels that may have an edge, every pixel's by value.
struct OrderByValue {
  SampleCells pixels;
  const Vec2f* position;  // [n], in the order of pixels
  const std::uint32_t* start;
  const double* total;
  const PixelSample* sample;
  PixelSample* ordered;  // [n]
  ABN_HD void operator()(std::uint32_t k) const {
    const std::uint32_t pixel = pixels.cell(position[k]);
    const std::uint32_t first = start[pixel];
    const std::uint32_t end = start[pixel + 1];
    if (end - first < least_edge_samples || !(total[pixel] > 0)) return;
    const PixelSample own = sample[k];
    std::uint32_t to = first;
    for (std::uint32_t other = first; other < end; ++other) {
      const PixelSample its = sample[other];
      to += before(its, own) || (other < k && !before(own, its)) ? 1 : 0;
    }
    ordered[to] = own;
  }
};

/// What is left in pixels that an edge crosses, 0 in the others.
struct FindCrossed {
  const std::uint32_t* start;
  const double* total;
  const double* left;
  const PixelSample* ordered;
  double* crossed;  // [pixels]
  ABN_HD void operator()(std::uint32_t pixel) const {
    const std::uint32_t n = start[pixel + 1] - start[pixel];
    const PixelSample* samples = ordered + start[pixel];
    double found = 0;
    if (n >= least_edge_samples && total[pixel] > 0) {
      const std::uint32_t at = lower_class(samples, n, total[pixel]);
      if (at > 0 && separated(samples, n, at)) found = left[pixel];
    }
    crossed[pixel] = found;
  }
};

/// Both as channels of one sum.
struct LeftAndCrossed {
  const double* left;
  const double* crossed;
  ABN_HD double operator()(std::uint32_t channel, std::uint32_t pixel) const {
    return channel == 0 ? left[pixel] : crossed[pixel];
  }
};

template <class Device>
class StraightEdgeEngine {
 public:
  /// straight_edge_share() for samples on the device: `position` [n] [px], inside the plane, `value` [n * channels],
  /// finite. The same bits. Memory is kept for the next time. Throws DeviceError for a plane of 2^31 pixels or more.
  double share(Device& device, const Vec2f* position, const float* value, std::uint32_t n, std::uint32_t channels,
               Extent plane) {
    assert(channels >= 1);
    if (n == 0 || plane.area() == 0) return 0;
    if (2 * (plane.area() + sph::sum_chunk) > std::numeric_limits<std::uint32_t>::max()) {
      throw DeviceError("straight edges on a device: " + std::to_string(plane.area()) +
                        " pixels are too many; ask for a smaller image or use --backend cpu");
    }
    const auto area = static_cast<std::uint32_t>(plane.area());
    SampleCells pixels;  // of 1 px
    pixels.columns = static_cast<std::int32_t>(plane.width);
    pixels.rows = static_cast<std::int32_t>(plane.height);
    sort_.sort(device, position, n, pixels);
    const SamplesInCells& samples = sort_.samples();
    for (auto* buffer : {&sample_, &ordered_}) buffer->reset(n);
    for (auto* buffer : {&total_, &left_, &crossed_}) buffer->reset(area);
    device.launch(n, GatherPixelSamples{samples.position, samples.index, value, channels, sample_.data()});
    device.launch(area, FindErrorLeft{samples.start, sample_.data(), total_.data(), left_.data()});
    device.launch(
        n, OrderByValue{pixels, samples.position, samples.start, total_.data(), sample_.data(), ordered_.data()});
    device.launch(area, FindCrossed{samples.start, total_.data(), left_.data(), ordered_.data(), crossed_.data()});
    sums_.find(device, 2, area, LeftAndCrossed{left_.data(), crossed_.data()});
    const double all = sums_.total(0);
    return all > 0 ? sums_.total(1) / all : 0;
  }

 private:
  template <class T>
  using Buffer = typename Device::template Buffer<T>;

  SampleSort<Device> sort_;
  ChannelSums<Device> sums_;
  Buffer<PixelSample> sample_, ordered_;
  Buffer<double> total_, left_, crossed_;
};

}  // namespace abn::sph_cuda
