// The self-normalised mean: samples weighted by the inverse of their own density.
#pragma once

#include <vector>

#include "harness/film.h"
#include "harness/sample_bins.h"

namespace abn::harness {

/// The density [1/px^2] around every sample, estimated from the samples alone: a kernel sum (Wendland C2, with the
/// sample itself) whose support reaches to the twelfth-nearest sample, as smoothed particle hydrodynamics does it
/// (Monaghan 1992). Samples are mirrored at the borders of the plane, so that there is no drop. A heap of more than 12
/// coincident samples gets the support of 1e-4 px. [samples]
std::vector<float> sample_densities(const SampleBins& bins);

/// The row `density`: sum w f / sum w over each pixel's samples with w = 1/density, which takes the bias out of the
/// mean where the density varies inside a pixel (self-normalised importance sampling: Hesterberg 1995; its own bias is
/// of the order 1/samples). Exact for constants. Pixels without samples are filled by fill_empty() and counted.
Developed density_weighted(const Film& film);

}  // namespace abn::harness
