// The host loop: the bodies that a GPU's kernels run, called for every block and thread of a launch in turn. A machine
// without a GPU so tests what the kernels compute, order of particles included, bit for bit against the vectorised
// engine.
#include <algorithm>
#include <cmath>
#include <vector>

#include "sampling/sph/bodies.h"
#include "sampling/sph/cells.h"
#include "sampling/sph/stepping_solver.h"

namespace abn::sph {
namespace {

constexpr std::size_t block_size = 128;   // threads of a launch's block
constexpr std::size_t chunk_size = 1024;  // particles whose statistics are summed together: as the vectorised engine

/// A kernel launch: f(i) for i in [0,n), block by block; threads past the end return at once, as on the device.
template <class F>
void launch(std::size_t n, const F& f) {
  for (std::size_t block = 0; block < (n + block_size - 1) / block_size; ++block) {
    for (std::size_t thread = 0; thread < block_size; ++thread) {
      const std::size_t i = block * block_size + thread;
      if (i < n) f(i);
    }
  }
}

class HostLoopSolver final : public SteppingSolver {
 public:
  explicit HostLoopSolver(const Setup& setup) : SteppingSolver(setup) { load(problem()); }

  Evaluation evaluate() override {
    find_pressures();
    Evaluation result;
    result.density.resize(problem().particles);
    result.force_x.resize(problem().particles);
    result.force_y.resize(problem().particles);
    with_terms(problem().terms, [&]<Terms terms>() {
      const ParticleView<float> all = view();
      launch(n_, [&](std::size_t i) {
        if (id_[i] >= problem().particles) return;
        const Force<float> force = total_force<terms>(all, i);
        result.density[id_[i]] = double{density_[i]};
        result.force_x[id_[i]] = double{force.x};
        result.force_y[id_[i]] = double{force.y};
      });
    });
    return result;
  }

  const char* backend() const override { return "host loop"; }

 protected:
  void load(const Problem& problem) override {
    n_ = problem.count();
    cells_ = cells_for<float>(problem);
    x_.resize(n_);
    y_.resize(n_);
    vx_.assign(n_, 0);
    vy_.assign(n_, 0);
    id_.resize(n_);
    for (std::size_t i = 0; i < n_; ++i) {
      x_[i] = wrap(static_cast<float>(problem.x[i]), static_cast<float>(problem.field.length_x));
      y_[i] = wrap(static_cast<float>(problem.y[i]), static_cast<float>(problem.field.length_y));
      id_[i] = static_cast<std::uint32_t>(i);
    }
    density_.assign(n_, 1);
    pressure_.assign(n_, 1);
    class_density_.assign(n_, 1);
    class_pressure_.assign(n_, 1);
    here_.assign(n_, {});
    size_.assign(n_, 1);
    reach_.assign(n_, 1);
    label_.assign(n_, 0);
  }

  StepSums step(double length) override {
    StepSums sums;
    sums.mean_density = find_pressures();
    Motion<float> motion;
    motion.step = static_cast<float>(length);
    motion.damping = setup().damping;
    motion.cap = setup().velocity_cap;
    motion.walls = problem().walls;
    motion.length_x = static_cast<float>(motion.walls ? problem().plane_x : problem().field.length_x);
    motion.length_y = static_cast<float>(motion.walls ? problem().plane_y : problem().field.length_y);
    std::vector<float> next_x = x_;
    std::vector<float> next_y = y_;
    std::vector<float> moved(n_, 0);
    with_terms(problem().terms, [&]<Terms terms>() {
      const ParticleView<float> all = view();
      launch(n_, [&](std::size_t i) {
        if (!fixed().empty() && fixed()[id_[i]] != 0) {
          vx_[i] = vy_[i] = 0;
          return;
        }
        const Force<float> force = total_force<terms>(all, i);
        moved[i] = move_particle(motion, force.x, force.y, size_[i], next_x[i], next_y[i], vx_[i], vy_[i]);
      });
    });
    x_.swap(next_x);
    y_.swap(next_y);
    for (std::size_t begin = 0; begin < n_; begin += chunk_size) {
      double total = 0;
      for (std::size_t i = begin; i < std::min(n_, begin + chunk_size); ++i) {
        if (moved[i] < 0) {
          ++sums.non_finite;
          continue;
        }
        total += double{moved[i]};
        sums.max_displacement = std::max(sums.max_displacement, double{moved[i]});
        sums.moving += moved[i] >= setup().tolerance && moved[i] > 0 ? 1 : 0;
      }
      sums.displacement += total;
    }
    return sums;
  }

