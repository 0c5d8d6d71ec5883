#include "sampling/sph/problem.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "sampling/error.h"
#include "sampling/sph/tile_density.h"

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

Problem problem_without_field(const Setup& setup, std::size_t particles) {
  Problem problem;
  problem.particles = particles;
  problem.spacing = std::sqrt(static_cast<double>(setup.plane.area()) / static_cast<double>(particles));
  problem.plane_x = setup.plane.width / problem.spacing;
  problem.plane_y = setup.plane.height / problem.spacing;
  problem.walls = setup.boundary == Boundary::ghost;
  problem.support = double{setup.support_radius};
  problem.class_support = problem.support * std::sqrt(class_count(setup));
  problem.labels.assign(setup.classes.begin(), setup.classes.end());
  return problem;
}

FieldOptions field_options(const Setup& setup, const Problem& problem) {
  FieldOptions options;
  options.length_x = problem.plane_x;
  options.length_y = problem.plane_y;
  options.count = static_cast<double>(problem.particles);
  options.kernel = setup.kernel;
  options.support = problem.class_support;
  options.gradient_limit = double{setup.gradient_limit};
  options.walls = problem.walls;
  options.background = setup.background;
  return options;
}

void set_field(const Setup& setup, SizeField field, std::vector<double> tile_density, Problem& problem) {
  const bool classed = !problem.labels.empty();
  if (classed && !field.uniform) {
    throw ConfigError("SPH classes beside a size field that varies: not supported; relax every class by itself");
  }
  problem.terms = {setup.kernel, classed || !field.uniform, classed};
  problem.field = std::move(field);
  problem.tile_density = std::move(tile_density);
}

Problem make_problem(const Setup& setup, std::span<const Vec2f> positions, const Grid<float>* s) {
  Problem problem = problem_without_field(setup, positions.size());
  const FieldOptions options = field_options(setup, problem);
  SizeField field = s == nullptr ? uniform_size_field(options) : prepare_size_field(*s, options);
  std::vector<double> density = field.uniform ? std::vector<double>{} : tile_densities(field);
  set_field(setup, std::move(field), std::move(density), problem);
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
