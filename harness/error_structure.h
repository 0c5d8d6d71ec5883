// Is an error noise or a pattern? RMSE cannot tell; an eye does at once. Two numbers for it (thesis figs. 3.2 and 3.5).
#pragma once

#include "harness/image.h"

namespace abn::harness {

/// Largest power in the spectrum of the error over the mean power, both of the luminance of test - reference without
/// its mean: a single wave of an n-pixel image gives n/2, white noise about ln(n/2) (10 for 200 x 200), an aliasing
/// pattern much more. Of the largest upper left part whose sides have no prime factor above 5 (200 x 200 is one),
/// because the transform of other sizes is slow (half a minute at 3001 x 2999). 0 if the images are equal. Throws
/// ConfigError when sizes or channels differ.
double spectral_peak(const Image& test, const Image& reference);

/// Mean length of the runs, along rows and along columns, of neighbouring pixels whose luminance errors have the same
/// sign and are larger than half the root mean square error [px]: stairs along an edge give long runs, noise about 2 at
/// most. 0 if the images are equal. Throws ConfigError when sizes or channels differ.
double error_run_length(const Image& test, const Image& reference);

}  // namespace abn::harness
