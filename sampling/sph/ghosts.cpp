// The ring of ghost particles (thesis 2.6 and fig. 4.1; Schechter and Bridson 2012). Deviation from the thesis, whose
// ring is a lattice h/6 wide: as wide as the warped support of any particle inside, at the density of the size field
// (mirrored at the walls), and relaxed, so that the particles inside meet the same crystal-free neighbourhood as far
// from the walls. Mirror images, which follow the particles, pile them up in layers (density 1.45 and .42 next to the
// wall); a lattice leaves its lines in the result.
#include <algorithm>
#include <cmath>

#include "sampling/sph/draw.h"
#include "sampling/sph/problem.h"

namespace abn::sph {
Ring make_ghost_ring(const Setup& setup, const Problem& problem) {
  const SizeField& field = problem.field;
  // Particles on the ring and on a band as wide inside each wall; the inner half of the band is held.
  const auto depth_inside = [&](double x, double y) {  // in band widths: > 0 inside the plane, 0 at the wall
    const double depth_x = std::min(x, problem.plane_x - x) / field.margin_x;
    const double depth_y = std::min(y, problem.plane_y - y) / field.margin_y;
    return std::min(depth_x, depth_y);
  };
  const auto on_band = [&](double u, double v) {
    const double x = u * field.length_x;
    const double y = v * field.length_y;
    if (x < problem.plane_x && y < problem.plane_y && depth_inside(x, y) > 2) return 0.0;
    if (field.uniform) return 1.0;
    const double size = sample_size(field.view<double>(),
                                    BilinearPlace<double>(field.width, field.height, u * field.width, v * field.height))
                            .size;
    return 1 / (size * size);
  };
  // The expected number, by the midpoint rule on a grid finer than the band.
  const auto steps = [](double length, double margin) {
    return std::clamp(static_cast<int>(std::ceil(16 * length / margin)), 64, 2048);
  };
  const int columns = steps(field.length_x, field.margin_x);
  const int rows = steps(field.length_y, field.margin_y);
  double mass = 0;
  // Columns surely inside of the band; most of the plane.
  const double inner = 2.001 * field.margin_x / field.length_x;
  const auto first_inside = static_cast<int>(std::ceil(inner * columns));
  const auto last_inside = static_cast<int>((problem.plane_x / field.length_x - inner) * columns) - 1;
  for (int row = 0; row < rows; ++row) {
    const double v = (row + 0.5) / rows;
    const double y = v * field.length_y;
    const bool inside = std::min(y, problem.plane_y - y) > 2.001 * field.margin_y;
    for (int column = 0; column < columns; ++column) {
      if (inside && column == first_inside && last_inside > column) column = last_inside;
      mass += on_band((column + 0.5) / columns, v);
    }
  }
  mass *= field.length_x / columns * (field.length_y / rows);

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
  band.x.clear();
  band.y.clear();
  const auto count = static_cast<std::uint64_t>(std::max(1.0, std::round(mass)));
  // One point a piece: white points, held, have holes that their free neighbours would fill (ring 3 % too sparse).
  for (const UnitPosition p : draw_by_density(on_band, field.length_x / field.length_y, count, setup.seed, 1)) {
    band.x.push_back(p.x * field.length_x);
    band.y.push_back(p.y * field.length_y);
  }
  band.particles = band.count();
  Setup relaxation = setup;
  relaxation.boundary = Boundary::periodic;
  // The ring's density is what it is for, so it is never relaxed without pressure.
  if (std::isinf(setup.stiffness_ratio)) relaxation.stiffness_ratio = Setup{}.stiffness_ratio;
  relaxation.plane = {static_cast<std::uint32_t>(field.length_x) + 2, static_cast<std::uint32_t>(field.length_y) + 2};
  const auto solver = make_cpu_solver_on(relaxation, band);
  std::vector<std::uint32_t> held;
  for (std::uint32_t i = 0; i < band.count(); ++i) {
    const bool inside = band.x[i] < problem.plane_x && band.y[i] < problem.plane_y;
    if (inside && depth_inside(band.x[i], band.y[i]) > 1) held.push_back(i);
  }
  solver->freeze(held);
  solver->relax(setup.ghost_steps, false);

  Ring ring;
  for (const Vec2f p : solver->positions()) {
    const double x = double{p.x};
    const double y = double{p.y};
    if (x < problem.plane_x && y < problem.plane_y) continue;
    ring.x.push_back(x);
    ring.y.push_back(y);
  }
  return ring;
}

}  // namespace abn::sph
