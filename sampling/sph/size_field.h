// The size field s(x): the local spacing relative to the mean spacing d, prepared for an engine.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sampling/grid.h"
#include "sampling/hd.h"
#include "sampling/sph/mean_inverse_square.h"
#include "sampling/sph/model.h"

namespace abn::sph {

/// What a particle reads of the field where it is.
struct FieldCell {
  float size = 1;                // s at the cell's centre [d]
  float reach = 1;               // an upper bound of s wherever a particle between this centre and its right and lower
                                 // neighbours may interact
  float pull_x = 0, pull_y = 0;  // background force at the centre, in the units of the pressure force
};

/// A raster over the torus: plain pointers, for host and device.
template <class Real>
struct FieldView {
  const FieldCell* cells = nullptr;       // [width*height]
  std::uint32_t width = 1, height = 1;    // cells
  Real cells_per_x = 1, cells_per_y = 1;  // cells per d
};

/// Interpolated values at a place.
template <class Real>
struct FieldSample {
  Real size = 1, reach = 1, pull_x = 0, pull_y = 0;
};

/// Where a position lies between four cell centres of a periodic raster.
template <class Real>
struct BilinearPlace {
  std::size_t corner[4];  // indices: upper left, upper right, lower left, lower right
  Real right = 0, below = 0;

  /// u in [0,width), v in [0,height): position in cells.
  ABN_HD BilinearPlace(std::uint32_t width, std::uint32_t height, Real u, Real v) {
    const Real a = u - Real(0.5);
    const Real b = v - Real(0.5);
    const std::int64_t column = floor_to_integer(a);
    const std::int64_t row = floor_to_integer(b);
    right = a - static_cast<Real>(column);
    below = b - static_cast<Real>(row);
    // u < width may round to width - 0.5 + ulp in a, so both neighbours are wrapped, not only the right one.
    const std::size_t x0 = wrapped(column, width);
    const std::size_t x1 = wrapped(column + 1, width);
    const std::size_t y0 = wrapped(row, height) * width;
    const std::size_t y1 = wrapped(row + 1, height) * width;
    corner[0] = y0 + x0;
    corner[1] = y0 + x1;
    corner[2] = y1 + x0;
    corner[3] = y1 + x1;
  }
  ABN_HD Real mix(Real upper_left, Real upper_right, Real lower_left, Real lower_right) const {
    const Real top = upper_left * (Real(1) - right) + upper_right * right;
    const Real bottom = lower_left * (Real(1) - right) + lower_right * right;
    return top * (Real(1) - below) + bottom * below;
  }

