#include "sampling/sph/stepping_solver.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace abn::sph {
namespace {

Problem validated_problem(const Setup& setup) {
  validate(setup);
  return make_problem(setup, setup.positions, setup.size_field);
}

Setup without_spans(Setup setup) {
  setup.positions = {};
  setup.classes = {};
  setup.size_field = nullptr;
  return setup;
}

/// Says when the step is too long: a relaxation that works loses a good part of its motion in every few steps; one that
/// rings or explodes does not.
class StepControl {
 public:
  /// True if the step should be reduced, given the mean displacement of the step just done [d].
  bool too_long(double mean_displacement) {
    window_ += mean_displacement;
    if (++count_ < length) return false;
    const double mean = window_ / length;
    // Slow drift below a few hundredths of a spacing is no instability: a size field or a frozen set settles slowly.
    const bool restless = previous_ > 0 && mean > 0.05 && mean > 0.9 * previous_;
    previous_ = restless ? 0 : mean;
    window_ = 0;
    count_ = 0;
    return restless;
  }

 private:
  static constexpr int length = 6;
  double window_ = 0, previous_ = 0;
  int count_ = 0;
};

}  // namespace

SteppingSolver::SteppingSolver(const Setup& setup) : SteppingSolver(setup, validated_problem(setup)) {}

SteppingSolver::SteppingSolver(const Setup& setup, Problem problem)
    : setup_(without_spans(setup)), problem_(std::move(problem)), positions_(problem_.particles) {
  fix_ghosts();
}

void SteppingSolver::fix_ghosts() {
  const std::size_t frozen = fixed_.size();
  if (frozen == 0 && problem_.count() == problem_.particles) return;
  fixed_.resize(problem_.particles, 0);
  fixed_.resize(problem_.count(), 1);
}

void SteppingSolver::set_size_field(const Grid<float>& s) {
  Setup setup = setup_;
  setup.classes = problem_.labels;
  const auto now = positions();
  const std::vector<Vec2f> places(now.begin(), now.end());
  // Labels live in the old problem until the new one is made.
  Problem next = make_problem(setup, places, &s);
  problem_ = std::move(next);
  fix_ghosts();
  load(problem_);
}

void SteppingSolver::freeze(std::span<const std::uint32_t> ids) {
  fixed_.resize(problem_.count(), 0);
  for (const std::uint32_t id : ids) {
    assert(id < problem_.particles);
    fixed_[id] = 1;
  }
}

RelaxReport SteppingSolver::relax(int max_steps, bool stop_early) {
  std::size_t free = problem_.particles;
  for (std::size_t i = 0; i < std::min(fixed_.size(), problem_.particles); ++i) free -= fixed_[i];
  RelaxReport report;
  report.step = double{setup_.step};
  // The pressure force is as stiff as 1 / Delta: beyond about 5 Delta a step overshoots; with the force of the own
  // class beside it, beyond 3.
  const double longest = problem_.terms.classed ? 2.5 : 4;
  if (setup_.adaptive_step) report.step = std::min(report.step, longest * double{setup_.stiffness_ratio});
  StepControl control;
  for (int s = 1; s <= max_steps; ++s) {
    const StepSums sums = step(report.step);
    report.steps = s;
    report.mean_density = sums.mean_density;
    report.mean_displacement = free > 0 ? sums.displacement / static_cast<double>(free) : 0;
    report.max_displacement = sums.max_displacement;
    report.still = free > 0 ? 1 - static_cast<double>(sums.moving) / static_cast<double>(free) : 1;
    report.non_finite += sums.non_finite;
    const bool mean_converged = report.mean_displacement < double{setup_.tolerance};
    const bool every_converged = sums.moving == 0;
    if (mean_converged && report.mean_converged_at < 0) report.mean_converged_at = s;
    if (every_converged && report.every_converged_at < 0) report.every_converged_at = s;
    report.converged = setup_.criterion == Criterion::mean ? mean_converged : every_converged;
    if (stop_early && report.converged) break;
    if (setup_.adaptive_step && control.too_long(report.mean_displacement)) {
      report.step *= 0.6;
      ++report.step_reductions;
    }
  }
  return report;
}

std::span<const Vec2f> SteppingSolver::positions() {
  store(problem_.x, problem_.y);
  const float right = just_below(static_cast<float>(setup_.plane.width));
  const float bottom = just_below(static_cast<float>(setup_.plane.height));
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    positions_[i] = {std::min(static_cast<float>(problem_.x[i] * problem_.spacing), right),
                     std::min(static_cast<float>(problem_.y[i] * problem_.spacing), bottom)};
  }
  return positions_;
}

std::span<const Vec2f> SteppingSolver::ghosts() {
  ghosts_.clear();
  for (std::size_t i = problem_.particles; i < problem_.count(); ++i) {
    ghosts_.push_back(to_pixels(problem_, problem_.x[i], problem_.y[i]));
  }
  return ghosts_;
}

}  // namespace abn::sph
