// An image in linear light, and nothing about files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sampling/vec.h"

namespace abn::harness {

/// Linear float texels, 1 or 3 channels interleaved (RGB), rows from the top.
struct Image {
  Extent size;
  std::uint32_t channels = 1;
  std::vector<float> texels;  // [width*height*channels]

  Image() = default;
  Image(Extent extent, std::uint32_t channel_count)
      : size(extent), channels(channel_count), texels(extent.area() * channel_count) {}

  std::size_t index(std::uint32_t x, std::uint32_t y) const { return (std::size_t{y} * size.width + x) * channels; }
  float* texel(std::uint32_t x, std::uint32_t y) { return texels.data() + index(x, y); }              // [channels]
  const float* texel(std::uint32_t x, std::uint32_t y) const { return texels.data() + index(x, y); }  // [channels]
  std::span<const float> row(std::uint32_t y) const {
    return {texels.data() + index(0, y), std::size_t{size.width} * channels};
  }
};

/// Rec. 709 luminance of a linear texel with 1 or 3 channels.
inline float luminance(const float* texel, std::uint32_t channels) {
  return channels == 1 ? texel[0] : 0.2126F * texel[0] + 0.7152F * texel[1] + 0.0722F * texel[2];
}

}  // namespace abn::harness
