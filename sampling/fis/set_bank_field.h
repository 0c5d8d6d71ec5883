// The background that attracts the points of a bank, and the controller that shapes it. Internal to set_bank.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sampling/fis/filter_density.h"
#include "sampling/fis/set_bank.h"

namespace abn::detail {

/// Lengths of the relaxation [px]; all scale with the filter.
struct BankLengths {
  explicit BankLengths(const FilterDensity& filter);
  float unit;           // rms radius of the filter, in those of the Gaussian of sigma .5 cut off at 1.5
  float softening;      // of the direction r / |r|
  float axis_rounding;  // of the sign of dx
  float support;        // of the SPH force
  float short_support;  // of the short-range term
};

/// Greatest value of q (1 - q)^3, at q = 1/4.
constexpr double kGreatestSphForce = 27.0 / 256;

/// The pair potential at a displacement of (dx,dy) >= 0 [px].
double pair_potential(double dx, double dy, const BankLengths& lengths, const SetBankSpec& spec);

/// Soft histogram of a point: its radial share among 16 bins, its two marginal shares among 12 that x and y have in
/// common, each divided between two neighbouring bins, so that the controller acts smoothly.
struct BankFeatures {
  static constexpr std::size_t radial_bins = 16;
  static constexpr std::size_t marginal_bins = 12;
  static constexpr std::size_t bins = radial_bins + marginal_bins;
  std::array<std::uint8_t, 6> bin;
  std::array<float, 6> weight;
  BankFeatures(const FilterDensity& filter, float x, float y);
};
using BankHistogram = std::array<double, BankFeatures::bins>;

/// The potential of the background n = f (1 + c) on a grid over the filter's square, and its gradient.
class BankField {
 public:
  BankField(const FilterDensity& filter, const BankLengths& lengths, const SetBankSpec& spec);

  /// Integrates the difference between f and the bank's density: `histogram` is the mean of the features of its points.
  void control(const BankHistogram& histogram);

  /// Bilinear in the grid of central differences.
  Vec2f gradient(float x, float y) const;
  float potential(float x, float y) const;

 private:
  static constexpr std::uint32_t kSide = 40;
  static constexpr std::uint32_t kHalf = kSide / 2;
  static constexpr std::size_t kOctant = std::size_t{kHalf} * (kHalf + 1) / 2;

  static std::size_t octant(std::uint32_t i, std::uint32_t j);
  struct Place {
    std::size_t cell;  // upper left of four
    float x, y;        // inside, [0,1]
  };
  Place place(float x, float y) const;
  void update();

  float radius_;
  float cell_;                                      // side of a cell [px]
  std::vector<std::array<double, kOctant>> basis_;  // potential of f, and of f times every feature
  BankHistogram integral_{};
  BankHistogram error_{};
  std::vector<float> potential_;  // [kSide * kSide]
  std::vector<Vec2f> gradient_;   // likewise
};

}  // namespace abn::detail
