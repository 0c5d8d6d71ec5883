// The kernels of a step, as bodies that a device's threads run or a loop on the host.
//
// Two kinds. A body for indices: operator()(i), one thread per index. A body for blocks: phases of operator()(phase,
// block, thread, shared), with a barrier between phases. A body writes nothing that another thread of the same launch
// (or phase) reads, atomic additions apart, and no result depends on the order of those. What is done when the
// relaxation has ended (RelaxControl::done) is nothing.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sampling/hd.h"
#include "sampling/sph/bodies.h"
#include "sampling/sph/relax_control.h"
#include "sampling/sph/size_field.h"

namespace abn::sph_cuda {

/// Adds to a counter that other threads add to as well; returns what was there before.
ABN_HD inline std::uint32_t add_atomically(std::uint32_t* counter, std::uint32_t value) {
#ifdef __CUDA_ARCH__
  return atomicAdd(counter, value);
#else
  const std::uint32_t before = *counter;
  *counter = before + value;
  return before;
#endif
}

/// The particles, one per index.
struct ParticleArrays {
  float* x = nullptr;  // [d], on the torus
  float* y = nullptr;
  float* vx = nullptr;  // [local spacing per step]
  float* vy = nullptr;
  std::uint32_t* id = nullptr;
};

/// Counting sort, first part: each particle's cell and its number among those of the cell, in no particular order.
struct CountCells {
  const sph::RelaxControl* control;
  sph::CellView<float> cells;
  ParticleArrays from;
  std::uint32_t* cell;   // [n]
  std::uint32_t* place;  // [n], in the cell
  std::uint32_t* count;  // [cells + 1], 0 before
  ABN_HD void operator()(std::uint32_t i) const {
    if (control->done) return;
    const std::uint32_t here = cells.cell(from.x[i], from.y[i]);
    cell[i] = here;
    place[i] = add_atomically(count + here, 1);
  }
};

/// Second part, after cell_start has the first place of every cell: particle indices in the order of their cells.
struct ScatterIntoCells {
  const sph::RelaxControl* control;
  const std::uint32_t* cell;
  const std::uint32_t* place;
  const std::uint32_t* cell_start;  // [cells + 1]
  std::uint32_t* order;             // [n]
  ABN_HD void operator()(std::uint32_t i) const {
    if (!control->done) order[cell_start[cell[i]] + place[i]] = i;
  }
};

/// Third part: every cell's particles by id, which makes the order one of the state alone.
struct SortCells {
  const sph::RelaxControl* control;
  const std::uint32_t* id;  // [n], by index before the sort
  const std::uint32_t* cell_start;
  std::uint32_t* order;
  ABN_HD void operator()(std::uint32_t cell) const {
    if (control->done) return;
    std::uint32_t* first = order + cell_start[cell];
    const std::uint32_t count = cell_start[cell + 1] - cell_start[cell];
    if (count > 32) {  // many at one place: insertion would be quadratic
      heap_sort(first, count);
      return;
    }
    for (std::uint32_t k = 1; k < count; ++k) {
      const std::uint32_t moving = first[k];
      const std::uint32_t key = id[moving];
      std::uint32_t to = k;
      for (; to > 0 && id[first[to - 1]] > key; --to) first[to] = first[to - 1];
      first[to] = moving;
    }
  }

