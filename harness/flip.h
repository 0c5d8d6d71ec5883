// FLIP: the difference a viewer sees when two images alternate on a screen.
//
// LDR-FLIP: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild 2020, "FLIP: A Difference Evaluator for
// Alternating Images". HDR-FLIP: Andersson, Nilsson, Shirley, Akenine-Moller 2021, "Visualizing Errors in Rendered High
// Dynamic Range Images". Filters are separable as in version 1.6 of the authors' tool; borders repeat the edge texel.
#pragma once

#include "harness/image.h"
#include "sampling/grid.h"

namespace abn::harness {

/// Pixels per degree of visual angle: 0.7 m from a screen 0.7 m and 3840 pixels wide, the authors' default (67.02).
inline constexpr double flip_pixels_per_degree = 3840.0 * 3.14159265358979323846 / 180.0;

struct FlipResult {
  Grid<float> map;  // [0,1] per pixel, 0 = no visible difference
  double mean = 0;  // over all pixels
};

/// Exposures of HDR-FLIP [stops].
struct ExposureRange {
  double start = 0;
  double stop = 0;
  int count = 2;
};

/// FLIP of two images on a display: linear light of 1 (grey, replicated) or 3 channels, clamped to [0,1]. Symmetric.
/// The paper takes sRGB-encoded input and decodes it first; here it is decoded already. NaN in an image gives NaN
/// around it. Precondition: equal size and channels (the metric table checks it).
FlipResult ldr_flip(const Image& test, const Image& reference, double pixels_per_degree = flip_pixels_per_degree);

/// The largest LDR-FLIP over a range of exposures that shows the reference from its highlights to its median, each
/// tone-mapped by the ACES fit. Not symmetric. Same preconditions as ldr_flip; negative values count as black.
FlipResult hdr_flip(const Image& test, const Image& reference, double pixels_per_degree = flip_pixels_per_degree);

/// The exposures hdr_flip uses: from log2(x/max) to log2(x/median) of the reference's luminance, where the ACES fit
/// maps x to .85; max(2, ceil(stop-start)) of them.
///
/// Deviations, where the paper's formula has no finite value: a median of 0 is replaced by the median of the positive
/// luminances; a reference without any light takes its exposures from the test image, so that a difference stays
/// visible; if that is black too the only exposure is 0. The range is at most 32 stops.
ExposureRange flip_exposures(const Image& test, const Image& reference);

}  // namespace abn::harness
