// The maps that an adaptive plane follows, on a device of relaxation.h: the same as allocation.h and drivers.h.
#pragma once

#include <algorithm>
#include <cstdint>

#include "sampling/adaptive/map_rules.h"
#include "sampling/rng.h"
#include "sampling/vec.h"
#include "sph_cuda/kernels.h"
#include "sph_cuda/map_kernels.h"
#include "sph_cuda/prefix.h"
#include "sph_cuda/sums.h"

namespace abn::sph_cuda {

/// All maps are [cells] on the device, row by row.
template <class Device>
class MapEngine {
 public:
  explicit MapEngine(Device& device) : device_(device) {}

  void reset(Extent plane, Extent map) {
    plane_ = plane;
    map_ = map;
    cells_ = static_cast<std::uint32_t>(map.area());
    scratch_.reset(cells_);
    sum_.reset(cells_);
    other_sum_.reset(cells_);
    range_.reset(cells_);
    search_.reset(1);
  }

  void fill(float* map, float value) { device_.launch(cells_, Fill<float>{map, value}); }

  void blur(float* map, int passes) {
    for (int pass = 0; pass < passes; ++pass) {
      device_.launch(cells_, BlurAlong{map, scratch_.data(), map_.width});
      device_.launch(cells_, BlurAcross{scratch_.data(), map, map_.width, cells_});
    }
  }

  /// both_drivers(), into the first one.
  void mix(float* a, const float* b, double exponent, double share) {
    sum_.find(device_, nullptr, cells_, LoadPower{a, exponent});
    other_sum_.find(device_, nullptr, cells_, LoadPower{b, exponent});
    device_.launch(cells_,
                   MixDrivers{a, b, sum_.total(), other_sum_.total(), static_cast<double>(cells_), share, exponent});
  }

  double uniform_share(const float* driver) {
    sum_.find(device_, nullptr, cells_, LoadRoot{driver});
    other_sum_.find(device_, nullptr, cells_, LoadCell{driver});
    const double mean = other_sum_.read();
    if (!(mean > 0)) return 1;
    const auto count = static_cast<double>(cells_);
    const double roots = sum_.read() / count;
    return roots * roots / (mean / count);
  }

  /// density_weights().
  void weigh(const float* driver, double floor, double exponent, float* weight) {
    sum_.find(device_, nullptr, cells_, LoadCell{driver});
    device_.launch(cells_, WeighDriver{driver, sum_.total(), static_cast<double>(cells_), floor, exponent, weight});
  }

  /// abn::allocate().
  void allocate(const float* weight, const float* have, double total, double most, float* density) {
    const double cell_area = static_cast<double>(plane_.area()) / static_cast<double>(map_.area());
    range_.find(device_, nullptr, cells_, LoadRange{weight, have});
    device_.launch(1, BeginSearch{search_.data(), range_.total(), total / cell_area, most});
    // Once for everything full, then the bisection; when it is done sooner, the rest does nothing.
    const auto look = [&] {
      for (int k = 0; k < looks_per_batch; ++k) {
        sum_.find(device_, nullptr, cells_, LoadFilled{search_.data(), weight, have});
        device_.launch(1, TakeSum{search_.data(), sum_.total()});
      }
    };
    while (!search_.download(1)[0].done) look();
    device_.launch(cells_, FillMap{search_.data(), weight, have, density});
  }

  /// draw_deficit(), into point [count].
  void draw(const float* wanted, const float* have, std::uint64_t count, std::uint64_t seed, std::uint32_t stream,
            Vec2f* point) {
    const StripOrder order(map_);
    prefix_.find(device_, cells_, LoadDeficit{wanted, have, order, map_.width});
    double total = prefix_.total(cells_);
    if (!(total > 0)) {
      prefix_.find(device_, cells_, LoadOne{});
      total = prefix_.total(cells_);
    }
    const DeficitDraw draw{plane_, map_, count, total, double{Rng(seed, stream, count).uniform()}, seed, stream};
    device_.launch(cells_, DealPoints{draw, order, prefix_.before(), point});
  }

  /// The relative spacing for a density whose mean is `mean_density` [1/px^2].
  void find_spacing(const float* density, double mean_density, float* spacing) {
    device_.launch(cells_, FindSpacing{density, least_share_of_mean * static_cast<float>(mean_density), spacing});
  }

 private:
  template <class T>
  using Buffer = typename Device::template Buffer<T>;

  static constexpr int looks_per_batch = 14;

  Device& device_;
  Extent plane_, map_;
  std::uint32_t cells_ = 0;
  Buffer<float> scratch_;
  Sum<Device, SumOfChunk> sum_, other_sum_;
  Sum<Device, LoadRangeOfChunk> range_;
  Buffer<FillSearch> search_;
  Prefix<Device> prefix_;
};

}  // namespace abn::sph_cuda
