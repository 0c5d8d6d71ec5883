// The systems of ordinary kriging, many at a time: one in each lane.
#pragma once

#include <cstddef>
#include <vector>

namespace abn::harness {

inline constexpr std::size_t kriging_lanes = 16;

/// Systems of at most `count` points, one per lane; those of fewer points end in points that are not live. The
/// vectors are [count * kriging_lanes], point by point.
struct KrigingBatch {
  std::size_t count = 0;
  std::vector<float> x, y;      // relative to the pixel's corner [px]
  std::vector<float> diagonal;  // sill + nugget
  std::vector<float> value;     // the values whose scale is wanted, about their mean
  std::vector<float> live;      // 1, or 0 for a point that is not there
  std::vector<float> weight;    // out: of every point in the estimate of the pixel's mean, sum 1
  float sill[kriging_lanes] = {};
  float variance[kriging_lanes] = {};  // out: of the estimate's error, for a variogram of scale 1
  float squares[kriging_lanes] = {};   // out: squared residuals; their expectation is the scale times `degrees`
  float degrees[kriging_lanes] = {};   // out: points less what was fitted: 3 for a linear trend, 1 for too few points
  float trend[kriging_lanes] = {};     // out: what the fitted trend contributes to the estimate's error

  std::vector<float> matrix, right;  // scratch

  /// Empties the batch and makes room.
  void resize(std::size_t points);
};

/// Solves all lanes. Covariance of two points: sill - |r|; of a point with the pixel: the mean of that over the pixel.
void solve_kriging(KrigingBatch& batch);

}  // namespace abn::harness
