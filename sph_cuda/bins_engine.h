// Samples sorted by pixel on a device: what harness/sample_bins.h does on the host, in the same order.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "sampling/hd.h"
#include "sampling/kriging/sample_windows.h"
#include "sampling/vec.h"
#include "sph_cuda/sum_kernels.h"

namespace abn::sph_cuda {

/// The samples of weight > 0 in the order of their pixels, those of one pixel in the order in which they came.
struct BinnedSamples {
  Extent plane;
  std::uint32_t channels;
  const float* x;              // [n, px]
  const float* y;              // [n, px]
  const float* luminance;      // [n]
  const float* value;          // [n * channels]
  const std::uint32_t* begin;  // [pixels + 1]; the samples of pixel p are [begin[p], begin[p + 1])

  /// Of the samples of a window's row: the first, and what comes after the last.
  ABN_HD std::uint32_t row_begin(const PixelWindow& window, std::uint32_t row) const {
    return begin[row * plane.width + window.first_x];
  }
  ABN_HD std::uint32_t row_end(const PixelWindow& window, std::uint32_t row) const {
    return begin[row * plane.width + window.last_x + 1];
  }

  /// Squared distance of sample i from the square of the pixel at (left, top).
  ABN_HD float squared_distance(std::uint32_t i, float left, float top) const {
    const float dx = distance_outside(left, x[i]);
    const float dy = distance_outside(top, y[i]);
    return dx * dx + dy * dy;
  }
};

/// The number of the first of n rising keys that is not below a key.
ABN_HD inline std::uint32_t lower_bound_of(const std::uint64_t* key, std::uint32_t n, std::uint64_t wanted) {
  std::uint32_t begin = 0;
  std::uint32_t end = n;
  while (begin < end) {
    const std::uint32_t middle = begin + (end - begin) / 2;
    if (key[middle] < wanted) {
      begin = middle + 1;
    } else {
      end = middle;
    }
  }
  return begin;
}

struct FindPixels {
  Extent plane;
  const Vec2f* position;
  const float* weight;
  std::uint64_t* key;    // [given]: the pixel, or behind all pixels what counts nowhere
  std::uint32_t* index;  // [given]
  ABN_HD void operator()(std::uint32_t i) const {
    index[i] = i;
    key[i] = weight[i] > 0 ? std::uint64_t{nearest_cell(position[i].y, plane.height)} * plane.width +
                                 nearest_cell(position[i].x, plane.width)
                           : plane.area();
  }
};

struct FindBegins {
  const std::uint64_t* sorted_key;
  std::uint32_t given;
  std::uint32_t* begin;  // [pixels + 1]
  ABN_HD void operator()(std::uint32_t p) const { begin[p] = lower_bound_of(sorted_key, given, p); }
};

struct FetchSamples {
  const std::uint32_t* index;
  const Vec2f* position;
  const float* value;
  std::uint32_t channels;
  float *x, *y, *luminance, *sorted_value;
  ABN_HD void operator()(std::uint32_t to) const {
    const std::uint32_t from = index[to];
    x[to] = position[from].x;
    y[to] = position[from].y;
    const float* source = value + std::size_t{from} * channels;
    for (std::uint32_t c = 0; c < channels; ++c) sorted_value[std::size_t{to} * channels + c] = source[c];
    luminance[to] = sample_luminance(source, channels);
  }
};

struct LuminanceOfSample {
  const float* luminance;
  using Value = double;
  ABN_HD Value operator()(std::uint32_t i) const { return static_cast<double>(luminance[i]); }
};

/// (luminance - mean)^2.
struct SquareOfSample {
  const float* luminance;
  const double* sum;  // of all luminances
  double count;
  using Value = double;
  ABN_HD Value operator()(std::uint32_t i) const {
    const double deviation = static_cast<double>(luminance[i]) - *sum / count;
    return deviation * deviation;
  }
};

template <class Device>
class BinsEngine {
 public:
  explicit BinsEngine(Device& device) : device_(device) {}

