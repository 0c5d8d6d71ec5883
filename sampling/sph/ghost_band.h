// Where the ring of ghosts is drawn: on the ring and on a band as wide inside each wall, whose inner half is held.
#pragma once

#include <cstdint>

#include "sampling/hd.h"
#include "sampling/sph/problem.h"

namespace abn::sph {

struct GhostBand {
  double length_x = 1, length_y = 1;  // of the torus [d]
  double plane_x = 1, plane_y = 1;
  double margin_x = 1, margin_y = 1;  // width of the ring and of the band
  FieldView<double> field;            // cells null = uniform

  ABN_HD bool in_plane(double x, double y) const { return x < plane_x && y < plane_y; }
  /// In band widths: > 0 inside the plane, 0 at the wall.
  ABN_HD double depth_inside(double x, double y) const {
    const double depth_x = lesser(x, plane_x - x) / margin_x;
    const double depth_y = lesser(y, plane_y - y) / margin_y;
    return lesser(depth_x, depth_y);
  }
  /// Whether a particle stays where it is drawn.
  ABN_HD bool held(double x, double y) const { return in_plane(x, y) && depth_inside(x, y) > 1; }
  /// s^-2 on the band and the ring, 0 inside of them; u and v in shares of the torus.
  ABN_HD double density(double u, double v) const {
    const double x = u * length_x;
    const double y = v * length_y;
    if (in_plane(x, y) && depth_inside(x, y) > 2) return 0;
    if (field.cells == nullptr) return 1;
    const BilinearPlace<double> place(field.width, field.height, u * field.width, v * field.height);
    const double size = sample_size(field, place).size;
    return 1 / (size * size);
  }

 private:
  ABN_HD static double lesser(double a, double b) { return b < a ? b : a; }
};

/// The problem has its field, but no ring. cells: the field's raster, for whoever looks at the band; null if uniform.
GhostBand ghost_band(const Problem& problem, const FieldCell* cells);

/// A grid finer than the band, for the expected number of particles by the midpoint rule. The sums of a row's segments
/// are added up first, and then those of the rows.
struct BandGrid {
  static constexpr std::uint32_t segment = 64;  // columns that are added up one after the other
  std::uint32_t columns = 1, rows = 1;

  explicit BandGrid(const SizeField& field);
  ABN_HD std::uint32_t segments() const { return (columns + segment - 1) / segment; }  // of a row
  ABN_HD double density(const GhostBand& band, std::uint32_t column, std::uint32_t row) const {
    return band.density((column + 0.5) / columns, (row + 0.5) / rows);
  }
  /// The number of particles, from the sum of the densities.
  std::uint64_t particles(const SizeField& field, double sum) const;
};

/// The problem of the band's particles, to be relaxed on a plane that is the torus; none of them is in it yet.
Problem problem_of_band(const Problem& problem);
/// How they are relaxed.
Setup setup_of_band(const Setup& setup, const Problem& problem);

}  // namespace abn::sph
