// What kriging and edge reconstruction find for every pixel, on the host or on a device.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sampling/grid.h"
#include "sampling/vec.h"

namespace abn {

struct KrigingOptions {
  float margin = 0.25F;         // samples within this distance of the pixel count too [px]
  std::size_t wanted = 6;       // the margin grows by 1.6 until there are so many
  double nugget_at_6_spp = .1;  // share of the variogram at distance 0, in units of its value at 1 px; ~ spp^-1/2
};

/// When a step is believed. Looser limits find steps in texture and lose up to a fifth.
struct EdgeOptions {
  float margin = 0.6F;            // of the window around the pixel's square [px]; half of it and 0 are tried too
  double explained = 0.92;        // share of the luminances' variance that two classes must explain
  std::size_t samples = 14;       // at least, in the window
  std::size_t class_samples = 3;  // at least, in either class
  float contrast = 0.02F;         // range of luminances in the window, in standard deviations of the whole film
};

/// What is known of a pixel before errors are told: its kriging variance for a variogram of scale 1, and the sum of
/// squares whose mean over its degrees of freedom estimates that scale.
struct PixelScale {
  float unit_variance = 0;
  float squares = 0;
  float degrees = 0;
  float trend = 0;
  float at_gaps = 1;  // the scale where samples are sparse, relative to that of all samples alike
};

/// A step that is taken out of a pixel's samples before they are kriged, and put back as its integral.
struct PixelStep {
  bool found = false;
  float threshold = 0;          // samples of at least this luminance lie on the upper side
  std::array<float, 3> jump{};  // upper minus lower side, per channel
  float luminance_jump = 0;
  float share = 0;        // of the pixel's area that lies on the upper side
  float share_error = 0;  // its standard deviation
};

/// Every pixel's estimate, before what no sample reaches is filled and errors are told.
struct PixelEstimates {
  std::vector<float> value;        // [pixels * channels]; 0 where no sample is in reach
  Grid<PixelScale> scale;          // its unit_variance is 0 there, and nowhere else
  Grid<PixelStep> step;            // empty if none were looked for
  std::uint64_t samples = 0;       // of weight > 0
  std::uint64_t empty_pixels = 0;  // without a sample of their own
  double luminance_squares = 0;    // of the samples' luminances about their mean, in the order of fixed_sum.h
};

/// The estimates of all pixels of a plane from samples in the order in which they came: their position [px], value
/// [samples * channels] and weight [samples], with a step of every pixel taken out first or without.
using SampleEstimator =
    std::function<PixelEstimates(std::span<const Vec2f> position, std::span<const float> value,
                                 std::span<const float> weight, std::uint32_t channels, Extent plane, bool steps)>;

}  // namespace abn
