// The engines' twin for tests: all pairs and all images, in double, without cells, lanes or threads.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include "sampling/sph/model.h"
#include "sampling/sph/size_field.h"
#include "sampling/sph/solver.h"

namespace abn::sph {

/// An image of a particle: (id, tile column, tile row); tile (0,0) is the particle itself.
using ParticleImage = std::tuple<std::uint32_t, int, int>;

/// The state of a plane at given positions; cost O(N^2) per query over all particles.
class BruteForce {
 public:
  /// `size` as for Solver::set_size_field, null for a uniform plane. Uses Setup's plane, positions, support_radius and
  /// stiffness_ratio.
  explicit BruteForce(const Setup& setup, const Grid<float>* size = nullptr)
      : n_(setup.positions.size()),
        support_(setup.support_radius),
        inverse_delta_(1.0 / setup.stiffness_ratio),
        spacing_(std::sqrt(static_cast<double>(setup.plane.area()) / static_cast<double>(n_))),
        length_x_(setup.plane.width / spacing_),
        length_y_(setup.plane.height / spacing_),
        size_(n_, 1.0) {
    for (const Vec2f p : setup.positions) {
      x_.push_back(p.x / spacing_);
      y_.push_back(p.y / spacing_);
    }
    if (size == nullptr) return;
    const Grid<float> field = normalised_size_field(*size, std::sqrt(static_cast<double>(n_)));
    const Extent cells = field.size();
    for (std::size_t i = 0; i < n_; ++i) {
      size_[i] = bilinear_periodic(field.cells().data(), cells.width, cells.height, x_[i] * (cells.width / length_x_),
                                   y_[i] * (cells.height / length_y_));
    }
  }

  /// Every image with warped distance below the support, itself included, in order.
  std::vector<ParticleImage> neighbours(std::size_t i) const {
    std::vector<ParticleImage> found;
    for_each_neighbour(i, [&](std::size_t j, int tile_x, int tile_y, double, double) {
      found.emplace_back(static_cast<std::uint32_t>(j), tile_x, tile_y);
    });
    std::sort(found.begin(), found.end());
    return found;
  }

  /// Density and force; if asked for, also the largest over particles of the sum of |force terms|: the scale of
  /// rounding errors, because the terms cancel.
  Evaluation evaluate(double* largest_term_sum = nullptr) const {
    Evaluation result;
    result.density.assign(n_, 0);
    result.force_x.assign(n_, 0);
    result.force_y.assign(n_, 0);
    double mean = 0;
    for (std::size_t i = 0; i < n_; ++i) {
      for_each_neighbour(i, [&](std::size_t j, int, int, double dx, double dy) {
        result.density[i] += kernel_constant(support_) * density_term(dx * dx + dy * dy, inverse_reach(i, j));
      });
      mean += result.density[i] / static_cast<double>(n_);
    }
    std::vector<double> pressures(n_);
    for (std::size_t i = 0; i < n_; ++i) pressures[i] = pressure(result.density[i], mean, inverse_delta_);
    for (std::size_t i = 0; i < n_; ++i) {
      double term_sum = 0;
      for_each_neighbour(i, [&](std::size_t j, int, int, double dx, double dy) {
        const double r2 = dx * dx + dy * dy;
        if (r2 == 0 && i != j) {
          coincident_offset(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), dx, dy);
        }
        const double weight =
            force_term(r2, inverse_reach(i, j), pressures[i], pressures[j]) * warp(size_[i], size_[j]);
        result.force_x[i] += weight * dx;
        result.force_y[i] += weight * dy;
        term_sum += std::abs(weight) * std::hypot(dx, dy);
      });
      if (largest_term_sum != nullptr) *largest_term_sum = std::max(*largest_term_sum, term_sum);
    }
    return result;
  }

 private:
  double inverse_reach(std::size_t i, std::size_t j) const { return warp(size_[i], size_[j]) / support_; }

  /// Calls f(j, tile_x, tile_y, dx, dy) for every interacting image.
  template <class F>
  void for_each_neighbour(std::size_t i, F&& f) const {
    for (std::size_t j = 0; j < n_; ++j) {
      const double reach = 1 / inverse_reach(i, j);
      // Tiles that could hold an image within reach, by one axis each.
      const int first_x = static_cast<int>(std::floor((x_[i] - x_[j] - reach) / length_x_));
      const int last_x = static_cast<int>(std::ceil((x_[i] - x_[j] + reach) / length_x_));
      const int first_y = static_cast<int>(std::floor((y_[i] - y_[j] - reach) / length_y_));
      const int last_y = static_cast<int>(std::ceil((y_[i] - y_[j] + reach) / length_y_));
      for (int tile_y = first_y; tile_y <= last_y; ++tile_y) {
        for (int tile_x = first_x; tile_x <= last_x; ++tile_x) {
          const double dx = x_[i] - tile_x * length_x_ - x_[j];
          const double dy = y_[i] - tile_y * length_y_ - y_[j];
          if (kernel_distance(dx * dx + dy * dy, inverse_reach(i, j)) < 1) f(j, tile_x, tile_y, dx, dy);
        }
      }
    }
  }

  std::size_t n_;
  double support_, inverse_delta_;
  double spacing_;  // d [px]
  double length_x_, length_y_;
  std::vector<double> x_, y_, size_;
};

}  // namespace abn::sph
