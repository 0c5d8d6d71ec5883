// How far error estimates made without the truth can be trusted: the estimate against the true error, bin by bin.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "harness/image.h"
#include "harness/picture.h"
#include "harness/reconstruction.h"
#include "sampling/grid.h"

namespace abn::harness {

/// Pixels of about equal estimated error.
struct ReliabilityBin {
  std::size_t pixels = 0;
  double estimated = 0;      // root mean square of their estimated errors [linear luminance]
  double actual = 0;         // root mean square of their true errors [linear luminance]
  double low = 0, high = 0;  // 95 % interval of `actual` by the central limit theorem; low >= 0
};

/// The reliability curve of an error map, and what it amounts to. All errors are of Rec. 709 luminance.
struct Reliability {
  std::vector<ReliabilityBin> bins;  // by rising estimate, of equal count (to one)
  double estimated_rmse = 0;         // over all pixels
  double true_rmse = 0;              // over all pixels

  /// Estimated RMSE / true RMSE; 1 = right on the whole, below 1 = too hopeful. NaN if the true one is 0.
  double rmse_ratio() const;
  /// The largest factor, one way or the other, between estimate and truth of a bin that matters: one that holds at
  /// least 1 % of the squared errors, estimated or true. 1 if none does; infinite where one of the two is 0.
  double worst_bin_factor() const;
  /// Root mean square of log2(true / estimated) over the same bins, weighted by the mean of the two shares: 0 = every
  /// bin on the diagonal, 1 = a factor of 2 as a rule.
  double log2_deviation() const;
};

/// Sorts the pixels by `standard_error` (equal ones by their place in the image) into `bins` bins and compares with
/// |luminance of test - luminance of truth|. Pixels with a value that is not finite are left out; there are fewer bins
/// where there are fewer pixels. Throws ConfigError when sizes or channels differ.
Reliability reliability(const Grid<float>& standard_error, const Image& test, const Image& truth,
                        std::size_t bins = 20);

/// True against estimated error of the bins, both logarithmic, with the 95 % intervals, the diagonal of a perfect
/// estimate and the lines of a factor 2 around it. Bins with an error of 0 have no place there; the title says how
/// many.
Picture draw_reliability(const Reliability& curve, const std::string& title);

/// "pixels,estimated,true,true_low,true_high", one line per bin, 9 digits.
std::string reliability_csv(const Reliability& curve);

/// Whether a reconstruction estimates its errors: asked of a small film.
bool estimates_errors(const Reconstruction& reconstruction);

}  // namespace abn::harness
