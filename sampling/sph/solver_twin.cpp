// The twin of the engines: all pairs and all images, in double, without cells, lanes or threads. With Setup::
// thesis_cells it looks only where the thesis' program looked: into 3x3 square cells of H s_min around the particle, so
// that a size field makes it miss neighbours (thesis fig. 2.3).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "sampling/sph/bodies.h"
#include "sampling/sph/stepping_solver.h"

namespace abn::sph {
namespace {

class TwinSolver final : public SteppingSolver {
 public:
  explicit TwinSolver(const Setup& setup) : SteppingSolver(setup), thesis_cells_(setup.thesis_cells) {
    load(problem());
  }

  Evaluation evaluate() override {
    find_forces();
    Evaluation result;
    result.density.assign(density_.begin(), density_.begin() + static_cast<std::ptrdiff_t>(problem().particles));
    for (std::size_t i = 0; i < problem().particles; ++i) {
      result.force_x.push_back(force_[i].x);
      result.force_y.push_back(force_[i].y);
    }
    return result;
  }

  const char* backend() const override { return thesis_cells_ ? "twin, thesis cells" : "twin"; }

 protected:
  void load(const Problem& problem) override {
    const std::size_t n = problem.count();
    x_ = problem.x;
    y_ = problem.y;
    for (std::size_t i = 0; i < n; ++i) {
      x_[i] = wrap(x_[i], problem.field.length_x);
      y_[i] = wrap(y_[i], problem.field.length_y);
    }
    vx_.assign(n, 0);
    vy_.assign(n, 0);
    density_.assign(n, 1);
    force_.assign(n, {});
    here_.assign(n, {});
  }

  void run(RelaxControl& control) override {
    while (!control.done) control.finish_step(step(control.report.step));
  }

  void store(std::vector<double>& x, std::vector<double>& y) override {
    x = x_;
    y = y_;
  }

 private:
  StepSums step(double length) {
    StepSums sums;
    sums.mean_density = find_forces();
    Motion<double> motion;
    motion.step = length;
    motion.damping = double{setup().damping};
    motion.cap = double{setup().velocity_cap};
    motion.walls = problem().walls;
    motion.length_x = motion.walls ? problem().plane_x : problem().field.length_x;
    motion.length_y = motion.walls ? problem().plane_y : problem().field.length_y;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (!fixed().empty() && fixed()[i] != 0) {
        vx_[i] = vy_[i] = 0;
        continue;
      }
      const double moved = move_particle(motion, force_[i].x, force_[i].y, here_[i].size, x_[i], y_[i], vx_[i], vy_[i]);
      if (moved < 0) {
        ++sums.non_finite;
        continue;
      }
      sums.displacement += moved;
      sums.max_displacement = std::max(sums.max_displacement, moved);
      sums.moving += moved >= double{setup().tolerance} ? 1 : 0;
    }
    return sums;
  }

  bool same_class(std::size_t i, std::size_t j) const {
    return !problem().terms.classed || problem().labels[i] == problem().labels[j];
  }

  /// Calls f(j, dx, dy) for every image of every particle that may be within the support [d] of particle i.
  template <class F>
  void for_each_image(std::size_t i, double support, const F& f) const {
    const double length_x = problem().field.length_x;
    const double length_y = problem().field.length_y;
    const double cell = support * problem().field.smallest;  // of the thesis' grid
    const auto far_cells = [cell](double a, double b) {
      return std::abs(std::floor(a / cell) - std::floor(b / cell)) > 1;
    };
    for (std::size_t j = 0; j < x_.size(); ++j) {
      const double reach = support / warp(here_[i].size, here_[j].size);
      // Tiles that could hold an image within reach, by one axis each.
      const auto first_x = static_cast<int>(std::floor((x_[i] - x_[j] - reach) / length_x));
      const auto last_x = static_cast<int>(std::ceil((x_[i] - x_[j] + reach) / length_x));
      const auto first_y = static_cast<int>(std::floor((y_[i] - y_[j] - reach) / length_y));
      const auto last_y = static_cast<int>(std::ceil((y_[i] - y_[j] + reach) / length_y));
      for (int tile_y = first_y; tile_y <= last_y; ++tile_y) {
        for (int tile_x = first_x; tile_x <= last_x; ++tile_x) {
          const double at_x = x_[j] + tile_x * length_x;
          const double at_y = y_[j] + tile_y * length_y;
          if (thesis_cells_ && (far_cells(x_[i], at_x) || far_cells(y_[i], at_y))) continue;
          const double dx = x_[i] - at_x;
          const double dy = y_[i] - at_y;
          if (dx * dx + dy * dy < reach * reach) f(j, dx, dy);
        }
      }
    }
  }

  /// Densities and forces; returns the mean density of all but the ghosts.
  double find_forces() {
    const std::size_t n = x_.size();
    const SizeField& field = problem().field;
    for (std::size_t i = 0; i < n && !field.uniform; ++i) here_[i] = sample_field(field.view<double>(), x_[i], y_[i]);
    return with_terms(problem().terms, [&]<Terms terms>() {
      const double support = problem().support;
      const double class_support = problem().class_support;
      const DensityConstants<double> constant = density_constants<double>(terms, support, class_support);
      std::vector<double> own(n, 0);
      double mean = 0;
      double class_mean = 0;
      for (std::size_t i = 0; i < n; ++i) {
        DensitySum<double> sum;
        for_each_image(i, class_support, [&](std::size_t j, double dx, double dy) {
          add_density<terms>(sum, dx, dy, 1 / support, 1 / class_support, here_[i].size, here_[j].size, 0.0,
                             same_class(i, j) ? 0.0 : 1.0);
        });
        density_[i] = sum.all * constant.all;
        own[i] = sum.own * constant.own;
        if (i >= problem().particles) continue;
        mean += density_[i] / static_cast<double>(problem().particles);
        class_mean += own[i] / static_cast<double>(problem().particles);
      }
      const double inverse_delta = 1 / double{setup().stiffness_ratio};
      std::vector<double> pressures(n, 1);
      std::vector<double> class_pressures(n, 1);
      for (std::size_t i = 0; i < n; ++i) {
        pressures[i] = pressure(density_[i], mean, inverse_delta);
        if (terms.classed) class_pressures[i] = pressure(own[i], class_mean, inverse_delta);
      }
      for (std::size_t i = 0; i < n; ++i) {
        Force<double> force;
        for_each_image(i, class_support, [&](std::size_t j, double dx, double dy) {
          const double r2 = dx * dx + dy * dy;
          if (r2 == 0 && i != j) {
            coincident_offset(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), dx, dy);
          }
          const double weight = force_weight<terms>(r2, 1 / support, 1 / class_support, here_[i].size, here_[j].size,
                                                    0.0, same_class(i, j) ? 0.0 : 1.0, pressures[i], pressures[j],
                                                    class_pressures[i], class_pressures[j]);
          force.x += weight * dx;
          force.y += weight * dy;
        });
        force_[i] = {force.x - here_[i].pull_x, force.y - here_[i].pull_y};
      }
      return mean;
    });
  }

  bool thesis_cells_;
  std::vector<double> x_, y_, vx_, vy_, density_;  // by id
  std::vector<Force<double>> force_;
  std::vector<FieldSample<double>> here_;
};

}  // namespace

std::unique_ptr<Solver> make_twin_solver(const Setup& setup) { return std::make_unique<TwinSolver>(setup); }

}  // namespace abn::sph
