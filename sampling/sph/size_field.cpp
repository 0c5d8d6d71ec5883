#include "sampling/sph/size_field.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sampling/sph/background.h"
#include "sampling/sph/raster_border.h"
#include "sampling/sph/reach.h"

namespace abn::sph {
namespace {

/// Blocks of factor x factor cells become one with their mean s^-2.
Grid<float> reduced(const Grid<float>& s, std::uint32_t factor_x, std::uint32_t factor_y) {
  const Extent size{(s.size().width + factor_x - 1) / factor_x, (s.size().height + factor_y - 1) / factor_y};
  Grid<float> result(size);
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = 0; x < size.width; ++x) {
      // Equal shares of the raster also where the factor does not divide it; a cell may then count for two blocks.
      const auto first_x = static_cast<std::uint32_t>(std::uint64_t{x} * s.size().width / size.width);
      const auto first_y = static_cast<std::uint32_t>(std::uint64_t{y} * s.size().height / size.height);
      const auto last_x = static_cast<std::uint32_t>((std::uint64_t{x} + 1) * s.size().width / size.width);
      const auto last_y = static_cast<std::uint32_t>((std::uint64_t{y} + 1) * s.size().height / size.height);
      double total = 0;
      for (std::uint32_t v = first_y; v < last_y; ++v) {
        for (std::uint32_t u = first_x; u < last_x; ++u) total += 1 / (double{s.at(u, v)} * double{s.at(u, v)});
      }
      total /= static_cast<double>(last_x - first_x) * static_cast<double>(last_y - first_y);
      result.at(x, y) = static_cast<float>(1 / std::sqrt(total));
    }
  }
  return result;
}

/// Mirrors the field into a ring of margin cells around the plane; the torus' seam lies in the middle of the ring.
Grid<float> extended(const Grid<float>& s, std::uint32_t margin_x, std::uint32_t margin_y) {
  const Extent size{s.size().width + 2 * margin_x, s.size().height + 2 * margin_y};
  const auto origins = [](std::uint32_t length, std::uint32_t plane, std::uint32_t margin) {
    std::vector<std::uint32_t> from(length);
    for (std::uint32_t i = 0; i < length; ++i) {
      from[i] = beyond_border(i < plane + margin ? std::int64_t{i} : std::int64_t{i} - length, plane, false);
    }
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

/// Width of a ring [d] wide enough for every particle of the plane: from every side no deeper than it, the largest s
/// there times H. A fixed point, reached from below.
double ring_width(const Grid<float>& s, const FieldOptions& options, bool horizontal) {
  const std::uint32_t depth_cells = horizontal ? s.size().width : s.size().height;
  const std::uint32_t along = horizontal ? s.size().height : s.size().width;
  const double cell = (horizontal ? options.length_x : options.length_y) / depth_cells;
  double largest = 0;
  double margin = options.least_margin;
  for (std::uint32_t depth = 0; depth < depth_cells && depth * cell <= margin; ++depth) {
    for (std::uint32_t k = 0; k < along; ++k) {
      const std::uint32_t far = depth_cells - 1 - depth;
      const float here = horizontal ? std::max(s.at(depth, k), s.at(far, k)) : std::max(s.at(k, depth), s.at(k, far));
      largest = std::max(largest, double{here});
    }
    margin = std::max(margin, options.support * largest);
  }
  return margin;
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
  // A spacing above sqrt(N) means less than one particle on the whole plane.
  const double most = std::sqrt(options.count);
  Grid<float> s = normalised_size_field(given, most, periodic);
  const auto least_of = [](const Grid<float>& grid) {
    return double{*std::min_element(grid.cells().begin(), grid.cells().end())};
  };
  // Particles cannot follow what is finer than half of their spacing.
  const auto factor = [&](double length, std::uint32_t cells) {
    return static_cast<std::uint32_t>(std::clamp(least_of(s) / 2 * cells / length, 1.0, static_cast<double>(cells)));
  };
  const std::uint32_t factor_x = factor(options.length_x, s.size().width);
  const std::uint32_t factor_y = factor(options.length_y, s.size().height);
  if (factor_x > 1 || factor_y > 1) s = normalised_size_field(reduced(s, factor_x, factor_y), most, periodic);
  const double cell_x = options.length_x / s.size().width;
  const double cell_y = options.length_y / s.size().height;
  // Normalising scales the gradient too.
  for (int round = 0; round < 3 && limit_gradient(s, cell_x, cell_y, options.gradient_limit, periodic); ++round) {
    s = normalised_size_field(s, most, periodic);
  }
  const auto [smallest, largest] = std::minmax_element(s.cells().begin(), s.cells().end());
  if (*smallest == *largest) return uniform_size_field(options);

  SizeField field;
  field.uniform = false;
  field.smallest = double{*smallest};
  field.largest = double{*largest};
  if (options.walls) {
    const auto cells_of = [](double margin, double cell) { return static_cast<std::uint32_t>(margin / cell) + 2; };
    const std::uint32_t ring_x = cells_of(ring_width(s, options, true), cell_x);
    const std::uint32_t ring_y = cells_of(ring_width(s, options, false), cell_y);
    s = extended(s, ring_x, ring_y);
    field.margin_x = ring_x * cell_x;
    field.margin_y = ring_y * cell_y;
  }
  field.length_x = options.length_x + 2 * field.margin_x;
  field.length_y = options.length_y + 2 * field.margin_y;
  field.width = s.size().width;
  field.height = s.size().height;
  field.cells.resize(s.size().area());
  const double torus_cell_x = field.length_x / field.width;
  const double torus_cell_y = field.length_y / field.height;
  const Grid<float> reach = reach_by_block(s, torus_cell_x, torus_cell_y, options.support);
#pragma omp parallel for schedule(static)
  for (std::int64_t row = 0; row < std::int64_t{field.height}; ++row) {
    const auto y = static_cast<std::uint32_t>(row);
    for (std::uint32_t x = 0; x < field.width; ++x) {
      FieldCell& cell = field.cells[std::size_t{y} * field.width + x];
      cell.size = s.at(x, y);
      // A little more than the bound, so that rounding never hides a neighbour.
      cell.reach = reach.at(x / reach_block, y / reach_block) * 1.00001F;
    }
  }
  if (options.background) tabulate_background(s, options, field);
  return field;
}

}  // namespace abn::sph
