// What one particle does in one step, for host and device: the bodies of the GPU's kernels. The vectorised CPU engine
// shares the pair functions of model.h and agrees with these bit for bit (contraction off).
#pragma once

#include <cstddef>
#include <cstdint>

#include "sampling/hd.h"
#include "sampling/sph/cells.h"
#include "sampling/sph/model.h"

namespace abn::sph {

/// Which of the optional terms a plane needs: model only what is there.
struct Terms {
  Kernel kernel = Kernel::wendland;
  bool sized = false;    // a size field that varies: sizes, reaches and the background force
  bool classed = false;  // several classes: implies sized
  friend bool operator==(const Terms&, const Terms&) = default;
};

/// The sorted particles, as every pass reads them. All arrays are readable up to 8 particles past the end.
template <class Real>
struct ParticleView {
  CellView<Real> cells;
  const std::uint32_t* cell_start = nullptr;
  const Real* x = nullptr;               // [d]
  const Real* y = nullptr;               // [d]
  const Real* size = nullptr;            // s; used if sized
  const Real* reach = nullptr;           // largest s of any particle that may interact with this one; used if sized
  const Real* label = nullptr;           // class as a number; used if classed
  const Real* pressure = nullptr;        // force pass only
  const Real* class_pressure = nullptr;  // among its own class; force pass only, used if classed
  const std::uint32_t* id = nullptr;
  Real support = 2;        // H [d]
  Real class_support = 2;  // H sqrt(number of classes) [d]
};

/// The density among all particles and among those of its own class, before kernel_constant().
template <class Real>
struct DensitySum {
  Real all = 0, own = 0;
};

template <class Real>
struct Force {
  Real x = 0, y = 0;
};

/// How far particle i must look [d], rounding included.
template <class Real>
ABN_HD inline Real search_radius(const ParticleView<Real>& view, Terms terms, Real size, Real reach) {
  const Real support = terms.classed ? view.class_support : view.support;
  const Real radius = terms.sized ? support * Real(0.5) * (size + reach) : support;
  return radius + view.cells.rounding(radius);
}

/// Weight of the force among all particles and of that in the own class, each (Jiang et al. 2015 do not print theirs).
/// Measured with 4 classes, N = 16384, 25 iterations: mean nearest neighbour .798 together and .837 alone, against .785
/// and .826 with one half.
inline constexpr double class_share = 1.0;

template <Terms terms, class Real>
ABN_HD inline void add_density(DensitySum<Real>& sum, Real dx, Real dy, Real inverse_support,
                               Real inverse_class_support, Real size_i, Real size_j, Real label_i, Real label_j) {
  const Real factor = terms.sized ? warp(size_i, size_j) : Real(1);
  const Real r2 = dx * dx + dy * dy;
  sum.all += density_term<terms.kernel>(r2, inverse_support * factor);
  if constexpr (terms.classed) {
    const Real own = density_term<terms.kernel>(r2, inverse_class_support * factor);
    sum.own += label_i == label_j ? own : Real(0);
  }
}

/// The factor of (dx, dy) in the force of j on i.
template <Terms terms, class Real>
ABN_HD inline Real force_weight(Real r2, Real inverse_support, Real inverse_class_support, Real size_i, Real size_j,
                                Real label_i, Real label_j, Real pressure_i, Real pressure_j, Real class_pressure_i,
                                Real class_pressure_j) {
  const Real factor = terms.sized ? warp(size_i, size_j) : Real(1);
  Real weight = force_term<terms.kernel>(r2, inverse_support * factor, pressure_i, pressure_j);
  if constexpr (terms.classed) {
    const Real own = force_term<terms.kernel>(r2, inverse_class_support * factor, class_pressure_i, class_pressure_j);
    weight = Real(class_share) * (weight + (label_i == label_j ? own : Real(0)));
  }
  return terms.sized ? weight * factor : weight;
}

/// The force of particles at the very position of particle i, which has no direction of its own.
template <Terms terms, class Real>
ABN_HD inline void add_coincident_force(const ParticleView<Real>& view, std::size_t i, Force<Real>& force) {
  const std::uint32_t cell = view.cells.cell(view.x[i], view.y[i]);
  for (std::size_t j = view.cell_start[cell]; j < view.cell_start[cell + 1]; ++j) {
    if (j == i || view.x[i] != view.x[j] || view.y[i] != view.y[j]) continue;
    const Real weight = force_weight<terms>(
        Real(0), Real(0), Real(0), terms.sized ? view.size[i] : Real(1), terms.sized ? view.size[j] : Real(1),
        terms.classed ? view.label[i] : Real(0), terms.classed ? view.label[j] : Real(0), view.pressure[i],
        view.pressure[j], terms.classed ? view.class_pressure[i] : Real(0),
        terms.classed ? view.class_pressure[j] : Real(0));
    Real offset_x, offset_y;
    coincident_offset(view.id[i], view.id[j], offset_x, offset_y);
    force.x += weight * offset_x;
    force.y += weight * offset_y;
  }
}

/// Eq. 2.15 for particle i.
template <Terms terms, class Real>
ABN_HD inline DensitySum<Real> density_of(const ParticleView<Real>& view, std::size_t i) {
  const Real size_i = terms.sized ? view.size[i] : Real(1);
  const Real label_i = terms.classed ? view.label[i] : Real(0);
  const Real radius = search_radius(view, terms, size_i, terms.sized ? view.reach[i] : Real(1));
  const Real inverse_support = Real(1) / view.support;
  const Real inverse_class_support = Real(1) / view.class_support;
  DensitySum<Real> sum;
  for_each_run(view.cells, view.cell_start, view.x[i] - radius, view.x[i] + radius, view.y[i] - radius,
               view.y[i] + radius, [&](const Run& run) {
                 const Real x = view.x[i] - static_cast<Real>(run.image_x) * view.cells.length_x;
                 const Real y = view.y[i] - static_cast<Real>(run.image_y) * view.cells.length_y;
                 for (std::uint32_t j = run.begin; j < run.end; ++j) {
                   add_density<terms>(sum, x - view.x[j], y - view.y[j], inverse_support, inverse_class_support, size_i,
                                      terms.sized ? view.size[j] : Real(1), label_i,
                                      terms.classed ? view.label[j] : Real(0));
                 }
               });
  return sum;
}

/// Eq. 2.16 for particle i.
template <Terms terms, class Real>
ABN_HD inline Force<Real> force_on(const ParticleView<Real>& view, std::size_t i) {
  const Real size_i = terms.sized ? view.size[i] : Real(1);
  const Real label_i = terms.classed ? view.label[i] : Real(0);
  const Real class_pressure_i = terms.classed ? view.class_pressure[i] : Real(0);
  const Real radius = search_radius(view, terms, size_i, terms.sized ? view.reach[i] : Real(1));
  const Real inverse_support = Real(1) / view.support;
  const Real inverse_class_support = Real(1) / view.class_support;
  Force<Real> force;
  std::uint32_t coincident = 0;
  for_each_run(view.cells, view.cell_start, view.x[i] - radius, view.x[i] + radius, view.y[i] - radius,
               view.y[i] + radius, [&](const Run& run) {
                 const Real x = view.x[i] - static_cast<Real>(run.image_x) * view.cells.length_x;
                 const Real y = view.y[i] - static_cast<Real>(run.image_y) * view.cells.length_y;
                 for (std::uint32_t j = run.begin; j < run.end; ++j) {
                   const Real dx = x - view.x[j];
                   const Real dy = y - view.y[j];
                   const Real r2 = dx * dx + dy * dy;
                   const Real weight = force_weight<terms>(
                       r2, inverse_support, inverse_class_support, size_i, terms.sized ? view.size[j] : Real(1),
                       label_i, terms.classed ? view.label[j] : Real(0), view.pressure[i], view.pressure[j],
                       class_pressure_i, terms.classed ? view.class_pressure[j] : Real(0));
                   force.x += weight * dx;
                   force.y += weight * dy;
                   coincident += r2 == Real(0) ? 1U : 0U;
                 }
               });
  if (coincident > 1) add_coincident_force<terms>(view, i, force);
  return force;
}

/// Calls f.operator()<terms>() for the combination of terms at hand. A size field is part of classed planes.
template <class F>
decltype(auto) with_terms(Terms terms, F&& f) {
  const auto of_kernel = [&]<Kernel kernel>() -> decltype(auto) {
    if (terms.classed) return f.template operator()<Terms{kernel, true, true}>();
    if (terms.sized) return f.template operator()<Terms{kernel, true, false}>();
    return f.template operator()<Terms{kernel, false, false}>();
  };
  switch (terms.kernel) {
    case Kernel::wendland:
      return of_kernel.template operator()<Kernel::wendland>();
    case Kernel::poly6_spiky:
      return of_kernel.template operator()<Kernel::poly6_spiky>();
    case Kernel::cubic:
      break;
  }
  return of_kernel.template operator()<Kernel::cubic>();
}

/// What the kernels' sums are multiplied by: densities relative to N / area, also among the own class.
template <class Real>
struct DensityConstants {
  Real all = 1, own = 1;
};
template <class Real>
DensityConstants<Real> density_constants(Terms terms, double support, double class_support) {
  return with_terms(terms, [&]<Terms with>() {
    const double classes = class_support / support * (class_support / support);
    return DensityConstants<Real>{static_cast<Real>(kernel_constant<with.kernel>(support)),
                                  static_cast<Real>(kernel_constant<with.kernel>(class_support) * classes)};
  });
}

/// How a step moves particles.
template <class Real>
struct Motion {
  Real step = 0, damping = 0, cap = 0;
  Real length_x = 1, length_y = 1;  // of the torus, or of the plane between its walls [d]
  bool walls = false;
};

/// One leapfrog step of one free particle: velocity and position in place. Returns its displacement in local spacings,
/// or -1 if the step was not finite and was dropped.
template <class Real>
ABN_HD inline Real move_particle(const Motion<Real>& motion, Real force_x, Real force_y, Real size, Real& x, Real& y,
                                 Real& vx, Real& vy) {
  const Real moved = advance(vx, vy, force_x, force_y, motion.step, motion.damping, motion.cap);
  if (moved < Real(0)) return moved;
  const Real to_x = x + vx * size;
  const Real to_y = y + vy * size;
  x = motion.walls ? keep_inside(to_x, motion.length_x) : wrap(to_x, motion.length_x);
  y = motion.walls ? keep_inside(to_y, motion.length_y) : wrap(to_y, motion.length_y);
  return moved;
}

}  // namespace abn::sph
