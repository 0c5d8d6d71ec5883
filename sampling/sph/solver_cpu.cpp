// The engine to use: plain C++ and OpenMP, one template for float and double.
//
// A step: sort into cells, density, mean, pressure, force and leapfrog. Particles live in sorted order as a structure
// of arrays; the pair loops are in lanes.h. Determinism: every particle is summed by one thread in the order of its
// search, and statistics are summed in the order of fixed_sum.h.
#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sampling/sph/bodies.h"
#include "sampling/sph/cells.h"
#include "sampling/sph/fixed_sum.h"
#include "sampling/sph/lanes.h"
#include "sampling/sph/stepping_solver.h"

namespace abn::sph {
namespace {

constexpr std::size_t chunk_size = sum_chunk;          // particles that one thread takes at a time
constexpr std::size_t parallel_from = 8 * chunk_size;  // below, starting threads costs more than they save
constexpr int sort_parts = 4;                          // at most: each costs 4 B per cell

template <class Real>
class CpuSolver final : public SteppingSolver {
 public:
  CpuSolver(const Setup& setup, InstructionSet set) : SteppingSolver(setup), set_(set) { load(problem()); }
  CpuSolver(const Setup& setup, const Problem& given, InstructionSet set) : SteppingSolver(setup, given), set_(set) {
    load(problem());
  }

  Evaluation evaluate() override {
    find_pressures(false);
    Evaluation result;
    result.density.resize(problem().particles);
    result.force_x.resize(problem().particles);
    result.force_y.resize(problem().particles);
    for_each_chunk([&](std::size_t chunk, std::size_t begin, std::size_t end) {
      Forces forces;
      find_forces(chunk, begin, end, forces);
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t id = now_.id[i];
        if (id >= problem().particles) continue;
        result.density[id] = static_cast<double>(density_[i]);
        result.force_x[id] = static_cast<double>(forces.x[i - begin]);
        result.force_y[id] = static_cast<double>(forces.y[i - begin]);
      }
    });
    return result;
  }

  const char* backend() const override {
    if (sizeof(Real) == sizeof(double)) return "cpu double";
    return set_ == InstructionSet::avx2 ? "cpu avx2" : "cpu";
  }

 protected:
  void load(const Problem& problem) override {
    n_ = problem.count();
    passes_ = lane_passes<Real>(problem.terms, set_);
    cells_ = cells_for<Real>(problem);
    now_ = State(n_);
    next_ = State(n_);
    for (std::size_t i = 0; i < n_; ++i) {
      now_.x[i] = wrap(static_cast<Real>(problem.x[i]), static_cast<Real>(problem.field.length_x));
      now_.y[i] = wrap(static_cast<Real>(problem.y[i]), static_cast<Real>(problem.field.length_y));
      now_.id[i] = static_cast<std::uint32_t>(i);
    }
    density_.assign(n_ + lanes, Real(1));
    pressure_.assign(n_ + lanes, Real(1));
    const bool sized = problem.terms.sized;
    const bool classed = problem.terms.classed;
    size_.assign(sized ? n_ + lanes : 0, Real(1));
    reach_.assign(sized ? n_ + lanes : 0, Real(1));
    pull_x_.assign(sized ? n_ : 0, Real(0));
    pull_y_.assign(sized ? n_ : 0, Real(0));
    largest_in_tile_.assign(sized && !problem.field.uniform ? cells_.tiles().size() : 0, Real(0));
    largest_in_row_.assign(sized && !problem.field.uniform ? cells_.rows() : 0, Real(0));
    label_.assign(classed ? n_ + lanes : 0, Real(0));
    class_density_.assign(classed ? n_ + lanes : 0, Real(1));
    class_pressure_.assign(classed ? n_ + lanes : 0, Real(1));
    cell_.resize(n_);
    cells_known_ = false;
    chunks_ = std::vector<Chunk>((n_ + chunk_size - 1) / chunk_size);
  }

  void run(RelaxControl& control) override {
    while (!control.done) control.finish_step(step(control.report.step));
  }

  void store(std::vector<double>& x, std::vector<double>& y) override {
    for (std::size_t i = 0; i < n_; ++i) {
      x[now_.id[i]] = static_cast<double>(now_.x[i]);
      y[now_.id[i]] = static_cast<double>(now_.y[i]);
    }
  }