 private:
  ABN_HD static std::size_t wrapped(std::int64_t i, std::uint32_t count) {
    return static_cast<std::size_t>(i < 0 ? i + count : i >= std::int64_t{count} ? i - count : i);
  }
};

/// Bilinear between cell centres, periodic. u in [0,width), v in [0,height): position in cells of the raster.
template <class Real>
ABN_HD inline Real bilinear_periodic(const float* cells, std::uint32_t width, std::uint32_t height, Real u, Real v) {
  const BilinearPlace<Real> place(width, height, u, v);
  return place.mix(static_cast<Real>(cells[place.corner[0]]), static_cast<Real>(cells[place.corner[1]]),
                   static_cast<Real>(cells[place.corner[2]]), static_cast<Real>(cells[place.corner[3]]));
}

/// Size and reach at a position [d] on the torus; no pull.
template <class Real>
ABN_HD inline FieldSample<Real> sample_size(const FieldView<Real>& field, const BilinearPlace<Real>& place) {
  const auto size = [&](int k) { return static_cast<Real>(field.cells[place.corner[k]].size); };
  return {place.mix(size(0), size(1), size(2), size(3)), static_cast<Real>(field.cells[place.corner[0]].reach)};
}

/// The field at a position [d] on the torus.
template <class Real>
ABN_HD inline FieldSample<Real> sample_field(const FieldView<Real>& field, Real x, Real y) {
  const BilinearPlace<Real> place(field.width, field.height, x * field.cells_per_x, y * field.cells_per_y);
  FieldSample<Real> sample = sample_size(field, place);
  const auto pull_x = [&](int k) { return static_cast<Real>(field.cells[place.corner[k]].pull_x); };
  const auto pull_y = [&](int k) { return static_cast<Real>(field.cells[place.corner[k]].pull_y); };
  sample.pull_x = place.mix(pull_x(0), pull_x(1), pull_x(2), pull_x(3));
  sample.pull_y = place.mix(pull_y(0), pull_y(1), pull_y(2), pull_y(3));
  return sample;
}

/// How a field is to be prepared.
struct FieldOptions {
  double length_x = 1, length_y = 1;  // of the plane [d]
  double count = 1;                   // particles on the plane
  Kernel kernel = Kernel::wendland;
  double support = 2;         // H [d]; the widest one, if there are several
  double gradient_limit = 1;  // largest |grad s|; a jump is blended over about one of the larger spacings
  bool walls = false;         // extend the field beyond the plane for a ring of ghost particles
  bool background = true;     // compute the background force
  double least_margin = 3;    // of the ring [d]
};

/// A field ready for use. On a plane with walls the torus is larger than the plane: the plane lies at [0,plane), the
/// ring of ghosts around it on the rest, so that a ghost left of x = 0 has a coordinate just below length_x.
struct SizeField {
  double length_x = 1, length_y = 1;  // of the torus [d]
  double margin_x = 0, margin_y = 0;  // width of the ring on each side [d]
  bool uniform = true;                // s = 1 everywhere: no raster
  std::uint32_t width = 0, height = 0;
  std::vector<FieldCell> cells;  // [width*height]
  double smallest = 1, largest = 1;

  template <class Real>
  FieldView<Real> view() const {
    return {cells.data(), width, height, static_cast<Real>(width / length_x), static_cast<Real>(height / length_y)};
  }
};

/// Mean of s^-2 over the raster, exactly for the bilinear interpolant: over one square between four cell centres the
/// integral of s^-2 is 1 / L(s00 s11, s10 s01), L the logarithmic mean. Beyond the border the raster repeats
/// (periodic) or keeps its border values.
double mean_inverse_square(const Grid<float>& s, bool periodic = true);

/// `s` scaled so that the mean of s^-2 is 1: then N particles at density s^-2 fill the plane. A spacing above `largest`
/// [d] is cut to it first. Throws ConfigError unless every value is finite and > 0.
Grid<float> normalised_size_field(const Grid<float>& s, double largest, bool periodic = true);

/// Lowers s where it rises by more than `limit` per unit of length, so that |grad s| <= limit between cell centres (up
/// to the 8 % by which a chain of steps on a raster is longer than a straight line). cell_x, cell_y: size of a cell.
/// Returns false if nothing had to be changed.
bool limit_gradient(Grid<float>& s, double cell_x, double cell_y, double limit, bool periodic = true);

/// The whole preparation: reduce a raster finer than the particles can follow, normalise, limit the gradient, extend
/// beyond walls, bound the reach, compute the background force. Throws ConfigError as normalised_size_field().
SizeField prepare_size_field(const Grid<float>& s, const FieldOptions& options);

/// The same for s = 1.
SizeField uniform_size_field(const FieldOptions& options);

/// The background (mean-field) force at (x,y) by a fine quadrature: what prepare_size_field() tabulates, exposed for
/// its test. B(x) = int s(y)^-2 g(q) (x - y) 2 / (s(x) + s(y)) dy, the mean of eq. 2.16 over particles at density s^-2
/// and pressure 1.
struct Pull {
  double x = 0, y = 0;
};
Pull background_force(const SizeField& field, const FieldOptions& options, double x, double y, int rings, int angles);

}  // namespace abn::sph
