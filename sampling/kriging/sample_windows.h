// Which pixel a sample belongs to, and which samples lie around a pixel: for the host and a device alike.
#pragma once

#include <cstdint>

#include "sampling/hd.h"
#include "sampling/vec.h"

namespace abn {

/// The cell of a coordinate on an axis of `count` cells, the nearest one if it lies outside; NaN becomes 0.
ABN_HD inline std::uint32_t nearest_cell(float position, std::uint32_t count) {
  if (!(position > 0)) return 0;
  return position < static_cast<float>(count) ? static_cast<std::uint32_t>(position) : count - 1;
}

/// How far a coordinate lies outside of [corner, corner + 1] [px].
ABN_HD inline float distance_outside(float corner, float position) {
  const float before = corner - position;
  const float behind = position - corner - 1;
  const float most = before < behind ? behind : before;
  return most < 0 ? 0.0F : most;
}

/// The pixels that hold the samples within a margin of a pixel's square.
struct PixelWindow {
  std::uint32_t first_x, last_x, first_y, last_y;
};

ABN_HD inline PixelWindow window_around(std::uint32_t x, std::uint32_t y, float margin, Extent plane) {
  const auto left = static_cast<float>(x);
  const auto top = static_cast<float>(y);
  return {nearest_cell(left - margin, plane.width), nearest_cell(left + 1 + margin, plane.width),
          nearest_cell(top - margin, plane.height), nearest_cell(top + 1 + margin, plane.height)};
}

/// Rec. 709 luminance of a sample with 1 or 3 channels.
ABN_HD inline float sample_luminance(const float* value, std::uint32_t channels) {
  return channels == 1 ? value[0] : 0.2126F * value[0] + 0.7152F * value[1] + 0.0722F * value[2];
}

}  // namespace abn
