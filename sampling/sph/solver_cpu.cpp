// The reference engine: plain C++ and OpenMP, one template for float and double.
//
// A step: sort into cells, density, mean, pressure, force and leapfrog. Particles live in sorted order as a structure
// of arrays; eight consecutive ones of a cell row share one search and sit in eight lanes, so that the pair loops
// vectorise without intrinsics (AVX2 or baseline, equal bit for bit). Determinism: every particle is summed by one
// thread in the order of its search, and statistics are summed per chunk of a fixed number of particles, then over the
// chunks in order.
#include <omp.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "sampling/error.h"
#include "sampling/sph/cells.h"
#include "sampling/sph/model.h"
#include "sampling/sph/size_field.h"
#include "sampling/sph/solver.h"
#include "sampling/vector_clones.h"

namespace abn::sph {
namespace {

constexpr std::size_t lanes = 8;
constexpr std::size_t chunk_size = 1024;               // particles whose statistics are summed together
constexpr std::size_t parallel_from = 8 * chunk_size;  // below, starting threads costs more than they save
constexpr int sort_parts = 4;                          // at most: each costs 4 B per cell

/// One value in each lane.
template <class Real>
struct alignas(lanes * sizeof(Real)) Pack {
  Real lane[lanes];
};

/// The sorted particles as the pair loops read them.
template <class Real>
struct Particles {
  const Real* x;
  const Real* y;
  const Real* size;      // s_i; null on a uniform plane
  const Real* pressure;  // null in the density pass
};

/// Eight particles, seen from one image of the plane.
template <class Real>
struct Block {
  Pack<Real> x, y, size, pressure;
};

template <bool sized, class Real>
ABN_VECTOR_CLONES void add_density(const Particles<Real>& all, std::size_t begin, std::size_t end,
                                   const Block<Real>& block, Real inverse_support, Pack<Real>& density) {
  Pack<Real> sum = density;
  for (std::size_t j = begin; j < end; ++j) {
    const Real xj = all.x[j];
    const Real yj = all.y[j];
    const Real size_j = sized ? all.size[j] : Real(1);
#pragma omp simd
    for (std::size_t k = 0; k < lanes; ++k) {
      const Real dx = block.x.lane[k] - xj;
      const Real dy = block.y.lane[k] - yj;
      const Real factor = sized ? warp(block.size.lane[k], size_j) : Real(1);
      sum.lane[k] += density_term(dx * dx + dy * dy, inverse_support * factor);
    }
  }
  density = sum;
}

template <class Real>
struct ForceSum {
  Pack<Real> x{}, y{};
  Pack<Real> coincident{};  // number of particles at the same position, itself included
};

template <bool sized, class Real>
ABN_VECTOR_CLONES void add_force(const Particles<Real>& all, std::size_t begin, std::size_t end,
                                 const Block<Real>& block, Real inverse_support, ForceSum<Real>& force) {
  Pack<Real> fx = force.x;
  Pack<Real> fy = force.y;
  Pack<Real> coincident = force.coincident;
  for (std::size_t j = begin; j < end; ++j) {
    const Real xj = all.x[j];
    const Real yj = all.y[j];
    const Real size_j = sized ? all.size[j] : Real(1);
    const Real pressure_j = all.pressure[j];
#pragma omp simd
    for (std::size_t k = 0; k < lanes; ++k) {
      const Real dx = block.x.lane[k] - xj;
      const Real dy = block.y.lane[k] - yj;
      const Real factor = sized ? warp(block.size.lane[k], size_j) : Real(1);
      const Real r2 = dx * dx + dy * dy;
      const Real weight = force_term(r2, inverse_support * factor, block.pressure.lane[k], pressure_j) * factor;
      fx.lane[k] += weight * dx;
      fy.lane[k] += weight * dy;
      coincident.lane[k] += r2 == Real(0) ? Real(1) : Real(0);
    }
  }
  force.x = fx;
  force.y = fy;
  force.coincident = coincident;
}

void require(bool good, const char* key, double value, const char* remedy) {
  if (!good) {
    throw ConfigError(std::string("SPH ") + key + " = " + std::to_string(value) + ": it must be " + remedy);
  }
}

void validate(const Setup& setup) {
  require(setup.plane.area() > 0, "plane area [px]", static_cast<double>(setup.plane.area()), "at least 1");
  const auto n = static_cast<double>(setup.positions.size());
  require(n >= 1 && n <= 4294967295.0, "number of particles", n, "between 1 and 2^32-1");
  require(setup.support_radius > 0 && setup.support_radius <= 100, "support_radius", setup.support_radius,
          "in (0, 100] spacings");
  require(setup.stiffness_ratio > 0, "stiffness_ratio", setup.stiffness_ratio, "> 0");
  require(setup.step >= 0 && std::isfinite(setup.step), "step", setup.step, "finite and >= 0");
  require(setup.damping >= 0 && setup.damping <= 1, "damping", setup.damping, "in [0, 1]");
  require(setup.velocity_cap > 0 && std::isfinite(setup.velocity_cap), "velocity_cap", setup.velocity_cap,
          "finite and > 0");
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

template <class Real>
class CpuSolver final : public Solver {
 public:
  explicit CpuSolver(const Setup& setup)
      : plane_(setup.plane),
        n_(setup.positions.size()),
        support_(static_cast<Real>(setup.support_radius)),
        inverse_delta_(Real(1) / static_cast<Real>(setup.stiffness_ratio)),
        step_(static_cast<Real>(setup.step)),
        damping_(static_cast<Real>(setup.damping)),
        cap_(static_cast<Real>(setup.velocity_cap)),
        tolerance_(setup.tolerance),
        spacing_(std::sqrt(static_cast<double>(plane_.area()) / static_cast<double>(n_))),
        now_(n_),
        next_(n_),
        density_(n_ + lanes),
        cell_(n_),
        chunks_((n_ + chunk_size - 1) / chunk_size),
        positions_(n_) {
    const auto box_x = static_cast<Real>(plane_.width / spacing_);
    const auto box_y = static_cast<Real>(plane_.height / spacing_);
    grid_ = CellGrid<Real>(box_x, box_y, support_);
    for (std::size_t i = 0; i < n_; ++i) {
      now_.x[i] = wrap(static_cast<Real>(setup.positions[i].x / spacing_), box_x);
      now_.y[i] = wrap(static_cast<Real>(setup.positions[i].y / spacing_), box_y);
      now_.id[i] = static_cast<std::uint32_t>(i);
    }
  }

  void set_size_field(const Grid<float>& s) override {
    // A spacing above sqrt(N) means less than one particle on the whole plane.
    field_ = normalised_size_field(s, std::sqrt(static_cast<double>(n_)));
    const auto [smallest, largest] = std::minmax_element(field_.cells().begin(), field_.cells().end());
    sized_ = *smallest < *largest;
    Real height = support_;
    if (sized_) {
      // Best at 1.5 to 3 supports of the smallest spacing (numerics.md); below 1 d the rows get too many.
      height = std::max(Real(1), Real(1.5) * support_ * static_cast<Real>(*smallest));
      now_.size.assign(n_ + lanes, Real(1));
    } else {
      now_.size.clear();
    }
    grid_ = CellGrid<Real>(grid_.length_x, grid_.length_y, height);
  }

  void freeze(std::span<const std::uint32_t> ids) override {
    frozen_.resize(n_, 0);
    for (const std::uint32_t id : ids) {
      assert(id < n_);
      frozen_count_ += frozen_[id] == 0 ? 1 : 0;
      frozen_[id] = 1;
    }
  }

  RelaxReport relax(int max_steps, bool stop_early) override {
    RelaxReport report;
    for (int step = 0; step < max_steps; ++step) {
      report.mean_density = update_pressure(nullptr);
      move(report);
      report.steps = step + 1;
      report.converged = report.mean_displacement < tolerance_;
      if (stop_early && report.converged) break;
    }
    return report;
  }

  Evaluation evaluate() override {
    Evaluation result;
    result.density.resize(n_);
    result.force_x.resize(n_);
    result.force_y.resize(n_);
    update_pressure(&result.density);
    for_each_force([&](std::size_t, std::size_t i, Real fx, Real fy) {
      result.force_x[now_.id[i]] = static_cast<double>(fx);
      result.force_y[now_.id[i]] = static_cast<double>(fy);
    });
    return result;
  }

  std::span<const Vec2f> positions() override {
    const float right = just_below(static_cast<float>(plane_.width));
    const float bottom = just_below(static_cast<float>(plane_.height));
    for (std::size_t i = 0; i < n_; ++i) {
      const auto x = static_cast<float>(static_cast<double>(now_.x[i]) * spacing_);
      const auto y = static_cast<float>(static_cast<double>(now_.y[i]) * spacing_);
      positions_[now_.id[i]] = {std::min(x, right), std::min(y, bottom)};
    }
    return positions_;
  }

  const char* backend() const override { return sizeof(Real) == sizeof(float) ? "cpu" : "cpu double"; }

 private:
  /// A particle per index, in sorted order; padded so that a block may read past the end.
  struct State {
    explicit State(std::size_t n) : x(n + lanes), y(n + lanes), vx(n), vy(n), id(n) {}
    std::vector<Real> x, y;    // [d], in the box
    std::vector<Real> vx, vy;  // [local spacing per step]
    std::vector<Real> size;    // s at the particle; empty on a uniform plane
    std::vector<std::uint32_t> id;
  };

  /// Statistics of one chunk; a cache line each, because threads write neighbouring chunks at the same time.
  struct alignas(64) Chunk {
    double density = 0;
    double displacement = 0;
    double max_displacement = 0;
    std::uint64_t non_finite = 0;
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

  /// Calls f(chunk, i, count) for blocks of at most eight consecutive particles of one cell row.
  template <class F>
  void for_each_block(F&& f) {
    for_each_chunk([&](std::size_t chunk, std::size_t begin, std::size_t end) {
      const auto columns = static_cast<std::size_t>(grid_.columns);
      std::size_t row = grid_.cell(now_.x[begin], now_.y[begin]) / columns;
      for (std::size_t i = begin; i < end;) {
        while (cell_start_[(row + 1) * columns] <= i) ++row;
        const std::size_t stop = std::min<std::size_t>({end, cell_start_[(row + 1) * columns], i + lanes});
        f(chunk, i, stop - i);
        i = stop;
      }
    });
  }

  /// Sorts the particles into cells and looks up their sizes.
  void sort() {
    for_each_chunk([&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) cell_[i] = grid_.cell(now_.x[i], now_.y[i]);
    });
    const int parts = n_ >= parallel_from ? std::min(sort_parts, omp_get_max_threads()) : 1;
    cell_sort_.sort(cell_, grid_.size(), parts, cell_start_);
    for_each_chunk([&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t place = cell_[i];
        next_.x[place] = now_.x[i];
        next_.y[place] = now_.y[i];
        next_.vx[place] = now_.vx[i];
        next_.vy[place] = now_.vy[i];
        next_.id[place] = now_.id[i];
      }
    });
    std::swap(now_.x, next_.x);
    std::swap(now_.y, next_.y);
    std::swap(now_.vx, next_.vx);
    std::swap(now_.vy, next_.vy);
    std::swap(now_.id, next_.id);
    if (!sized_) return;
    const auto width = static_cast<Real>(field_.size().width) / grid_.length_x;
    const auto height = static_cast<Real>(field_.size().height) / grid_.length_y;
    for_each_chunk([&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        now_.size[i] = bilinear_periodic(field_.cells().data(), field_.size().width, field_.size().height,
                                         now_.x[i] * width, now_.y[i] * height);
      }
    });
    largest_size_ = *std::max_element(now_.size.begin(), now_.size.begin() + static_cast<std::ptrdiff_t>(n_));
  }