 private:
  StepSums step(double length) {
    StepSums sums;
    sums.mean_density = find_pressures(true);
    Motion<Real> motion;
    motion.step = static_cast<Real>(length);
    motion.damping = static_cast<Real>(setup().damping);
    motion.cap = static_cast<Real>(setup().velocity_cap);
    motion.walls = problem().walls;
    motion.length_x = static_cast<Real>(motion.walls ? problem().plane_x : problem().field.length_x);
    motion.length_y = static_cast<Real>(motion.walls ? problem().plane_y : problem().field.length_y);
    const auto tolerance = static_cast<Real>(setup().tolerance);
    const std::uint8_t* fixed = this->fixed().empty() ? nullptr : this->fixed().data();
    const bool sized = problem().terms.sized;
    const CellView<Real> grid = cells_.view();
    for_each_chunk([&](std::size_t c, std::size_t begin, std::size_t end) {
      Forces forces;
      find_forces(c, begin, end, forces);
      Chunk& chunk = chunks_[c];
      ChunkSum displacement;
      chunk.max_displacement = 0;
      chunk.moving = chunk.non_finite = 0;
      for (std::size_t i = begin; i < end; ++i) {
        next_.x[i] = now_.x[i];
        next_.y[i] = now_.y[i];
        if (fixed != nullptr && fixed[now_.id[i]] != 0) {
          now_.vx[i] = now_.vy[i] = Real(0);
          cell_[i] = grid.cell(next_.x[i], next_.y[i]);
          continue;
        }
        const Real moved = move_particle(motion, forces.x[i - begin], forces.y[i - begin], sized ? size_[i] : Real(1),
                                         next_.x[i], next_.y[i], now_.vx[i], now_.vy[i]);
        cell_[i] = grid.cell(next_.x[i], next_.y[i]);
        if (moved < Real(0)) {
          ++chunk.non_finite;
          continue;
        }
        displacement.add(i - begin, static_cast<double>(moved));
        chunk.max_displacement = std::max(chunk.max_displacement, static_cast<double>(moved));
        chunk.moving += moved >= tolerance ? 1 : 0;
      }
      chunk.displacement = displacement.total();
    });
    std::swap(now_.x, next_.x);
    std::swap(now_.y, next_.y);
    cells_known_ = true;
    sums.displacement = sum_of(&Chunk::displacement);
    for (const Chunk& chunk : chunks_) {
      sums.max_displacement = std::max(sums.max_displacement, chunk.max_displacement);
      sums.moving += chunk.moving;
      sums.non_finite += chunk.non_finite;
    }
    return sums;
  }

  /// A particle per index, in sorted order; padded so that a block may read past the end.
  struct State {
    explicit State(std::size_t n = 0) : x(n + lanes), y(n + lanes), vx(n), vy(n), id(n) {}
    std::vector<Real> x, y;    // [d], on the torus
    std::vector<Real> vx, vy;  // [local spacing per step]
    std::vector<std::uint32_t> id;
  };

  /// What is kept of a chunk of sorted particles within a step; cache lines of its own, because threads write
  /// neighbouring chunks at the same time.
  struct alignas(64) Chunk {
    BlockRuns blocks;
    bool coincident = false;  // two particles of the chunk or its neighbourhood share a place
    double density = 0, class_density = 0;
    double displacement = 0, max_displacement = 0;
    std::uint64_t moving = 0, non_finite = 0;
  };

  struct Forces {
    std::array<Real, chunk_size> x, y;
  };

  /// Calls f(chunk, begin, end) for the chunks of sorted particles, in parallel.
  template <class F>
  void for_each_chunk(F&& f) {
    const auto count = static_cast<std::int64_t>(chunks_.size());
#pragma omp parallel for schedule(dynamic, 1) if (n_ >= parallel_from)
    for (std::int64_t c = 0; c < count; ++c) {
      const auto chunk = static_cast<std::size_t>(c);
      f(chunk, chunk * chunk_size, std::min(n_, (chunk + 1) * chunk_size));
    }
  }

  double sum_of(double Chunk::*value) const {
    std::vector<double> values;
    values.reserve(chunks_.size());
    for (const Chunk& chunk : chunks_) values.push_back(chunk.*value);
    return fixed_order_sum(std::move(values));
  }

  ParticleView<Real> view() const {
    ParticleView<Real> view;
    view.cells = cells_.view();
    view.cell_start = cell_start_.data();
    view.x = now_.x.data();
    view.y = now_.y.data();
    view.size = size_.data();
    view.reach = reach_.data();
    view.label = label_.data();
    view.pressure = pressure_.data();
    view.class_pressure = class_pressure_.data();
    view.id = now_.id.data();
    view.support = static_cast<Real>(problem().support);
    view.class_support = static_cast<Real>(problem().class_support);
    return view;
  }

