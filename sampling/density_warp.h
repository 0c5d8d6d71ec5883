// Giving a uniform point set another density.
#pragma once

#include <vector>

#include "sampling/grid.h"
#include "sampling/vec.h"

namespace abn {

/// Maps the unit square onto itself such that uniform points get the density of a raster, constant within each cell: by
/// inversion of the cumulative distribution, first of the rows, then of the columns within the row (pbrt's
/// PiecewiseConstant2D; Devroye 1986, ch. XI). Areas are kept in proportion, so stratified and low-discrepancy
/// points stay evenly spread; distances are not, so Poisson disks become ellipses. Computed in double.
class DensityWarp {
 public:
  /// Takes `8 width height` bytes. Throws ConfigError if a density is negative or not finite, if all are 0, or if a
  /// side is above 2^20 cells.
  explicit DensityWarp(const Grid<float>& density);

  /// The image of `unit` in [0,1)^2, again in [0,1)^2, and never in a cell of density 0.
  Vec2f operator()(Vec2f unit) const;

 private:
  Extent size_;
  std::vector<double> row_ends_;   // [height], cumulative mass of the rows, up to and with the row
  std::vector<double> cell_ends_;  // [width * height], cumulative mass within the row, up to and with the cell
};

}  // namespace abn
