// Variance maps of the plane from what the pixels' samples or a guide say.
#pragma once

#include "sampling/grid.h"
#include "sampling/sampler.h"

namespace abn {

/// Variance of every pixel's samples, m2 / count: the population variance, because the mapping of thesis eq. 4.1
/// divides by 1/4, its largest value for data in [0,1]. 0 where fewer than two samples are known, as in the thesis, and
/// where overflow made it not finite. [width*height], >= 0, finite. A grid of another size than `plane` says nothing:
/// all 0.
Grid<float> pixel_variance(const Grid<PixelStats>& pixels, Extent plane);

/// `values` >= 0 over the plane at another resolution: the mean of the cells that a cell of the result meets, those
/// that are not finite left out (0 if all are).
Grid<float> resampled(const Grid<float>& values, Extent size);

/// Largest value within `radius` cells in each direction (a square).
Grid<float> dilated(const Grid<float>& values, int radius);

}  // namespace abn
