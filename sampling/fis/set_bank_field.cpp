#include "sampling/fis/set_bank_field.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace abn::detail {
namespace {

constexpr double kIntegralGain = 0.15;
constexpr double kProportionalGain = 0.5;
constexpr double kMostIntegral = 30;

}  // namespace

BankLengths::BankLengths(const FilterDensity& filter)
    : unit(static_cast<float>(std::sqrt(filter.second_moment() / 0.4867))),
      softening(1e-3F * unit),
      axis_rounding(0.02F * unit),
      support(1.28F * unit),
      short_support(0.62F * unit) {}

// The potential of the SPH force is the integral of q (1 - q)^3, scaled to a greatest force of 1 as the energy
// kernel's.
double pair_potential(double dx, double dy, const BankLengths& lengths, const SetBankSpec& spec) {
  const double r = std::hypot(dx, dy);
  double potential = r;
  if (spec.repulsion == Repulsion::sph) {
    const double support = static_cast<double>(lengths.support);
    const double q = std::min(1.0, r / support);
    potential = support * q * q * (0.5 - q + 0.75 * q * q - 0.2 * q * q * q) / kGreatestSphForce;
  }
  const double s = r / static_cast<double>(lengths.short_support);
  const double rest = std::max(0.0, 1 - s * s);
  potential -= spec.short_range * static_cast<double>(lengths.unit) * rest * rest * rest * rest;
  return potential + spec.axis_weight * (dx + dy);
}

BankFeatures::BankFeatures(const FilterDensity& filter, float x, float y) : bin{}, weight{} {
  std::size_t k = 0;
  const auto divide = [&](float share, std::size_t first, std::size_t count, float total) {
    const float place = std::clamp(share * static_cast<float>(count) - 0.5F, 0.0F, static_cast<float>(count) - 1.001F);
    const auto below = static_cast<std::uint8_t>(place);
    const float above = place - static_cast<float>(below);
    bin[k] = static_cast<std::uint8_t>(first + below);
    weight[k++] = total * (1 - above);
    bin[k] = static_cast<std::uint8_t>(first + below + 1U);
    weight[k++] = total * above;
  };
  divide(filter.radial(std::sqrt(x * x + y * y)), 0, radial_bins, 1.0F);
  divide(std::abs(2 * filter.marginal(x) - 1), radial_bins, marginal_bins, 0.5F);
  divide(std::abs(2 * filter.marginal(y) - 1), radial_bins, marginal_bins, 0.5F);
}

// Cells (i,j) count from the centre outwards; the pair without its order is one of the octant.
std::size_t BankField::octant(std::uint32_t i, std::uint32_t j) {
  const std::size_t a = std::max(i, j);
  return a * (a + 1) / 2 + std::min(i, j);
}

BankField::BankField(const FilterDensity& filter, const BankLengths& lengths, const SetBankSpec& spec)
    : radius_(filter.radius()),
      cell_(2 * filter.radius() / kSide),
      basis_(1 + BankFeatures::bins),
      potential_(kSide * kSide),
      gradient_(kSide * kSide) {
  const double h = static_cast<double>(cell_);
  // Pair potentials between cells; along an axis, and for the own cell, the mean over the cell instead of 0.
  std::vector<double> pair(kSide * kSide);
  for (std::uint32_t j = 0; j < kSide; ++j) {
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const double dx = std::max(h * i, h / 3);
      const double dy = std::max(h * j, h / 3);
      const double axes = spec.axis_weight * (dx + dy);
      SetBankSpec round = spec;
      round.axis_weight = 0;
      const double radial = i == 0 && j == 0 ? pair_potential(0.3826 * h, 0, lengths, round)
                                             : pair_potential(h * i, h * j, lengths, round);
      pair[j * kSide + i] = radial + axes;
    }
  }
  // Potential of one cell of every octant class and its mirror images, at another.
  double total = 0;
  for (std::uint32_t j = 0; j < kHalf; ++j) {
    for (std::uint32_t i = 0; i < kHalf; ++i) {
      total += 4 * filter.share(h * i, h * (i + 1), h * j, h * (j + 1));
    }
  }
  for (std::uint32_t j = 0; j < kHalf; ++j) {
    for (std::uint32_t i = 0; i < kHalf; ++i) {
      const double mass = filter.share(h * i, h * (i + 1), h * j, h * (j + 1)) / total;
      const BankFeatures features(filter, cell_ * (static_cast<float>(i) + 0.5F),
                                  cell_ * (static_cast<float>(j) + 0.5F));
      for (std::uint32_t b = 0; b < kHalf; ++b) {
        for (std::uint32_t a = b; a < kHalf; ++a) {
          const std::uint32_t near_x = a > i ? a - i : i - a;
          const std::uint32_t near_y = b > j ? b - j : j - b;
          const std::uint32_t far_x = a + i + 1;
          const std::uint32_t far_y = b + j + 1;
          const double term = mass * (pair[near_y * kSide + near_x] + pair[near_y * kSide + far_x] +
                                      pair[far_y * kSide + near_x] + pair[far_y * kSide + far_x]);
          const std::size_t at = octant(a, b);
          basis_[0][at] += term;
          for (std::size_t k = 0; k < features.bin.size(); ++k) {
            basis_[1U + features.bin[k]][at] += term * static_cast<double>(features.weight[k]);
          }
        }
      }
    }
  }
  update();
}

