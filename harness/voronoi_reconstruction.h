// Samples weighted by the areas of their Voronoi cells inside the pixel.
#pragma once

#include "harness/film.h"

namespace abn::harness {

/// The row `voronoi`: the integral over the pixel of the nearest sample's value, sum area * f with the exact area of
/// every cell inside the pixel, whichever pixel its sample lies in.
///
/// A pixel's square is clipped by the bisectors between samples, in double; large sets are first divided into
/// quadrants, where a sample can only own something if it is closer to the quadrant than every sample is at most. Of
/// coincident samples the first counts. Exact for constants, not for linear functions. Pixels with no sample within
/// 6.7 px are filled by fill_empty(); empty_pixels counts those without a sample of their own.
Developed voronoi(const Film& film);

}  // namespace abn::harness
