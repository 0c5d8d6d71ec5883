// The engine's two pair loops by themselves, and the same sums by the per-particle bodies in a scalar loop: what the
// speed test and the benchmark compare.
#pragma once

#include <ctime>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "sampling/sph/bodies.h"
#include "sampling/sph/cells.h"
#include "sampling/sph/lanes.h"
#include "sampling/sph/problem.h"

#if defined(__GNUC__) && !defined(__clang__)
#define ABN_SCALAR [[gnu::noinline, gnu::flatten, gnu::optimize("no-tree-vectorize,no-tree-slp-vectorize")]]
#else
#define ABN_SCALAR
#endif

namespace abn::sph {

/// CPU time of the calling thread [s].
inline double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <Terms terms>
ABN_SCALAR void scalar_densities(const ParticleView<float>& view, std::size_t n, float* density) {
  for (std::size_t i = 0; i < n; ++i) density[i] = density_of<terms>(view, i).all;
}
template <Terms terms>
ABN_SCALAR void scalar_forces(const ParticleView<float>& view, std::size_t n, float* x, float* y) {
  for (std::size_t i = 0; i < n; ++i) {
    const Force<float> force = force_on<terms>(view, i);
    x[i] = force.x;
    y[i] = force.y;
  }
}

/// Sorted particles of a plane without walls or classes, and the results of a pass over them, one thread.
class PairLoops {
 public:
  explicit PairLoops(const Problem& problem)
      : n_(problem.count()), terms_(problem.terms), cells_(cells_for<float>(problem)) {
    const CellView<float> grid = cells_.view();
    std::vector<float> x(n_), y(n_);
    std::vector<std::uint32_t> cell(n_), order;
    id_.resize(n_);
    std::iota(id_.begin(), id_.end(), 0U);
    for (std::size_t i = 0; i < n_; ++i) {
      x[i] = wrap(static_cast<float>(problem.x[i]), grid.length_x);
      y[i] = wrap(static_cast<float>(problem.y[i]), grid.length_y);
      cell[i] = grid.cell(x[i], y[i]);
    }
    CellSort().sort(cell, id_, cells_.size(), 1, order, cell_start_);
    id_ = order;
    for (auto* values : {&x_, &y_, &size_, &reach_, &pressure_, &density, &force_x, &force_y}) {
      values->assign(n_ + lanes, 1);
    }
    for (std::size_t i = 0; i < n_; ++i) {
      x_[i] = x[order[i]];
      y_[i] = y[order[i]];
      if (problem.field.uniform) continue;
      const FieldSample<float> here = sample_field(problem.field.view<float>(), x_[i], y_[i]);
      size_[i] = here.size;
      reach_[i] = here.reach;
    }
    view_.cells = grid;
    view_.cell_start = cell_start_.data();
    view_.x = x_.data();
    view_.y = y_.data();
    view_.size = size_.data();
    view_.reach = reach_.data();
    view_.pressure = pressure_.data();
    view_.id = id_.data();
    view_.support = static_cast<float>(problem.support);
    view_.class_support = static_cast<float>(problem.class_support);
  }

  /// Density, pressure, force by the vectorised passes, the search for neighbours included.
  void run(InstructionSet set) {
    const LanePasses<float> passes = lane_passes<float>(terms_, set);
    constexpr std::size_t chunk = 1024;
    blocks_.resize((n_ + chunk - 1) / chunk);
    for (std::size_t c = 0; c < blocks_.size(); ++c) {
      find_blocks(view_, terms_, c * chunk, std::min(n_, (c + 1) * chunk), nullptr,
                  static_cast<const LargestSizes<float>*>(nullptr), blocks_[c]);
      passes.density(view_, blocks_[c], density.data(), nullptr);
    }
    find_pressures();
    for (std::size_t c = 0; c < blocks_.size(); ++c) {
      passes.force(view_, blocks_[c], c * chunk, force_x.data() + c * chunk, force_y.data() + c * chunk);
    }
  }
  /// The same by density_of() and force_on(), not vectorised.
  void run_scalar() {
    with_terms(terms_, [&]<Terms terms>() { scalar_densities<terms>(view_, n_, density.data()); });
    find_pressures();
    with_terms(terms_, [&]<Terms terms>() { scalar_forces<terms>(view_, n_, force_x.data(), force_y.data()); });
  }
  /// The results of the last pass, in sorted order.
  std::vector<float> density, force_x, force_y;

 private:
  void find_pressures() {
    const float constant = density_constants<float>(terms_, double{view_.support}, double{view_.class_support}).all;
    for (std::size_t i = 0; i < n_; ++i) pressure_[i] = sph::pressure(density[i] * constant, 1.0F, 1 / 0.3F);
  }

  std::size_t n_;
  Terms terms_;
  Cells<float> cells_;
  std::vector<std::uint32_t> id_, cell_start_;
  std::vector<float> x_, y_, size_, reach_, pressure_;
  std::vector<BlockRuns> blocks_;
  ParticleView<float> view_;
};

/// The median of `repetitions` calls [s of this thread], after one that does not count.
template <class F>
double median_seconds(int repetitions, const F& f) {
  f();
  std::vector<double> times;
  for (int k = 0; k < repetitions; ++k) {
    const double start = thread_seconds();
    f();
    times.push_back(thread_seconds() - start);
  }
  std::nth_element(times.begin(), times.begin() + repetitions / 2, times.end());
  return times[static_cast<std::size_t>(repetitions / 2)];
}

}  // namespace abn::sph