  void store(std::vector<double>& x, std::vector<double>& y) override {
    for (std::size_t i = 0; i < n_; ++i) {
      x[id_[i]] = double{x_[i]};
      y[id_[i]] = double{y_[i]};
    }
  }

 private:
  template <Terms terms>
  Force<float> total_force(const ParticleView<float>& all, std::size_t i) const {
    Force<float> force = force_on<terms>(all, i);
    if constexpr (terms.sized) {
      force.x -= here_[i].pull_x;
      force.y -= here_[i].pull_y;
    }
    return force;
  }

  ParticleView<float> view() const {
    ParticleView<float> view;
    view.cells = cells_.view();
    view.cell_start = cell_start_.data();
    view.x = x_.data();
    view.y = y_.data();
    view.size = size_.data();
    view.reach = reach_.data();
    view.label = label_.data();
    view.pressure = pressure_.data();
    view.class_pressure = class_pressure_.data();
    view.id = id_.data();
    view.support = static_cast<float>(problem().support);
    view.class_support = static_cast<float>(problem().class_support);
    return view;
  }

  template <class T>
  void permute(std::vector<T>& values) const {
    std::vector<T> sorted(values.size());
    for (std::size_t i = 0; i < n_; ++i) sorted[i] = values[order_[i]];
    values.swap(sorted);
  }

  void sort() {
    const CellView<float> grid = cells_.view();
    std::vector<std::uint32_t> cell(n_);
    launch(n_, [&](std::size_t i) { cell[i] = grid.cell(x_[i], y_[i]); });
    CellSort().sort(cell, id_, cells_.size(), 1, order_, cell_start_);
    permute(x_);
    permute(y_);
    permute(vx_);
    permute(vy_);
    permute(id_);
    if (problem().terms.classed) {
      launch(n_, [&](std::size_t i) { label_[i] = static_cast<float>(problem().labels[id_[i]]); });
    }
    if (problem().field.uniform) return;
    const FieldView<float> field = problem().field.view<float>();
    launch(n_, [&](std::size_t i) {
      here_[i] = sample_field(field, x_[i], y_[i]);
      size_[i] = here_[i].size;
      reach_[i] = here_[i].reach;
    });
  }

  double find_pressures() {
    sort();
    const DensityConstants<float> constant =
        density_constants<float>(problem().terms, problem().support, problem().class_support);
    with_terms(problem().terms, [&]<Terms terms>() {
      const ParticleView<float> all = view();
      launch(n_, [&](std::size_t i) {
        const DensitySum<float> sum = density_of<terms>(all, i);
        density_[i] = sum.all * constant.all;
        if constexpr (terms.classed) class_density_[i] = sum.own * constant.own;
      });
    });
    const double mean = mean_of(density_);
    const double class_mean = problem().terms.classed ? mean_of(class_density_) : 1;
    const float inverse_delta = 1 / setup().stiffness_ratio;
    launch(n_, [&](std::size_t i) {
      pressure_[i] = pressure(density_[i], static_cast<float>(mean), inverse_delta);
      class_pressure_[i] = pressure(class_density_[i], static_cast<float>(class_mean), inverse_delta);
    });
    return mean;
  }

  /// Over all but the ghosts, chunk by chunk.
  double mean_of(const std::vector<float>& values) const {
    double total = 0;
    for (std::size_t begin = 0; begin < n_; begin += chunk_size) {
      double chunk = 0;
      for (std::size_t i = begin; i < std::min(n_, begin + chunk_size); ++i) {
        if (id_[i] < problem().particles) chunk += double{values[i]};
      }
      total += chunk;
    }
    return total / static_cast<double>(problem().particles);
  }

  std::size_t n_ = 0;
  Cells<float> cells_{1, 1, 1};
  std::vector<float> x_, y_, vx_, vy_, density_, pressure_, class_density_, class_pressure_, size_, reach_, label_;
  std::vector<FieldSample<float>> here_;
  std::vector<std::uint32_t> id_, order_, cell_start_;
};

}  // namespace

std::unique_ptr<Solver> make_host_loop_solver(const Setup& setup) { return std::make_unique<HostLoopSolver>(setup); }

}  // namespace abn::sph
