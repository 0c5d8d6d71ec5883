// Filtering by sample sharing: every sample counts in all pixels whose filter covers it.
#pragma once

#include "harness/film.h"
#include "sampling/pixel_filter.h"

namespace abn::harness {

/// Every pixel as sum w f v / sum w f over the film's samples (v value, w weight > 0, f the filter at the sample as
/// seen from the pixel's centre): normalised by the actual weights, so that constants are exact.
///
/// There are no samples beyond the image, where filtered_truth() repeats the border texels. A sample at a distance d
/// inside a border therefore also stands for the distance d s beyond it, with s times the weight, s = spp^(1/3)
/// (spp >= 1 the samples per pixel): the more samples there are, the nearer to the border are those that stand for it,
/// so that the result approaches that truth. Filters cut off at the border instead leave an error there that no number
/// of samples removes: more than all noise from a radius of 2 px on.
///
/// Where negative lobes leave sum w f below a tenth of sum w |f| the quotient would blow noise up: such a pixel, and
/// one that no sample reaches, is filled by fill_empty() and counted. Precondition: the film kept its samples.
/// `by_density`: w is divided by the density of the samples around (sample_densities()), without which an adaptive set
/// would count most where it is densest. Bit-identical for any number of threads. Pharr, Jakob, Humphreys 2016,
/// Physically Based Rendering, 7.8; the border is ours.
Developed share_samples(const Film& film, const PixelFilter& filter, bool by_density = false);

}  // namespace abn::harness