  /// Calls f(begin, end, block) for the runs of particles that `count` particles from i on may meet; `block` holds
  /// the eight from i on, shifted to the image of the run.
  template <class F>
  void for_each_neighbour_run(std::size_t i, std::size_t count, const Real* pressures, F&& f) const {
    Block<Real> block;
    for (std::size_t k = 0; k < lanes; ++k) {
      block.size.lane[k] = sized_ ? now_.size[i + k] : Real(1);
      block.pressure.lane[k] = pressures != nullptr ? pressures[i + k] : Real(0);
    }
    const auto [left, right] = std::minmax_element(&now_.x[i], &now_.x[i] + count);
    const auto [top, bottom] = std::minmax_element(&now_.y[i], &now_.y[i] + count);
    Real reach = support_;
    if (sized_) {
      const Real largest_here = *std::max_element(&now_.size[i], &now_.size[i] + count);
      reach = support_ * Real(0.5) * (largest_here + largest_size_);
    }
    reach += grid_.rounding(reach);
    for_each_run(grid_, cell_start_.data(), *left - reach, *right + reach, *top - reach, *bottom + reach,
                 [&](std::size_t begin, std::size_t end, Real shift_x, Real shift_y) {
                   for (std::size_t k = 0; k < lanes; ++k) {
                     block.x.lane[k] = now_.x[i + k] - shift_x;
                     block.y.lane[k] = now_.y[i + k] - shift_y;
                   }
                   f(begin, end, block);
                 });
  }

