// Structural similarity.
#pragma once

#include "harness/image.h"
#include "sampling/grid.h"

namespace abn::harness {

struct SimilarityResult {
  Grid<float> map;  // [-1,1] per pixel, mean over channels; 1 = equal
  double mean = 0;  // over pixels and channels
};

/// SSIM of the sRGB-encoded values of two linear images, dynamic range 1, with Gaussian windows of 11x11 pixels and
/// sigma 1.5, K1 = .01, K2 = .03, borders mirrored; per channel, then averaged (Wang, Bovik, Sheikh, Simoncelli 2004).
/// The same definition as OpenCV's QualitySSIM, in double precision. Values above 1 follow the continued sRGB curve.
/// Precondition: equal size and channels.
SimilarityResult structural_similarity(const Image& test, const Image& reference);

}  // namespace abn::harness
