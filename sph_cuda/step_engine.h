// find_steps() of harness/edge_reconstruction.h on a device of relaxation.h.
#pragma once

#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sampling/kriging/pixel_estimates.h"
#include "sampling/kriging/step_rules.h"
#include "sph_cuda/bins_engine.h"
#include "sph_cuda/step_candidates.h"
#include "sph_cuda/step_search.h"

namespace abn::sph_cuda {

template <class Device>
class StepEngine {
 public:
  explicit StepEngine(Device& device) : device_(device) {}

  /// To be called once for every set of samples, which `bins` has sorted and must keep.
  void look_at(const BinsEngine<Device>& bins, const EdgeOptions& options) {
    assert(options.margin < 1);  // FindCandidates looks no farther
    samples_ = bins.samples();
    limits_ = {options, bins.luminance_squares(), static_cast<double>(bins.count())};
    if (cosine_.size() == 0) {
      std::vector<float> cosine;
      std::vector<float> sine;
      for (std::uint32_t a = 0; a < step_rules::angles; ++a) {
        cosine.push_back(static_cast<float>(std::cos(step_rules::coarse_angle(a))));
        sine.push_back(static_cast<float>(std::sin(step_rules::coarse_angle(a))));
      }
      for (auto* buffer : {&cosine_, &sine_}) buffer->reset(step_rules::angles);
      cosine_.upload(cosine);
      sine_.upload(sine);
    }
    const auto pixels = static_cast<std::uint32_t>(samples_.plane.area());
    range_.reset(pixels);
    device_.launch(pixels, FindRange{samples_, range_.data()});
  }

  /// Writes the steps of the pixels [first, first + pixels); `step` is [all pixels], on the device.
  void find(std::uint32_t first, std::uint32_t pixels, PixelStep* step) {
    for (auto* buffer : {&room_, &start_, &is_one_, &place_}) buffer->reset(std::size_t{pixels} + 1);
    number_.reset(pixels);
    totals_.reset(2);
    device_.prepare_sums(pixels + 1);
    device_.launch(pixels + 1,
                   FindCandidates{samples_, limits_, range_.data(), first, pixels, step, room_.data(), is_one_.data()});
    device_.exclusive_sum(room_.data(), start_.data(), pixels + 1);
    device_.exclusive_sum(is_one_.data(), place_.data(), pixels + 1);
    device_.launch(pixels + 1, ListCandidates{is_one_.data(), place_.data(), start_.data(), pixels, number_.data(),
                                              totals_.data()});
    const std::vector<std::uint32_t> totals = totals_.download(2);
    member_.reset(totals[1]);
    sorted_.reset(totals[1]);
    device_.launch_blocks(totals[0], FindSteps{samples_, limits_, first, number_.data(), start_.data(), member_.data(),
                                               sorted_.data(), cosine_.data(), sine_.data(), step});
  }

 private:
  template <class T>
  using Buffer = typename Device::template Buffer<T>;

  Device& device_;
  BinnedSamples samples_{};
  StepLimits limits_{};
  Buffer<LuminanceRange> range_;
  Buffer<std::uint32_t> room_, start_, is_one_, place_, number_, totals_, member_;
  Buffer<float> sorted_, cosine_, sine_;
};

}  // namespace abn::sph_cuda
