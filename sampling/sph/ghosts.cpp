// The ring of ghost particles (thesis 2.6 and fig. 4.1; Schechter and Bridson 2012). Deviation from the thesis, whose
// ring is a lattice h/6 wide: as wide as the warped support of any particle inside, at the density of the size field
// (mirrored at the walls), and relaxed, so that the particles inside meet the same crystal-free neighbourhood as far
// from the walls. Mirror images, which follow the particles, pile them up in layers (density 1.45 and .42 next to the
// wall); a lattice leaves its lines in the result.
#include <algorithm>
#include <cmath>

#include "sampling/sph/draw.h"
#include "sampling/sph/ghost_band.h"

namespace abn::sph {
namespace {

/// The sum of the densities on the grid. Skips columns surely inside of the band: most of the plane.
double sum_of_densities(const GhostBand& band, const BandGrid& grid) {
  const double inner_x = 2.001 * band.margin_x;
  const double inner_y = 2.001 * band.margin_y;
  const double columns_per_d = grid.columns / band.length_x;
  const auto first_inside = static_cast<std::int64_t>(std::ceil(inner_x * columns_per_d));
  const auto last_inside = static_cast<std::int64_t>((band.plane_x - inner_x) * columns_per_d) - 1;
  double sum = 0;
  for (std::uint32_t row = 0; row < grid.rows; ++row) {
    const double y = (row + 0.5) / grid.rows * band.length_y;
    const bool inside = std::min(y, band.plane_y - y) > inner_y;
    double sum_of_row = 0;
    for (std::uint32_t begin = 0; begin < grid.columns; begin += BandGrid::segment) {
      const std::uint32_t end = std::min(begin + BandGrid::segment, grid.columns);
      if (inside && begin >= first_inside && end <= last_inside) continue;
      double sum_of_segment = 0;
      for (std::uint32_t column = begin; column < end; ++column) {
        sum_of_segment += grid.density(band, column, row);
      }
      sum_of_row += sum_of_segment;
    }
    sum += sum_of_row;
  }
  return sum;
}

}  // namespace

GhostBand ghost_band(const Problem& problem, const FieldCell* cells) {
  const SizeField& field = problem.field;
  GhostBand band{field.length_x, field.length_y, problem.plane_x, problem.plane_y, field.margin_x, field.margin_y, {}};
  if (!field.uniform) {
    band.field = field.view<double>();
    band.field.cells = cells;
  }
  return band;
}

BandGrid::BandGrid(const SizeField& field) {
  const auto steps = [](double length, double margin) {
    return static_cast<std::uint32_t>(std::clamp(static_cast<int>(std::ceil(16 * length / margin)), 64, 2048));
  };
  columns = steps(field.length_x, field.margin_x);
  rows = steps(field.length_y, field.margin_y);
}

std::uint64_t BandGrid::particles(const SizeField& field, double sum) const {
  const double mass = sum * (field.length_x / columns * (field.length_y / rows));
  return static_cast<std::uint64_t>(std::max(1.0, std::round(mass)));
}

Problem problem_of_band(const Problem& problem) {
  const SizeField& field = problem.field;
  Problem band = problem;
  // Nobody is inside of the band: one cell a tile will do there.
  const auto tiles_x = static_cast<std::size_t>(Cells<float>::tile_count(field.length_x));
  for (std::size_t t = 0; t < band.tile_density.size(); ++t) {
    const std::size_t tiles_y = band.tile_density.size() / tiles_x;
    const auto deep = [](std::size_t index, std::size_t count, double length, double plane, double margin) {
      const double first = length * static_cast<double>(index) / static_cast<double>(count);
      const double last = length * static_cast<double>(index + 1) / static_cast<double>(count);
      return first > 2 * margin && last < plane - 2 * margin;
    };
    const bool empty = deep(t % tiles_x, tiles_x, field.length_x, problem.plane_x, field.margin_x) &&
                       deep(t / tiles_x, tiles_y, field.length_y, problem.plane_y, field.margin_y);
    if (empty) band.tile_density[t] = 1e-6;
  }
  band.walls = false;
  band.spacing = 1;  // pixels are d here
  band.particles = 0;
  band.x.clear();
  band.y.clear();
  return band;
}

Setup setup_of_band(const Setup& setup, const Problem& problem) {
  Setup relaxation = setup;
  relaxation.boundary = Boundary::periodic;
  // The ring's density is what it is for, so it is never relaxed without pressure.
  if (std::isinf(setup.stiffness_ratio)) relaxation.stiffness_ratio = Setup{}.stiffness_ratio;
  relaxation.plane = {static_cast<std::uint32_t>(problem.field.length_x) + 2,
                      static_cast<std::uint32_t>(problem.field.length_y) + 2};
  return relaxation;
}

Ring make_ghost_ring(const Setup& setup, const Problem& problem) {
  const SizeField& field = problem.field;
  const GhostBand around = ghost_band(problem, field.cells.data());
  const BandGrid grid(field);
  const std::uint64_t count = grid.particles(field, sum_of_densities(around, grid));
  Problem band = problem_of_band(problem);
  const auto density = [&](double u, double v) { return around.density(u, v); };
  // One point a piece: white points, held, have holes that their free neighbours would fill (ring 3 % too sparse).
  for (const UnitPosition p : draw_by_density(density, field.length_x / field.length_y, count, setup.seed, 1)) {
    band.x.push_back(p.x * field.length_x);
    band.y.push_back(p.y * field.length_y);
  }
  band.particles = band.count();
  const auto solver = make_cpu_solver_on(setup_of_band(setup, problem), band);
  std::vector<std::uint32_t> held;
  for (std::uint32_t i = 0; i < band.count(); ++i) {
    if (around.held(band.x[i], band.y[i])) held.push_back(i);
  }
  solver->freeze(held);
  solver->relax(setup.ghost_steps, false);

  Ring ring;
  for (const Vec2f p : solver->positions()) {
    const double x = double{p.x};
    const double y = double{p.y};
    if (around.in_plane(x, y)) continue;
    ring.x.push_back(x);
    ring.y.push_back(y);
  }
  return ring;
}

}  // namespace abn::sph
