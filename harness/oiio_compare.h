// OpenImageIO's two image comparisons, for readers who know `idiff`.
#pragma once

#include <cstdint>

#include "harness/image.h"

namespace abn::harness {

/// ImageBufAlgo::compare as `idiff` prints it; over pixels and channels, in linear light.
struct ThresholdComparison {
  double mean_error = 0;
  double rms_error = 0;
  double psnr = 0;  // [dB], +inf for equal images
  double max_error = 0;
  std::uint32_t max_x = 0;  // where the largest error is [px]
  std::uint32_t max_y = 0;
  std::uint32_t max_channel = 0;
  std::uint64_t warnings = 0;  // pixels with a value that differs by more than the warning threshold
  std::uint64_t failures = 0;  // the same for the failure threshold
};

/// Counts the pixels of two images that differ by more than the thresholds (`idiff -fail -warn`; its defaults here).
/// Throws ConfigError when sizes or channels differ.
ThresholdComparison compare_thresholds(const Image& test, const Image& reference, float failure_threshold = 1e-6F,
                                       float warning_threshold = 1e-6F);

/// The perceptual comparison of Yee 2004 as ImageBufAlgo::compare_Yee implements it (`idiff -p`).
struct PerceptualComparison {
  std::uint64_t failures = 0;  // pixels a viewer would tell apart
  double max_error = 0;        // largest luminance difference where it failed
};

/// Counts the pixels a viewer would tell apart, for a screen of 100 cd/m^2 seen under 45 degrees (OpenImageIO's
/// defaults). Linear light; grey is replicated. compare_Yee leaves its other results unset, so only these two are
/// taken. In version 2.4.7 grey images never fail, however different (measured): a number for
/// colour pictures only. Throws ConfigError when sizes or channels differ.
PerceptualComparison compare_perceptual(const Image& test, const Image& reference);

}  // namespace abn::harness
