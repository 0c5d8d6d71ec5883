#include "sampling/sph/size_field.h"

#include <algorithm>
#include <vector>

#include "sampling/sph/background.h"
#include "sampling/sph/reach.h"
#include "sampling/sph/size_field_steps.h"

namespace abn::sph {
namespace {

/// Blocks of factor x factor cells become one with their mean s^-2.
Grid<float> reduced(const Grid<float>& s, std::uint32_t factor_x, std::uint32_t factor_y) {
  const Extent size = reduced_extent(s.size(), factor_x, factor_y);
  Grid<float> result(size);
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = 0; x < size.width; ++x) {
      result.at(x, y) = reduced_size(s.cells().data(), s.size(), size, x, y);
    }
  }
  return result;
}

/// Mirrors the field into a ring of margin cells around the plane.
Grid<float> extended(const Grid<float>& s, std::uint32_t margin_x, std::uint32_t margin_y) {
  const Extent size{s.size().width + 2 * margin_x, s.size().height + 2 * margin_y};
  const auto origins = [](std::uint32_t length, std::uint32_t plane, std::uint32_t margin) {
    std::vector<std::uint32_t> from(length);
    for (std::uint32_t i = 0; i < length; ++i) from[i] = cell_on_plane(i, plane, margin);
    return from;
  };
  const std::vector<std::uint32_t> from_x = origins(size.width, s.size().width, margin_x);
  const std::vector<std::uint32_t> from_y = origins(size.height, s.size().height, margin_y);
  Grid<float> result(size);
  for (std::uint32_t y = 0; y < size.height; ++y) {
    const float* line = &s.at(0, from_y[y]);
    for (std::uint32_t x = 0; x < size.width; ++x) result.at(x, y) = line[from_x[x]];
  }
  return result;
}

/// Cells of the ring across one axis.
std::uint32_t ring_along(const Grid<float>& s, const FieldOptions& options, bool horizontal) {
  const std::uint32_t cells = horizontal ? s.size().width : s.size().height;
  const std::uint32_t along = horizontal ? s.size().height : s.size().width;
  const double cell = (horizontal ? options.length_x : options.length_y) / cells;
  const auto largest_at = [&](std::uint32_t depth) {
    const std::uint32_t far = cells - 1 - depth;
    float largest = 0;
    for (std::uint32_t k = 0; k < along; ++k) {
      const float here = horizontal ? std::max(s.at(depth, k), s.at(far, k)) : std::max(s.at(k, depth), s.at(k, far));
      largest = std::max(largest, here);
    }
    return largest;
  };
  return ring_cells(ring_width(options, cells, cell, largest_at), cell);
}

}  // namespace

SizeField uniform_size_field(const FieldOptions& options) {
  SizeField field;
  if (options.walls) {
    // A little wider than the support, so that rounding never lets a particle see past the ring.
    field.margin_x = field.margin_y = std::max(options.least_margin, options.support * 1.01);
  }
  field.length_x = options.length_x + 2 * field.margin_x;
  field.length_y = options.length_y + 2 * field.margin_y;
  return field;
}

SizeField prepare_size_field(const Grid<float>& given, const FieldOptions& options) {
  const bool periodic = !options.walls;
  const double most = largest_spacing(options);
  Grid<float> s = normalised_size_field(given, most, periodic);
  const double least = double{*std::min_element(s.cells().begin(), s.cells().end())};
  const std::uint32_t factor_x = reduction(least, options.length_x, s.size().width);
  const std::uint32_t factor_y = reduction(least, options.length_y, s.size().height);
  if (factor_x > 1 || factor_y > 1) s = normalised_size_field(reduced(s, factor_x, factor_y), most, periodic);
  const double cell_x = options.length_x / s.size().width;
  const double cell_y = options.length_y / s.size().height;
  // Normalising scales the gradient too.
  for (int round = 0; round < limit_rounds && limit_gradient(s, cell_x, cell_y, options.gradient_limit, periodic);
       ++round) {
    s = normalised_size_field(s, most, periodic);
  }
  const auto [smallest, largest] = std::minmax_element(s.cells().begin(), s.cells().end());
  if (*smallest == *largest) return uniform_size_field(options);

  const std::uint32_t ring_x = options.walls ? ring_along(s, options, true) : 0;
  const std::uint32_t ring_y = options.walls ? ring_along(s, options, false) : 0;
  SizeField field = laid_out_field(options, s.size(), ring_x, ring_y);
  field.smallest = double{*smallest};
  field.largest = double{*largest};
  if (options.walls) s = extended(s, ring_x, ring_y);
  field.cells.resize(s.size().area());
  const double torus_cell_x = field.length_x / field.width;
  const double torus_cell_y = field.length_y / field.height;
  const Grid<float> reach = reach_by_block(s, torus_cell_x, torus_cell_y, options.support);
#pragma omp parallel for schedule(static)
  for (std::int64_t row = 0; row < std::int64_t{field.height}; ++row) {
    const auto y = static_cast<std::uint32_t>(row);
    for (std::uint32_t x = 0; x < field.width; ++x) {
      field.cells[std::size_t{y} * field.width + x] =
          field_cell(s.at(x, y), reach.at(x / reach_block, y / reach_block));
    }
  }
  if (options.background) tabulate_background(s, options, field);
  return field;
}

}  // namespace abn::sph
