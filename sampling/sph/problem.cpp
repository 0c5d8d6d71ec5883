#include "sampling/sph/problem.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "sampling/error.h"

namespace abn::sph {
namespace {

void require(bool good, const char* key, double value, const char* remedy) {
  if (!good) {
    throw ConfigError(std::string("SPH ") + key + " = " + std::to_string(value) + ": it must be " + remedy);
  }
}

double class_count(const Setup& setup) {
  if (setup.classes.empty()) return 1;
  return 1.0 + *std::max_element(setup.classes.begin(), setup.classes.end());
}

/// The mean of s^-2 over every tile.
std::vector<double> tile_densities(const SizeField& field) {
  const std::int32_t tiles_x = Cells<float>::tile_count(field.length_x);
  const std::int32_t tiles_y = Cells<float>::tile_count(field.length_y);
  const auto columns = static_cast<std::size_t>(tiles_x);
  std::vector<double> density(columns * static_cast<std::size_t>(tiles_y), 0);
  std::vector<double> samples(density.size(), 0);
  // The mean of s^-2 over a tile, from rectangles that are a share of a square between four cell centres: there the
  // integral is known, so that a spike counts as what it holds and not as its smallest s.
  const auto shares = [](std::int32_t tiles, std::uint32_t cells) {
    return std::max(1U, (4 * static_cast<std::uint32_t>(tiles) + cells - 1) / cells);
  };
  const std::uint32_t width = field.width * shares(tiles_x, field.width);
  const std::uint32_t height = field.height * shares(tiles_y, field.height);
  const FieldView<double> view = field.template view<double>();
  const auto size_at = [&](double x, double y) {  // [share of the torus], from the first cell's centre
    const double u = wrap(x * field.width + 0.5, static_cast<double>(field.width));
    const double v = wrap(y * field.height + 0.5, static_cast<double>(field.height));
    return sample_size(view, BilinearPlace<double>(field.width, field.height, u, v)).size;
  };
  const auto tile_of = [](double share, double first, std::int32_t tiles) {
    return static_cast<std::size_t>(wrap(share + first, 1.0) * tiles);
  };
  std::vector<double> above(width + 1, 0);  // s along the upper sides of a row of rectangles
  std::vector<double> below(width + 1, 0);
  for (std::uint32_t x = 0; x <= width; ++x) above[x] = size_at(static_cast<double>(x) / width, 0);
  for (std::uint32_t y = 0; y < height; ++y) {
    const auto row = tile_of((y + 0.5) / height, 0.5 / field.height, tiles_y);
    for (std::uint32_t x = 0; x <= width; ++x) below[x] = size_at(static_cast<double>(x) / width, (y + 1.0) / height);
    for (std::uint32_t x = 0; x < width; ++x) {
      const auto column = tile_of((x + 0.5) / width, 0.5 / field.width, tiles_x);
      density[row * columns + column] += mean_inverse_square(above[x], above[x + 1], below[x], below[x + 1]);
      samples[row * columns + column] += 1;
    }
    above.swap(below);
  }
  for (std::size_t t = 0; t < density.size(); ++t) density[t] /= samples[t];
  return density;
}

}  // namespace

void validate(const Setup& setup) {
  require(setup.plane.area() > 0, "plane area [px]", static_cast<double>(setup.plane.area()), "at least 1");
  const auto n = static_cast<double>(setup.positions.size());
  require(n >= 1 && n <= 4294967295.0, "number of particles", n, "between 1 and 2^32-1");
  require(setup.support_radius > 0 && setup.support_radius <= 100, "support_radius", double{setup.support_radius},
          "in (0, 100] spacings");
  require(setup.stiffness_ratio > 0, "stiffness_ratio", double{setup.stiffness_ratio}, "> 0");
  require(setup.step >= 0 && std::isfinite(setup.step), "step", double{setup.step}, "finite and >= 0");
  require(setup.damping >= 0 && setup.damping <= 1, "damping", double{setup.damping}, "in [0, 1]");
  require(setup.ghost_steps >= 0, "ghost_steps", setup.ghost_steps, ">= 0");
  require(setup.velocity_cap > 0 && std::isfinite(setup.velocity_cap), "velocity_cap", double{setup.velocity_cap},
          "finite and > 0");
  require(setup.gradient_limit > 0 && setup.gradient_limit <= 100, "gradient_limit", double{setup.gradient_limit},
          "in (0, 100]");
  require(setup.classes.empty() || setup.classes.size() == setup.positions.size(), "number of classes' labels",
          static_cast<double>(setup.classes.size()), "that of the particles");
  require(setup.classes.empty() || setup.boundary == Boundary::periodic, "classes", class_count(setup),
          "1 on a plane with ghosts, whose ring has no classes; use the periodic boundary");
  for (const Vec2f p : setup.positions) {
    const bool inside = p.x >= 0 && p.x < static_cast<float>(setup.plane.width) && p.y >= 0 &&
                        p.y < static_cast<float>(setup.plane.height);
    if (!inside) {
      throw ConfigError("SPH start position (" + std::to_string(p.x) + ", " + std::to_string(p.y) +
                        ") [px] lies outside the plane of " + std::to_string(setup.plane.width) + "x" +
                        std::to_string(setup.plane.height) + "; give positions inside it");
    }
  }
}

Problem make_problem(const Setup& setup, std::span<const Vec2f> positions, const Grid<float>* s) {
  Problem problem;
  const auto count = static_cast<double>(positions.size());
  problem.particles = positions.size();
  problem.spacing = std::sqrt(static_cast<double>(setup.plane.area()) / count);
  problem.plane_x = setup.plane.width / problem.spacing;
  problem.plane_y = setup.plane.height / problem.spacing;
  problem.walls = setup.boundary == Boundary::ghost;
  problem.support = double{setup.support_radius};
  problem.class_support = problem.support * std::sqrt(class_count(setup));
  problem.labels.assign(setup.classes.begin(), setup.classes.end());
  FieldOptions options;
  options.length_x = problem.plane_x;
  options.length_y = problem.plane_y;
  options.count = count;
  options.kernel = setup.kernel;
  options.support = problem.class_support;
  options.gradient_limit = double{setup.gradient_limit};
  options.walls = problem.walls;
  options.background = setup.background;
  problem.field = s == nullptr ? uniform_size_field(options) : prepare_size_field(*s, options);
  const bool classed = !problem.labels.empty();
  if (classed && !problem.field.uniform) {
    throw ConfigError("SPH classes beside a size field that varies: not supported; relax every class by itself");
  }
  problem.terms = {setup.kernel, classed || !problem.field.uniform, classed};
  if (!problem.field.uniform) problem.tile_density = tile_densities(problem.field);
  const Ring ring = problem.walls ? make_ghost_ring(setup, problem) : Ring{};
  problem.x.reserve(positions.size() + ring.x.size());
  problem.y.reserve(positions.size() + ring.y.size());
  for (const Vec2f p : positions) {
    problem.x.push_back(double{p.x} / problem.spacing);
    problem.y.push_back(double{p.y} / problem.spacing);
  }
  problem.x.insert(problem.x.end(), ring.x.begin(), ring.x.end());
  problem.y.insert(problem.y.end(), ring.y.begin(), ring.y.end());
  return problem;
}

template <class Real>
Cells<Real> cells_for(const Problem& problem) {
  const SizeField& field = problem.field;
  const double support = problem.class_support;
  if (field.uniform) return {field.length_x, field.length_y, support};
  return {field.length_x,
          field.length_y,
          support,
          Cells<Real>::tile_count(field.length_x),
          Cells<Real>::tile_count(field.length_y),
          problem.tile_density};
}

template Cells<float> cells_for(const Problem&);
template Cells<double> cells_for(const Problem&);

Vec2f to_pixels(const Problem& problem, double x, double y) {
  const auto place = [&](double at, double plane, double length) {
    const double seam = plane + 0.5 * (length - plane);  // beyond it lies the ring left of 0
    return static_cast<float>((at < seam ? at : at - length) * problem.spacing);
  };
  return {place(x, problem.plane_x, problem.field.length_x), place(y, problem.plane_y, problem.field.length_y)};
}

}  // namespace abn::sph
