// The mean of a picture, corrected by those of its samples that were placed without a look at the image.
#pragma once

#include <cstdint>

#include "harness/film.h"

namespace abn::harness {

/// How far the mean must be off, in standard errors, before it is corrected.
inline constexpr double calibration_significance = 2;

/// Takes the bias out of the mean of an adaptive picture (the difference estimator of survey sampling: Deville and
/// Sarndal 1992, "Calibration estimators in survey sampling").
///
/// Samples that decide where others go are used again: where they hit a thin line the others correct their too large
/// mean, where they miss it nobody looks and the too small one stays. The first `uniform` samples of the film know
/// nothing of that: the mean of what they differ from the picture's pixels is what the picture's mean is off, whatever
/// was done afterwards. If the luminance's is more than twice its standard error (from the scatter of the differences,
/// which takes stratified samples for independent ones and so errs towards no correction), the picture is shifted by
/// it, per channel, in proportion to the estimated error variance of the pixels, smoothed by a Gaussian of 8 px: what
/// was missed lies near what was seen, and flat parts stay as they are.
///
/// Preconditions: the film keeps its samples, uniform <= their number. Does nothing without estimated errors, for
/// uniform < 2, and where all samples are uniform. Returns by how much the mean luminance moved.
double calibrate(Developed& developed, const Film& film, std::uint64_t uniform);

}  // namespace abn::harness