// All bins have equal mass: 1 / 16 of the radial ones, 1 / 12 of the marginal ones.
void BankField::control(const BankHistogram& histogram) {
  for (std::size_t b = 0; b < histogram.size(); ++b) {
    const double bins = b < BankFeatures::radial_bins ? BankFeatures::radial_bins : BankFeatures::marginal_bins;
    error_[b] = 1 - histogram[b] * bins;
    integral_[b] = std::clamp(integral_[b] + kIntegralGain * error_[b], -kMostIntegral, kMostIntegral);
  }
  update();
}

void BankField::update() {
  std::array<double, kOctant> sum = basis_[0];
  for (std::size_t b = 0; b < integral_.size(); ++b) {
    const double c = integral_[b] + kProportionalGain * error_[b];
    for (std::size_t k = 0; k < kOctant; ++k) sum[k] += c * basis_[b + 1][k];
  }
  const auto from_centre = [](std::uint32_t i) { return i < kHalf ? kHalf - 1 - i : i - kHalf; };
  for (std::uint32_t j = 0; j < kSide; ++j) {
    for (std::uint32_t i = 0; i < kSide; ++i) {
      potential_[j * kSide + i] = static_cast<float>(sum[octant(from_centre(i), from_centre(j))]);
    }
  }
  for (std::uint32_t j = 0; j < kSide; ++j) {
    const std::uint32_t up = j > 0 ? j - 1 : 0;
    const std::uint32_t down = std::min(j + 1, kSide - 1);
    for (std::uint32_t i = 0; i < kSide; ++i) {
      const std::uint32_t left = i > 0 ? i - 1 : 0;
      const std::uint32_t right = std::min(i + 1, kSide - 1);
      const float dx = static_cast<float>(right - left) * cell_;
      const float dy = static_cast<float>(down - up) * cell_;
      gradient_[j * kSide + i] = {(potential_[j * kSide + right] - potential_[j * kSide + left]) / dx,
                                  (potential_[down * kSide + i] - potential_[up * kSide + i]) / dy};
    }
  }
}

BankField::Place BankField::place(float x, float y) const {
  constexpr float last = static_cast<float>(kSide) - 1.001F;
  const float u = std::clamp((x + radius_) / cell_ - 0.5F, 0.0F, last);
  const float v = std::clamp((y + radius_) / cell_ - 0.5F, 0.0F, last);
  const auto i = static_cast<std::size_t>(u);
  const auto j = static_cast<std::size_t>(v);
  return {j * kSide + i, u - static_cast<float>(i), v - static_cast<float>(j)};
}

Vec2f BankField::gradient(float x, float y) const {
  const Place p = place(x, y);
  const Vec2f* g = &gradient_[p.cell];
  const Vec2f top = g[0] * (1 - p.x) + g[1] * p.x;
  const Vec2f bottom = g[kSide] * (1 - p.x) + g[kSide + 1] * p.x;
  return top * (1 - p.y) + bottom * p.y;
}

float BankField::potential(float x, float y) const {
  const Place p = place(x, y);
  const float* v = &potential_[p.cell];
  const float top = v[0] * (1 - p.x) + v[1] * p.x;
  const float bottom = v[kSide] * (1 - p.x) + v[kSide + 1] * p.x;
  return top * (1 - p.y) + bottom * p.y;
}

}  // namespace abn::detail