  /// Sorts, sums the densities (copied out by id if asked for) and turns them into pressures; returns their mean.
  double update_pressure(std::vector<double>* densities) {
    sort();
    const Particles<Real> all{now_.x.data(), now_.y.data(), now_.size.data(), nullptr};
    const Real inverse_support = Real(1) / support_;
    const Real constant = kernel_constant(support_);
    for (Chunk& chunk : chunks_) chunk.density = 0;
    for_each_block([&](std::size_t chunk, std::size_t i, std::size_t count) {
      Pack<Real> sum{};
      for_each_neighbour_run(i, count, nullptr, [&](std::size_t begin, std::size_t end, const Block<Real>& block) {
        if (sized_) {
          add_density<true>(all, begin, end, block, inverse_support, sum);
        } else {
          add_density<false>(all, begin, end, block, inverse_support, sum);
        }
      });
      for (std::size_t k = 0; k < count; ++k) {
        density_[i + k] = constant * sum.lane[k];
        chunks_[chunk].density += static_cast<double>(density_[i + k]);
      }
    });
    double total = 0;
    for (const Chunk& chunk : chunks_) total += chunk.density;
    const double mean = total / static_cast<double>(n_);
    if (densities != nullptr) {
      for (std::size_t i = 0; i < n_; ++i) (*densities)[now_.id[i]] = static_cast<double>(density_[i]);
    }
    for_each_chunk([&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        density_[i] = pressure(density_[i], static_cast<Real>(mean), inverse_delta_);
      }
    });
    return mean;
  }

