// The transfer curve of sRGB, both ways, exactly as IEC 61966-2-1 states it.
#pragma once

#include <cmath>

namespace abn::harness {

/// Linear light of an sRGB-encoded value (1 = white). Negative values use the linear segment, values above 1 the
/// power segment continued; NaN stays NaN. IEC 61966-2-1:1999.
inline float srgb_to_linear(float encoded) {
  return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

/// sRGB encoding of linear light (1 = white); the inverse of srgb_to_linear up to rounding. IEC 61966-2-1:1999.
inline float linear_to_srgb(float linear) {
  return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
}

}  // namespace abn::harness
