// What the preparations of a size field on the host and on a device have in common: the formula of every cell, and what
// is decided for all of them. size_field.cpp and sph_cuda/size_field_engine.h put the steps together.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sampling/hd.h"
#include "sampling/sph/raster_border.h"
#include "sampling/sph/size_field.h"
#include "sampling/vec.h"

namespace abn::sph {

/// A spacing above sqrt(N) means less than one particle on the whole plane.
inline double largest_spacing(const FieldOptions& options) { return std::sqrt(options.count); }

/// A spacing times `factor`, at most `largest` [d].
ABN_HD inline float scaled_size(float s, double factor, double largest) {
  const double value = static_cast<double>(s) * factor;
  const double bounded = value < 1e-6 ? 1e-6 : value;
  return static_cast<float>(largest < bounded ? largest : bounded);
}

/// How many cells along an axis become one: particles cannot follow what is finer than half of their spacing. length:
/// of the plane [d].
inline std::uint32_t reduction(double smallest, double length, std::uint32_t cells) {
  return static_cast<std::uint32_t>(std::clamp(smallest / 2 * cells / length, 1.0, static_cast<double>(cells)));
}

inline Extent reduced_extent(Extent raster, std::uint32_t factor_x, std::uint32_t factor_y) {
  return {(raster.width + factor_x - 1) / factor_x, (raster.height + factor_y - 1) / factor_y};
}

/// Cell (x,y) of a coarser raster: the mean s^-2 of its block of cells of `s` [from].
ABN_HD inline float reduced_size(const float* s, Extent from, Extent to, std::uint32_t x, std::uint32_t y) {
  // Equal shares of the raster also where the factor does not divide it; a cell may then count for two blocks.
  const auto first_x = static_cast<std::uint32_t>(std::uint64_t{x} * from.width / to.width);
  const auto first_y = static_cast<std::uint32_t>(std::uint64_t{y} * from.height / to.height);
  const auto last_x = static_cast<std::uint32_t>((std::uint64_t{x} + 1) * from.width / to.width);
  const auto last_y = static_cast<std::uint32_t>((std::uint64_t{y} + 1) * from.height / to.height);
  double total = 0;
  for (std::uint32_t v = first_y; v < last_y; ++v) {
    const float* line = s + std::size_t{v} * from.width;
    for (std::uint32_t u = first_x; u < last_x; ++u) {
      total += 1 / (static_cast<double>(line[u]) * static_cast<double>(line[u]));
    }
  }
  total /= static_cast<double>(last_x - first_x) * static_cast<double>(last_y - first_y);
  return static_cast<float>(1 / std::sqrt(total));
}

/// How often the gradient is limited at most: normalising afterwards scales it too.
inline constexpr int limit_rounds = 3;

/// By how much s may rise from a cell to its neighbours.
struct GradientSteps {
  float x = 0, y = 0, diagonal = 0;
};
inline GradientSteps gradient_steps(double cell_x, double cell_y, double limit) {
  return {static_cast<float>(limit * cell_x), static_cast<float>(limit * cell_y),
          static_cast<float>(limit * std::hypot(cell_x, cell_y))};
}

/// Width of a ring [d] wide enough for every particle of the plane: from every side no deeper than it, the largest s
/// there times H. A fixed point, reached from below. largest_at(depth): the largest s in the two lines of `cells`
/// parallel ones, each `cell` [d] wide, that lie so deep.
template <class LargestAt>
double ring_width(const FieldOptions& options, std::uint32_t cells, double cell, const LargestAt& largest_at) {
  double largest = 0;
  double margin = options.least_margin;
  for (std::uint32_t depth = 0; depth < cells && depth * cell <= margin; ++depth) {
    largest = std::max(largest, static_cast<double>(largest_at(depth)));
    margin = std::max(margin, options.support * largest);
  }
  return margin;
}

/// The same in whole cells.
inline std::uint32_t ring_cells(double width, double cell) { return static_cast<std::uint32_t>(width / cell) + 2; }

/// Where cell i of the torus has its s from: the plane is mirrored into a ring of `ring` cells on each side of it, and
/// the torus' seam lies in the middle of what the two make up.
ABN_HD inline std::uint32_t cell_on_plane(std::uint32_t i, std::uint32_t plane, std::uint32_t ring) {
  const std::int64_t length = std::int64_t{plane} + 2 * std::int64_t{ring};
  return beyond_border(i < plane + ring ? std::int64_t{i} : i - length, plane, false);
}

/// Torus and raster of a field that varies, after `plane` cells with a ring of cells on every side.
inline SizeField laid_out_field(const FieldOptions& options, Extent plane, std::uint32_t ring_x, std::uint32_t ring_y) {
  SizeField field;
  field.uniform = false;
  field.margin_x = ring_x * (options.length_x / plane.width);
  field.margin_y = ring_y * (options.length_y / plane.height);
  field.length_x = options.length_x + 2 * field.margin_x;
  field.length_y = options.length_y + 2 * field.margin_y;
  field.width = plane.width + 2 * ring_x;
  field.height = plane.height + 2 * ring_y;
  return field;
}

/// Before the background force. A little more than the bound, so that rounding never hides a neighbour.
ABN_HD inline FieldCell field_cell(float size, float reach) { return {size, reach * 1.00001F, 0, 0}; }

}  // namespace abn::sph
