// A Setup and a size field in the dimensionless form that every engine computes on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sampling/grid.h"
#include "sampling/sph/bodies.h"
#include "sampling/sph/cells.h"
#include "sampling/sph/size_field.h"
#include "sampling/sph/solver.h"

namespace abn::sph {

/// Lengths in d. The plane lies at [0,plane_x) x [0,plane_y) of the torus field.length_x x field.length_y; the two
/// differ only with walls, by the ring of ghosts (size_field.h says where it lies).
struct Problem {
  SizeField field;
  Terms terms;
  double spacing = 1;  // d [px]
  double plane_x = 1, plane_y = 1;
  bool walls = false;
  double support = 2, class_support = 2;
  std::vector<double> tile_density;  // mean of s^-2 in every tile of the cells; empty if uniform
  std::size_t particles = 0;         // ids below are the caller's, from there on ghosts
  std::vector<double> x, y;          // [particles + ghosts], on the torus
  std::vector<std::uint8_t> labels;  // class by id; empty unless classed

  std::size_t count() const { return x.size(); }
};

/// Throws ConfigError for what make_cpu_solver() does not take.
void validate(const Setup& setup);

/// `positions` [particles] by id [px]; s null = uniform. Makes the ring of ghosts if the setup has walls. Throws
/// ConfigError for a bad field.
Problem make_problem(const Setup& setup, std::span<const Vec2f> positions, const Grid<float>* s);

/// The parts of make_problem(), for whoever prepares the field elsewhere: all but field, ring and positions; the
/// options for that field; and what follows from it. tile_density: empty if uniform. set_field() throws ConfigError for
/// classes beside a field that varies.
Problem problem_without_field(const Setup& setup, std::size_t particles);
FieldOptions field_options(const Setup& setup, const Problem& problem);
void set_field(const Setup& setup, SizeField field, std::vector<double> tile_density, Problem& problem);

/// Cells for the problem: one tile if uniform, else tiles with as many cells as particles are expected there. For float
/// and double.
template <class Real>
Cells<Real> cells_for(const Problem& problem);

/// A position [d] on the torus as the caller sees it [px]: ghosts left of and above the plane have negative ones.
Vec2f to_pixels(const Problem& problem, double x, double y);

/// The ring of ghosts around the plane: particles of density s^-2 on both sides of the wall, relaxed together, those
/// outside kept, in the order of their drawing. [ghosts], on the torus.
struct Ring {
  std::vector<double> x, y;
};
Ring make_ghost_ring(const Setup& setup, const Problem& problem);

/// An engine on a problem as it is, without walls of its own: what relaxes the ring.
std::unique_ptr<Solver> make_cpu_solver_on(const Setup& setup, const Problem& problem);

}  // namespace abn::sph
