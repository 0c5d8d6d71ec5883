// The right answer where a pixel is more than the average over its own square.
#pragma once

#include "harness/image.h"
#include "harness/integrand.h"
#include "harness/truth.h"
#include "sampling/pixel_filter.h"

namespace abn::harness {

/// The integral of the interpolated `image` times `filter` around the centre of every pixel of a plane of size `to`:
/// any size ratio, both ways. Beyond its border the image continues with its border texels, so these gather what the
/// filter weighs there. The weight of a texel is a difference of the filter's integral in each direction (bilinear:
/// Gauss quadrature of a hat times the filter); for discs it is quadrature along the circle; the error is that of
/// rounding to float. Sums in double, bit-identical for any number of threads; a constant image is reproduced. Throws
/// ConfigError for a disc and bilinear interpolation.
GroundTruth filtered_truth(const Image& image, Extent to, const PixelFilter& filter,
                           Interpolation interpolation = Interpolation::nearest);

}  // namespace abn::harness