  /// Calls f(chunk, i, force_x, force_y) for every particle; needs update_pressure() first.
  template <class F>
  void for_each_force(F&& f) {
    const Particles<Real> all{now_.x.data(), now_.y.data(), now_.size.data(), density_.data()};
    const Real inverse_support = Real(1) / support_;
    for_each_block([&](std::size_t chunk, std::size_t i, std::size_t count) {
      ForceSum<Real> force;
      for_each_neighbour_run(i, count, density_.data(),
                             [&](std::size_t begin, std::size_t end, const Block<Real>& block) {
                               if (sized_) {
                                 add_force<true>(all, begin, end, block, inverse_support, force);
                               } else {
                                 add_force<false>(all, begin, end, block, inverse_support, force);
                               }
                             });
      for (std::size_t k = 0; k < count; ++k) {
        Real fx = force.x.lane[k];
        Real fy = force.y.lane[k];
        if (force.coincident.lane[k] > Real(1)) add_coincident(i + k, fx, fy);
        f(chunk, i + k, fx, fy);
      }
    });
  }

  /// The force of particles at the very position of particle i, which has no direction of its own.
  void add_coincident(std::size_t i, Real& fx, Real& fy) const {
    const std::uint32_t cell = grid_.cell(now_.x[i], now_.y[i]);
    for (std::size_t j = cell_start_[cell]; j < cell_start_[cell + 1]; ++j) {
      const Real dx = now_.x[i] - now_.x[j];
      const Real dy = now_.y[i] - now_.y[j];
      if (j == i || dx * dx + dy * dy != Real(0)) continue;
      const Real factor = sized_ ? warp(now_.size[i], now_.size[j]) : Real(1);
      const Real weight = force_term(Real(0), Real(0), density_[i], density_[j]) * factor;
      Real offset_x, offset_y;
      coincident_offset(now_.id[i], now_.id[j], offset_x, offset_y);
      fx += weight * offset_x;
      fy += weight * offset_y;
    }
  }

