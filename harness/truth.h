// The right answer: what every pixel would be with infinitely many samples.
#pragma once

#include <cstdint>
#include <string>

#include "harness/image.h"
#include "harness/integrand.h"

namespace abn::harness {

struct GroundTruth {
  Image image;
  Image standard_error;  // of every pixel and channel of `image`; empty if the truth is exact
  std::string method;    // "exact" or "monte_carlo:SPP"
};

/// Root mean square over pixels and channels of a truth's standard error: what the truth itself adds to every RMSE
/// measured against it. 0 if the truth is exact.
double standard_error_rms(const GroundTruth& truth);

/// The mean of the interpolated `image` over every pixel of a plane of size `to`: closed form, any size ratio, both
/// ways. Each axis has integer weights (areas of texels, or of the bilinear hats, inside a pixel, in fractions of a
/// texel), so that only the final sum in double and its rounding to float are inexact. Bit-identical for any number of
/// threads; a constant image is reproduced exactly.
GroundTruth exact_truth(const Image& image, Extent to, Interpolation interpolation = Interpolation::nearest);

/// The mean of `spp` uniformly random samples in every pixel of the integrand's plane, with its standard error
/// sqrt(unbiased variance / spp): the truth of the thesis (spp = 1000). Uses memory for one pixel at a time and thread;
/// the samples of a pixel depend on (seed, pixel) only. Throws ConfigError for spp < 2, which has no standard error.
GroundTruth monte_carlo_truth(const Integrand& integrand, std::uint64_t spp, std::uint64_t seed);

namespace detail {
/// exact_truth by the weights alone, without the shortcut for whole ratios: its independent twin in tests.
Image weighted_mean(const Image& image, Extent to, Interpolation interpolation);
/// exact_truth of piecewise-constant texels where both sides of `image` are multiples of those of `to`.
Image block_mean(const Image& image, Extent to);
}  // namespace detail

}  // namespace abn::harness
