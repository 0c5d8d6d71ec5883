// A non-negative pixel filter as a probability density: its inverse, its marginal and radial distribution, its spread.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "sampling/pixel_filter.h"
#include "sampling/vec.h"

namespace abn {

/// A function on [first, last] by its values at equal steps, linear between them.
class LinearTable {
 public:
  LinearTable() = default;
  /// At least two values.
  LinearTable(double first, double last, std::vector<float> values);
  /// Beyond the ends, the value there.
  float operator()(float x) const {
    const float place = (x - first_) * steps_per_unit_;
    const float inside = place > 0 ? (place < steps_ ? place : steps_) : 0.0F;
    const auto k = static_cast<std::size_t>(inside);
    const std::size_t i = k < last_interval_ ? k : last_interval_;
    return values_[i] + (values_[i + 1] - values_[i]) * (inside - static_cast<float>(i));
  }

 private:
  float first_ = 0;
  float steps_per_unit_ = 0;
  float steps_ = 0;
  std::size_t last_interval_ = 0;
  std::vector<float> values_;
};

/// What filter importance sampling has to know of a filter f >= 0 with the symmetry of the square; tables made once, in
/// double, kept in float. Thread-safe.
class FilterDensity {
 public:
  /// `strategy` is for the message. A null filter is the box of the pixel. Throws ConfigError for a filter with
  /// negative lobes.
  FilterDensity(std::shared_ptr<const PixelFilter> filter, std::string_view strategy);

  const PixelFilter& filter() const { return *filter_; }
  bool disc() const { return filter_->disc(); }
  float radius() const { return radius_; }                 // [px]
  double second_moment() const { return second_moment_; }  // E r^2 of a point drawn from f [px^2]

  /// The point of f [px] that a point of the unit square [0,1)^2 stands for: uniform points become points drawn from f.
  /// On the square by the inverse of the distribution along each axis; on the disc by radius and angle, which for the
  /// Gaussian is the transform of Box and Muller (1958), truncated (Martino et al. 2012).
  Vec2f offset(Vec2f unit) const;

  /// Share of f within distance r [px] of the centre.
  float radial(float r) const { return radial_(r); }
  /// Share of f with x below this [px]; that of y is the same.
  float marginal(float x) const { return marginal_(x); }
  /// Share of f in the rectangle [x0,x1] x [y0,y1] [px].
  double share(double x0, double x1, double y0, double y1) const;

 private:
  void tabulate_square();
  void tabulate_disc();

  std::shared_ptr<const PixelFilter> filter_;
  float radius_ = 0;
  double second_moment_ = 0;
  LinearTable inverse_;   // of the marginal, or of the radial distribution: r^2 by share
  LinearTable marginal_;  // [-radius, radius]
  LinearTable radial_;    // [0, radius sqrt 2] or [0, radius]
};

}  // namespace abn
