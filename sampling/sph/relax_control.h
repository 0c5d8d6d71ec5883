// When a relaxation ends and how long its steps are: the same for every engine, on the host and on a device.
#pragma once

#include <cstdint>

#include "sampling/hd.h"
#include "sampling/sph/solver.h"

namespace abn::sph {

/// Sums over the free particles in one step.
struct StepSums {
  double mean_density = 0;  // of all but the ghosts
  double displacement = 0;
  double max_displacement = 0;
  std::uint64_t moving = 0;  // particles displaced by at least the tolerance
  std::uint64_t non_finite = 0;
};

/// The state of a relaxation between its steps.
struct RelaxControl {
  std::uint64_t free = 0;  // particles that may move
  std::int32_t max_steps = 0;
  double tolerance = 0.01;
  bool by_mean = true;  // Criterion::mean
  bool stop_early = true;
  bool adaptive_step = true;
  bool done = false;
  RelaxReport report;  // report.step is the length of the next step

  /// Takes in what a step did; sets `done` after the last one.
  ABN_HD void finish_step(const StepSums& sums) {
    ++report.steps;
    report.mean_density = sums.mean_density;
    report.mean_displacement = free > 0 ? sums.displacement / static_cast<double>(free) : 0;
    report.max_displacement = sums.max_displacement;
    report.still = free > 0 ? 1 - static_cast<double>(sums.moving) / static_cast<double>(free) : 1;
    report.non_finite += sums.non_finite;
    const bool mean_converged = report.mean_displacement < tolerance;
    const bool every_converged = sums.moving == 0;
    if (mean_converged && report.mean_converged_at < 0) report.mean_converged_at = report.steps;
    if (every_converged && report.every_converged_at < 0) report.every_converged_at = report.steps;
    report.converged = by_mean ? mean_converged : every_converged;
    done = report.steps >= max_steps || (stop_early && report.converged);
    if (!done && adaptive_step && too_long()) {
      report.step *= 0.6;
      ++report.step_reductions;
    }
  }

 private:
  /// Whether the step should be reduced: a relaxation that works loses a good part of its motion in every few steps;
  /// one that rings or explodes does not.
  ABN_HD bool too_long() {
    constexpr int length = 6;
    window_ += report.mean_displacement;
    if (++count_ < length) return false;
    const double mean = window_ / length;
    // Slow drift below a few hundredths of a spacing is no instability: a size field or a frozen set settles slowly.
    const bool restless = previous_ > 0 && mean > 0.05 && mean > 0.9 * previous_;
    previous_ = restless ? 0 : mean;
    window_ = 0;
    count_ = 0;
    return restless;
  }

  double window_ = 0, previous_ = 0;
  std::int32_t count_ = 0;
};

}  // namespace abn::sph
