// How dense the particles of a size field are in each tile of their cells (cells.h).
#pragma once

#include <cstdint>
#include <vector>

#include "sampling/hd.h"
#include "sampling/sph/size_field.h"

namespace abn::sph {

/// A raster of rectangles over the torus, each a share of a square between four cell centres: there the integral of
/// s^-2 is known, so that a spike counts as what it holds and not as its smallest s.
struct TileRectangles {
  FieldView<double> field;
  std::uint32_t columns = 1, rows = 1;  // from the first cell's centre on

  /// s at the upper left corner of a rectangle; x <= columns, y <= rows.
  ABN_HD double corner(std::uint32_t x, std::uint32_t y) const {
    const double u = place(x, columns, field.width);
    const double v = place(y, rows, field.height);
    return sample_size(field, BilinearPlace<double>(field.width, field.height, u, v)).size;
  }
  /// The mean of s^-2 over a rectangle.
  ABN_HD double mean(std::uint32_t x, std::uint32_t y) const {
    return mean_inverse_square(corner(x, y), corner(x + 1, y), corner(x, y + 1), corner(x + 1, y + 1));
  }

 private:
  ABN_HD static double place(std::uint32_t i, std::uint32_t count, std::uint32_t cells) {
    return wrap(static_cast<double>(i) / count * cells + 0.5, static_cast<double>(cells));
  }
};

/// Which rectangles belong to which tile: a tile has some columns and some rows of them. Those of the first tile may
/// lie on both sides of the seam.
struct TileLayout {
  std::uint32_t tiles_x = 1, tiles_y = 1;
  std::vector<std::uint32_t> tile_of_column, tile_of_row;  // [rectangles along the axis]
};
TileLayout lay_out_tiles(const SizeField& field);

/// The mean of s^-2 over every tile, row by row; the field is not uniform. In every tile its rectangles are added up
/// row by row.
std::vector<double> tile_densities(const SizeField& field);

}  // namespace abn::sph