  /// One step of all free particles by the forces at their present positions.
  void move(RelaxReport& report) {
    std::fill(chunks_.begin(), chunks_.end(), Chunk{});
    for_each_force([&](std::size_t c, std::size_t i, Real fx, Real fy) {
      next_.x[i] = now_.x[i];
      next_.y[i] = now_.y[i];
      if (!frozen_.empty() && frozen_[now_.id[i]] != 0) {
        now_.vx[i] = now_.vy[i] = Real(0);
        return;
      }
      Chunk& chunk = chunks_[c];
      if (!advance(now_.vx[i], now_.vy[i], fx, fy, step_, damping_, cap_)) {
        ++chunk.non_finite;
        return;
      }
      const Real vx = now_.vx[i];
      const Real vy = now_.vy[i];
      const Real size = sized_ ? now_.size[i] : Real(1);
      next_.x[i] = wrap(now_.x[i] + vx * size, grid_.length_x);
      next_.y[i] = wrap(now_.y[i] + vy * size, grid_.length_y);
      const auto displacement = static_cast<double>(std::sqrt(vx * vx + vy * vy));
      chunk.displacement += displacement;
      chunk.max_displacement = std::max(chunk.max_displacement, displacement);
    });
    std::swap(now_.x, next_.x);
    std::swap(now_.y, next_.y);
    double total = 0;
    report.max_displacement = 0;
    for (const Chunk& chunk : chunks_) {
      total += chunk.displacement;
      report.max_displacement = std::max(report.max_displacement, chunk.max_displacement);
      report.non_finite += chunk.non_finite;
    }
    const std::size_t free = n_ - frozen_count_;
    report.mean_displacement = free > 0 ? total / static_cast<double>(free) : 0;
  }

  Extent plane_;
  std::size_t n_;
  Real support_, inverse_delta_, step_, damping_, cap_;
  double tolerance_;
  double spacing_;  // d [px]
  CellGrid<Real> grid_;
  Grid<float> field_;  // normalised s; used if sized_
  bool sized_ = false;
  Real largest_size_ = 1;  // of all particles
  State now_, next_;
  std::vector<Real> density_;        // in sorted order; holds pressures after update_pressure()
  std::vector<std::uint32_t> cell_;  // scratch of the sort
  std::vector<std::uint32_t> cell_start_;
  CellSort cell_sort_;
  std::vector<Chunk> chunks_;
  std::vector<std::uint8_t> frozen_;  // by id; empty until freeze()
  std::size_t frozen_count_ = 0;
  std::vector<Vec2f> positions_;  // by id [px]
};

}  // namespace

std::unique_ptr<Solver> make_cpu_solver(const Setup& setup) {
  validate(setup);
  return std::make_unique<CpuSolver<float>>(setup);
}

std::unique_ptr<Solver> make_cpu_solver_double(const Setup& setup) {
  validate(setup);
  return std::make_unique<CpuSolver<double>>(setup);
}

}  // namespace abn::sph