  /// Sorts the particles into cells and reads the size field where they are.
  void sort() {
    if (!cells_known_) {
      const CellView<Real> grid = cells_.view();
      for_each_chunk([&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) cell_[i] = grid.cell(now_.x[i], now_.y[i]);
      });
    }
    cells_known_ = false;
    const int parts = n_ >= parallel_from ? std::min(sort_parts, omp_get_max_threads()) : 1;
    cell_sort_.sort(cell_, now_.id, cells_.size(), parts, order_, cell_start_);
    const bool sized = problem().terms.sized && !problem().field.uniform;
    const FieldView<Real> field = problem().field.template view<Real>();
    const bool classed = problem().terms.classed;
    for_each_chunk([&](std::size_t chunk, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t from = order_[i];
        next_.x[i] = now_.x[from];
        next_.y[i] = now_.y[from];
        next_.vx[i] = now_.vx[from];
        next_.vy[i] = now_.vy[from];
        next_.id[i] = now_.id[from];
        if (sized) {
          const FieldSample<Real> here = sample_field(field, next_.x[i], next_.y[i]);
          size_[i] = here.size;
          reach_[i] = here.reach;
          pull_x_[i] = here.pull_x;
          pull_y_[i] = here.pull_y;
        }
        if (classed) label_[i] = static_cast<Real>(problem().labels[next_.id[i]]);
      }
      chunks_[chunk].coincident = has_coincident(begin, end);
    });
    std::swap(now_.x, next_.x);
    std::swap(now_.y, next_.y);
    std::swap(now_.vx, next_.vx);
    std::swap(now_.vy, next_.vy);
    std::swap(now_.id, next_.id);
    find_largest();
  }

  /// The largest s of the particles in every tile and every row of its cells.
  void find_largest() {
    if (largest_in_row_.empty()) return;
    const std::span<const Tile<Real>> tiles = cells_.tiles();
    const auto count = static_cast<std::int64_t>(tiles.size());
#pragma omp parallel for schedule(static) if (n_ >= parallel_from)
    for (std::int64_t t = 0; t < count; ++t) {
      const Tile<Real>& tile = tiles[static_cast<std::size_t>(t)];
      Real in_tile = 0;
      for (std::int32_t row = 0; row < tile.rows; ++row) {
        const std::uint32_t* start = cell_start_.data() + tile.first + static_cast<std::uint32_t>(row * tile.columns);
        Real in_row = 0;
        for (std::uint32_t i = start[0]; i < start[tile.columns]; ++i) in_row = std::max(in_row, size_[i]);
        largest_in_row_[tile.first_row + static_cast<std::uint32_t>(row)] = in_row;
        in_tile = std::max(in_tile, in_row);
      }
      largest_in_tile_[static_cast<std::size_t>(t)] = in_tile;
    }
  }

  /// True if a particle of the chunk shares its very place with another one; such two lie in the same cell. Reads the
  /// particles as they were before the sort where a cell lies in two chunks, because another thread may write those.
  bool has_coincident(std::size_t begin, std::size_t end) const {
    const auto x = [&](std::size_t i) { return i >= begin && i < end ? next_.x[i] : now_.x[order_[i]]; };
    const auto y = [&](std::size_t i) { return i >= begin && i < end ? next_.y[i] : now_.y[order_[i]]; };
    const std::uint32_t last = cell_[order_[end - 1]];
    for (std::uint32_t cell = cell_[order_[begin]]; cell <= last; ++cell) {
      const std::size_t cell_end = cell_start_[cell + 1];
      if (cell_end - cell_start_[cell] > 64) return true;  // not searched: more than a cell should hold
      for (std::size_t i = cell_start_[cell]; i + 1 < cell_end; ++i) {
        for (std::size_t k = i + 1; k < cell_end; ++k) {
          if (x(k) == x(i) && y(k) == y(i)) return true;
        }
      }
    }
    return false;
  }

  /// Sorts, sums the densities and turns them into pressures; returns the mean density of all but the ghosts.
  /// `skip_fixed`: nobody will ask for the densities, nor for the forces on fixed particles.
  double find_pressures(bool skip_fixed) {
    sort();
    const ParticleView<Real> all = view();
    const Terms terms = problem().terms;
    const DensityConstants<Real> constant = density_constants<Real>(terms, problem().support, problem().class_support);
    const std::uint8_t* fixed = skip_fixed && !this->fixed().empty() ? this->fixed().data() : nullptr;
    const std::size_t particles = problem().particles;
    // Then every pressure is 1 whatever the densities are.
    const bool no_densities = skip_fixed && std::isinf(setup().stiffness_ratio);
    const LargestSizes<Real> largest{largest_in_tile_.data(), largest_in_row_.data()};
    for_each_chunk([&](std::size_t c, std::size_t begin, std::size_t end) {
      Chunk& chunk = chunks_[c];
      find_blocks(all, terms, begin, end, fixed, largest_in_row_.empty() ? nullptr : &largest, chunk.blocks);
      if (no_densities) return;
      passes_.density(all, chunk.blocks, density_.data(), class_density_.data());
      ChunkSum total;
      ChunkSum class_total;
      for (std::size_t i = begin; i < end; ++i) {
        density_[i] *= constant.all;
        if (terms.classed) class_density_[i] *= constant.own;
        if (now_.id[i] >= particles) continue;
        total.add(i - begin, static_cast<double>(density_[i]));
        if (terms.classed) class_total.add(i - begin, static_cast<double>(class_density_[i]));
      }
      chunk.density = total.total();
      chunk.class_density = terms.classed ? class_total.total() : 0;
    });
    if (no_densities) return 1;
    const double density = sum_of(&Chunk::density) / static_cast<double>(particles);
    const double class_density = sum_of(&Chunk::class_density) / static_cast<double>(particles);
    const auto mean = static_cast<Real>(density);
    const auto class_mean = static_cast<Real>(class_density);
    const Real inverse_delta = Real(1) / static_cast<Real>(setup().stiffness_ratio);
    for_each_chunk([&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        pressure_[i] = pressure(density_[i], mean, inverse_delta);
        if (terms.classed) class_pressure_[i] = pressure(class_density_[i], class_mean, inverse_delta);
      }
    });
    return density;
  }

  /// The forces on a chunk: pressure less background. Zero or unset for fixed particles.
  void find_forces(std::size_t chunk, std::size_t begin, std::size_t end, Forces& forces) const {
    const ParticleView<Real> all = view();
    passes_.force(all, chunks_[chunk].blocks, begin, forces.x.data(), forces.y.data());
    if (chunks_[chunk].coincident) add_coincident(all, begin, end, forces);
    if (!problem().terms.sized) return;
    for (std::size_t i = begin; i < end; ++i) {
      forces.x[i - begin] -= pull_x_[i];
      forces.y[i - begin] -= pull_y_[i];
    }
  }

  void add_coincident(const ParticleView<Real>& all, std::size_t begin, std::size_t end, Forces& forces) const {
    with_terms(problem().terms, [&]<Terms terms>() {
      for (std::size_t i = begin; i < end; ++i) {
        Force<Real> force{forces.x[i - begin], forces.y[i - begin]};
        add_coincident_force<terms>(all, i, force);
        forces.x[i - begin] = force.x;
        forces.y[i - begin] = force.y;
      }
    });
  }

  InstructionSet set_;
  std::size_t n_ = 0;  // ghosts included
  LanePasses<Real> passes_;
  Cells<Real> cells_{1, 1, 1};
  State now_, next_;
  std::vector<Real> density_, pressure_;                      // in sorted order
  std::vector<Real> size_, reach_, pull_x_, pull_y_;          // likewise; only if sized
  std::vector<Real> largest_in_tile_, largest_in_row_;        // s; only with a field that varies
  std::vector<Real> label_, class_density_, class_pressure_;  // likewise; only if classed
  std::vector<std::uint32_t> cell_, order_;                   // scratch of the sort
  std::vector<std::uint32_t> cell_start_;
  bool cells_known_ = false;  // cell_ holds the cells of the particles where they are now
  CellSort cell_sort_;
  std::vector<Chunk> chunks_;
};

}  // namespace

std::unique_ptr<Solver> make_cpu_solver(const Setup& setup) {
  return std::make_unique<CpuSolver<float>>(setup, best_instruction_set());
}

std::unique_ptr<Solver> make_cpu_solver_baseline(const Setup& setup) {
  return std::make_unique<CpuSolver<float>>(setup, InstructionSet::baseline);
}

std::unique_ptr<Solver> make_cpu_solver_double(const Setup& setup) {
  return std::make_unique<CpuSolver<double>>(setup, best_instruction_set());
}

std::unique_ptr<Solver> make_cpu_solver_on(const Setup& setup, const Problem& problem) {
  return std::make_unique<CpuSolver<float>>(setup, problem, best_instruction_set());
}

}  // namespace abn::sph
