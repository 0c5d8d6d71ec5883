// Ordinary kriging of the pixel integral: the best linear unbiased estimate under a linear variogram.
//
// Matheron 1963, "Principles of geostatistics"; Cressie 1993, "Statistics for spatial data", sections 3.2 and 3.4
// (block kriging, variance). Restricted likelihood of the scale: Patterson and Thompson 1971.
#pragma once

#include <functional>

#include "harness/film.h"
#include "harness/sample_bins.h"
#include "sampling/kriging/pixel_estimates.h"

namespace abn::harness {

/// The estimates of a film's pixels from its kept samples, with steps or without, in place of what the CPU would do:
/// where a GPU does it.
using EstimatePixels = std::function<PixelEstimates(const Film& film, bool steps)>;

/// An estimator of samples given the kept samples of a film; null stays null.
EstimatePixels estimate_kept(SampleEstimator on_samples);

/// Kriging of every pixel from the samples in it and within the margin, variogram |r| + nugget. The weights depend on
/// positions only, one solve per pixel serves all channels.
///
/// Exact for constants. Not exact for linear functions (for that, universal kriging with a drift would be needed):
/// their error is that of the plain mean times about .2. Weights may be negative, so may estimates. Of many samples the
/// 110 nearest count, and a pixel with more than 98 of its own is estimated from the means of its 9 x 9 cells. A pixel
/// with no sample in reach (6.7 px) is filled by fill_empty(); empty_pixels counts those without a sample of their own.
///
/// standard_error: the kriging variance times the scale of the variogram, plus the square of what a linear trend fitted
/// to the samples contributes. The scale is estimated by restricted maximum likelihood about that trend from the
/// samples of the pixel and its eight neighbours together, so that a pixel whose few samples happen to agree is not
/// called exact, and multiplied by a constant calibrated once. `steps`: one per pixel, or null; the error of a step is
/// that of its area times its height.
///
/// In single precision: weights differ from a solve in double by up to 1e-5; the 5 x 5 quadrature of the covariance
/// with the pixel moves them by up to 4e-3, which costs nothing measurable. Bit-identical for any number of threads and
/// both instruction sets.
Developed krige(const Film& film, const SampleBins& bins, const Grid<PixelStep>* steps = nullptr,
                const KrigingOptions& options = {});

/// The picture of estimates that were made elsewhere from the samples of `film`.
Developed krige(const Film& film, PixelEstimates estimates);

/// The row `kriging`. on_device: null = the CPU.
Developed kriging(const Film& film, const EstimatePixels& on_device = nullptr);

/// The row `kriging_tonemapped`: kriging of x/(1+x) per channel, then inverted, so that one bright sample does not
/// outshine its pixel. Biased towards dark wherever a pixel mixes light and dark, by the curvature of the map (Jensen):
/// measured against the mean of linear light, its error is about twice that of plain kriging on cornell, StillLife and
/// hdri_interior, tone-mapped or not. For fireflies only. standard_error leaves that bias out.
Developed kriging_tonemapped(const Film& film);

}  // namespace abn::harness
