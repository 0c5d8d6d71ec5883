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
  if (!reload(s, problem_)) {
    Setup setup = setup_;
    setup.classes = problem_.labels;
    const auto now = positions();
    const std::vector<Vec2f> places(now.begin(), now.end());
    // Labels live in the old problem until the new one is made.
    Problem next = make_problem(setup, places, &s);
    problem_ = std::move(next);
    load(problem_);
  }
  fix_ghosts();
}

void SteppingSolver::freeze(std::span<const std::uint32_t> ids) {
  fixed_.resize(problem_.count(), 0);
  for (const std::uint32_t id : ids) {
    assert(id < problem_.particles);
    fixed_[id] = 1;
  }
}

RelaxControl relax_control(const Setup& setup, bool classed, std::uint64_t free, int max_steps, bool stop_early) {
  RelaxControl control;
  control.free = free;
  control.max_steps = max_steps;
  control.tolerance = double{setup.tolerance};
  control.by_mean = setup.criterion == Criterion::mean;
  control.stop_early = stop_early;
  control.adaptive_step = setup.adaptive_step;
  control.done = max_steps <= 0;
  control.report.step = double{setup.step};
  // The pressure force is as stiff as 1 / Delta: beyond about 5 Delta a step overshoots; with the force of the own
  // class beside it, beyond 3.
  const double longest = classed ? 2.5 : 4;
  if (setup.adaptive_step) control.report.step = std::min(control.report.step, longest * double{setup.stiffness_ratio});
  return control;
}

RelaxReport SteppingSolver::relax(int max_steps, bool stop_early) {
  std::uint64_t free = problem_.particles;
  for (std::size_t i = 0; i < std::min(fixed_.size(), problem_.particles); ++i) free -= fixed_[i];
  RelaxControl control = relax_control(setup_, problem_.terms.classed, free, max_steps, stop_early);
  run(control);
  return control.report;
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