 private:
  ABN_HD void heap_sort(std::uint32_t* first, std::uint32_t count) const {
    for (std::uint32_t root = count / 2; root > 0; --root) sift(first, root - 1, count);
    for (std::uint32_t end = count - 1; end > 0; --end) {
      const std::uint32_t largest = first[0];
      first[0] = first[end];
      first[end] = largest;
      sift(first, 0, end);
    }
  }
  ABN_HD void sift(std::uint32_t* first, std::uint32_t root, std::uint32_t count) const {
    const std::uint32_t moving = first[root];
    for (std::uint32_t child = 2 * root + 1; child < count; child = 2 * root + 1) {
      if (child + 1 < count && id[first[child + 1]] > id[first[child]]) ++child;
      if (id[first[child]] < id[moving]) break;
      first[root] = first[child];
      root = child;
    }
    first[root] = moving;
  }
};

/// The particles in sorted order, and what the size field, the classes and the frozen set say of them.
struct GatherSorted {
  const sph::RelaxControl* control;
  const std::uint32_t* order;
  ParticleArrays from, to;
  sph::FieldView<float> field;   // cells null = uniform
  const std::uint8_t* label_of;  // class by id; null = one class
  float* size;                   // [n] each; written where there is a field
  float* reach;
  float* pull_x;
  float* pull_y;
  float* label;  // written where there are classes
  ABN_HD void operator()(std::uint32_t i) const {
    if (control->done) return;
    const std::uint32_t source = order[i];
    const float x = from.x[source];
    const float y = from.y[source];
    const std::uint32_t id = from.id[source];
    to.x[i] = x;
    to.y[i] = y;
    to.vx[i] = from.vx[source];
    to.vy[i] = from.vy[source];
    to.id[i] = id;
    if (field.cells != nullptr) {
      const sph::FieldSample<float> here = sph::sample_field(field, x, y);
      size[i] = here.size;
      reach[i] = here.reach;
      pull_x[i] = here.pull_x;
      pull_y[i] = here.pull_y;
    }
    if (label_of != nullptr) label[i] = static_cast<float>(label_of[id]);
  }
};

/// Eq. 2.15 at every particle.
template <sph::Terms terms>
struct FindDensity {
  const sph::RelaxControl* control;
  sph::ParticleView<float> all;
  sph::DensityConstants<float> constant;
  float* density;        // [n]
  float* class_density;  // [n]; written where there are classes
  ABN_HD void operator()(std::uint32_t i) const {
    if (control->done) return;
    const sph::DensitySum<float> sum = sph::density_of<terms>(all, i);
    density[i] = sum.all * constant.all;
    if constexpr (terms.classed) class_density[i] = sum.own * constant.own;
  }
};

/// Eqs. 2.17 and 2.18 at every particle.
struct FindPressure {
  const sph::RelaxControl* control;
  const float* density;
  const double* density_sum;  // over all but the ghosts
  double particles;           // all but the ghosts
  float inverse_delta;
  float* pressure;
  ABN_HD void operator()(std::uint32_t i) const {
    if (control->done) return;
    const auto mean = static_cast<float>(*density_sum / particles);
    pressure[i] = sph::pressure(density[i], mean, inverse_delta);
  }
};

/// What MoveParticles leaves in `moved` of a particle that is fixed; -1 says that its step was not finite.
inline constexpr float not_moved = -2;

/// Eq. 2.16 less the background force, without the leapfrog step.
template <sph::Terms terms>
ABN_HD inline sph::Force<float> total_force(const sph::ParticleView<float>& all, const float* pull_x,
                                            const float* pull_y, std::uint32_t i) {
  sph::Force<float> force = sph::force_on<terms>(all, i);
  if constexpr (terms.sized) {
    force.x -= pull_x[i];
    force.y -= pull_y[i];
  }
  return force;
}

/// Force and one leapfrog step of every particle that is not fixed.
template <sph::Terms terms>
struct MoveParticles {
  const sph::RelaxControl* control;
  sph::ParticleView<float> all;
  ParticleArrays from;  // sorted; what `all` reads
  ParticleArrays to;
  const float* pull_x;
  const float* pull_y;
  const std::uint8_t* fixed;  // by id; null = none
  sph::Motion<float> motion;  // but its step, which the control has
  float* moved;               // [n], in local spacings
  ABN_HD void operator()(std::uint32_t i) const {
    if (control->done) return;
    const std::uint32_t id = from.id[i];
    float x = from.x[i];
    float y = from.y[i];
    float vx = 0;
    float vy = 0;
    float distance = not_moved;
    if (fixed == nullptr || fixed[id] == 0) {
      vx = from.vx[i];
      vy = from.vy[i];
      sph::Motion<float> now = motion;
      now.step = static_cast<float>(control->report.step);
      const sph::Force<float> force = total_force<terms>(all, pull_x, pull_y, i);
      distance = sph::move_particle(now, force.x, force.y, terms.sized ? all.size[i] : 1.0F, x, y, vx, vy);
    }
    to.x[i] = x;
    to.y[i] = y;
    to.vx[i] = vx;
    to.vy[i] = vy;
    to.id[i] = id;
    moved[i] = distance;
  }
};

/// Density and force by id, for Solver::evaluate().
template <sph::Terms terms>
struct ReportForces {
  sph::ParticleView<float> all;
  const float* pull_x;
  const float* pull_y;
  const float* density;
  std::uint32_t particles;  // ids from there on are ghosts
  float* density_by_id;     // [particles] each
  float* force_x_by_id;
  float* force_y_by_id;
  ABN_HD void operator()(std::uint32_t i) const {
    const std::uint32_t id = all.id[i];
    if (id >= particles) return;
    const sph::Force<float> force = total_force<terms>(all, pull_x, pull_y, i);
    density_by_id[id] = density[i];
    force_x_by_id[id] = force.x;
    force_y_by_id[id] = force.y;
  }
};

/// Particle i at place i, at rest and free.
struct StartAtRest {
  ParticleArrays particles;
  std::uint8_t* fixed;
  ABN_HD void operator()(std::uint32_t i) const {
    particles.vx[i] = 0;
    particles.vy[i] = 0;
    particles.id[i] = i;
    fixed[i] = 0;
  }
};
struct StoreById {
  ParticleArrays from;
  float* x;
  float* y;
  ABN_HD void operator()(std::uint32_t i) const {
    x[from.id[i]] = from.x[i];
    y[from.id[i]] = from.y[i];
  }
};

template <class T>
struct Fill {
  T* values;
  T value;
  ABN_HD void operator()(std::uint32_t i) const { values[i] = value; }
};

}  // namespace abn::sph_cuda
