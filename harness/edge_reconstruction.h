// Kriging that knows of edges: a straight step is found in a pixel's samples, integrated by itself, and the rest
// kriged.
#pragma once

#include "harness/film.h"
#include "harness/kriging.h"
#include "harness/sample_bins.h"

namespace abn::harness {

/// The steps of all pixels.
///
/// The samples of a window are split into two classes by the luminance threshold that explains most of their variance
/// (Otsu 1979). If enough is explained and a straight line separates the classes, the share of the pixel on the upper
/// side is its mean over all lines that separate them, each line as likely as any other (uniform in angle and offset,
/// the measure that motions leave alone); share_error is the standard deviation over the same lines. The jump is the
/// difference of the class means. 64 angles, finer around the best one where few separate.
Grid<PixelStep> find_steps(const SampleBins& bins, const EdgeOptions& options = {});

/// The row `edge`: krige() with find_steps(). Exact for constants; the same as kriging where no step is found. For
/// values of a bounded range: in untransformed HDR the classes are lights and everything else. on_device: null = the
/// CPU.
Developed edge(const Film& film, const EstimatePixels& on_device = nullptr);

}  // namespace abn::harness
