// What a pixel's own statistics say of the error of its mean.
#pragma once

#include "sampling/grid.h"
#include "sampling/sampler.h"

namespace abn::harness {

/// sqrt(variance / count) of every pixel's luminance: the standard error that the mean of independent samples has.
/// Stratified and blue-noise samples do better, by a factor that their values alone do not tell (about .55 for
/// sph_blue_noise at 6 samples per pixel on edges). Pixels of fewer than two samples, whose variance is unknown, take
/// the mean of their neighbours'; empty if no pixel has two. [width*height]
Grid<float> independent_standard_error(const Grid<PixelStats>& pixels);

}  // namespace abn::harness
