// Where two images differ, and by how much.
#pragma once

#include "harness/image.h"
#include "harness/picture.h"
#include "sampling/grid.h"

namespace abn::harness {

/// The difference of two images in linear light, and the ways to look at it.
struct ErrorMap {
  Image difference;  // signed, test - reference, channels as in the images: what is written as float

  /// |difference| x gain per channel, clamped to [0,1] (thesis: gain 10). NaN stays.
  Image amplified(double gain = 10.0) const;

  /// False colour of gain x the mean over channels of |difference|, one pixel each. The mean, because then the average
  /// of the map is the mean absolute error of the table, and a difference in all channels is no larger than it is.
  Picture false_colour_raster(double gain = 10.0) const;

  /// The same as a picture to look at: enlarged to 600 px or more, with a colour bar, its ticks and its unit.
  Picture false_colour_picture(double gain = 10.0) const;

  /// The scale of the two: 0 to 1/gain of linear light.
  static ColourBar colour_bar(double gain = 10.0);
};

/// Throws ConfigError when sizes or channels differ. All functions above throw it for a gain that is not positive and
/// finite.
ErrorMap error_map(const Image& test, const Image& reference);

/// False colour of gain x the errors that were estimated without the truth, one pixel each. Throws ConfigError for a
/// gain that is not positive and finite, or no pixel.
Picture estimated_error_raster(const Grid<float>& standard_error, double gain = 10.0);

/// The same as a picture to look at, on the scale of ErrorMap::false_colour_picture(), labelled as an estimate.
Picture estimated_error_picture(const Grid<float>& standard_error, double gain = 10.0);

}  // namespace abn::harness