  /// Sorts the samples of which `usable` > 0 have a weight > 0. What samples() says is then valid up to the next call.
  void sort(std::span<const Vec2f> position, std::span<const float> value, std::span<const float> weight,
            std::uint32_t channels, Extent plane, std::uint32_t usable) {
    const auto given = static_cast<std::uint32_t>(position.size());
    assert(channels >= 1 && value.size() == position.size() * channels && weight.size() == position.size());
    plane_ = plane;
    channels_ = channels;
    usable_ = usable;
    position_.reset(given);
    position_.upload(position);
    value_.reset(value.size());
    value_.upload(value);
    weight_.reset(given);
    weight_.upload(weight);
    for (auto* buffer : {&key_, &sorted_key_}) buffer->reset(given);
    for (auto* buffer : {&index_, &sorted_index_}) buffer->reset(given);
    begin_.reset(plane.area() + 1);
    for (auto* buffer : {&x_, &y_, &luminance_}) buffer->reset(usable);
    sorted_value_.reset(std::size_t{usable} * channels);
    device_.prepare_sort(given);
    device_.launch(given, FindPixels{plane, position_.data(), weight_.data(), key_.data(), index_.data()});
    device_.sort_pairs(key_.data(), sorted_key_.data(), index_.data(), sorted_index_.data(), given);
    device_.launch(static_cast<std::uint32_t>(plane.area() + 1), FindBegins{sorted_key_.data(), given, begin_.data()});
    device_.launch(usable, FetchSamples{sorted_index_.data(), position_.data(), value_.data(), channels, x_.data(),
                                        y_.data(), luminance_.data(), sorted_value_.data()});
    add_up(LuminanceOfSample{luminance_.data()}, sum_);
    add_up(SquareOfSample{luminance_.data(), sum_.data(), static_cast<double>(usable)}, squares_);
  }

  BinnedSamples samples() const {
    return {plane_, channels_, x_.data(), y_.data(), luminance_.data(), sorted_value_.data(), begin_.data()};
  }
  std::uint32_t count() const { return usable_; }
  /// On the device: the sum of (luminance - mean)^2, in the order of fixed_sum.h.
  const double* luminance_squares() const { return squares_.data(); }
  double luminance_squares_on_host() const { return squares_.download(1)[0]; }

 private:
  template <class T>
  using Buffer = typename Device::template Buffer<T>;

  static std::uint32_t chunks(std::uint32_t n) {
    return static_cast<std::uint32_t>((std::uint64_t{n} + sph::sum_chunk - 1) / sph::sum_chunk);
  }

  template <class Load>
  void add_up(const Load& load, Buffer<double>& total) {
    total.reset(1);
    std::uint32_t n = chunks(usable_);
    for (auto* buffer : {&partial_, &other_partial_}) buffer->reset(n);
    Buffer<double>* from = &partial_;
    Buffer<double>* to = &other_partial_;
    device_.launch_blocks(n, SumChunks<Load>{nullptr, load, usable_, n == 1 ? total.data() : from->data()});
    while (n > 1) {
      const std::uint32_t fewer = chunks(n);
      device_.launch_blocks(fewer,
                            SumChunks<SumOfChunk>{nullptr, {from->data()}, n, fewer == 1 ? total.data() : to->data()});
      std::swap(from, to);
      n = fewer;
    }
  }

  Device& device_;
  Extent plane_;
  std::uint32_t channels_ = 1, usable_ = 0;
  Buffer<Vec2f> position_;
  Buffer<float> value_, weight_, x_, y_, luminance_, sorted_value_;
  Buffer<std::uint64_t> key_, sorted_key_;
  Buffer<std::uint32_t> index_, sorted_index_, begin_;
  Buffer<double> partial_, other_partial_, sum_, squares_;
};

}  // namespace abn::sph_cuda
