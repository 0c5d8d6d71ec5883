// What makes two samples a pair of gabriel.h and how urgent a pair is, one function per rule, for host and device.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "sampling/hash.h"
#include "sampling/hd.h"
#include "sampling/rng.h"
#include "sampling/vec.h"

namespace abn {

/// Samples in a cell of the search for neighbours: fewer cost empty cells, more cost distances.
inline constexpr double pair_samples_per_cell = 2;
/// The same where `crowd` samples share a cell, on the average over the samples: those of an adapted plane crowd in few
/// cells, which are smaller then.
constexpr double pair_samples_per_cell_of(double crowd) {
  if (crowd <= 2.5 * pair_samples_per_cell) return pair_samples_per_cell;
  const double fewer = pair_samples_per_cell * 1.5 * pair_samples_per_cell / crowd;
  return fewer > 0.25 ? fewer : 0.25;
}

/// Whether sample s is inside the circle whose diameter leads from the origin to k: |s - k/2|^2 < inside |k/2|^2.
/// Squares of the lengths are given. A sample on the circle, but for rounding, is not inside.
ABN_HD constexpr bool in_circle(float s_x, float s_y, float s_squared, float k_x, float k_y, float k_squared) {
  constexpr float inside = 0.999F;
  return s_x * k_x + s_y * k_y > s_squared + (0.25F - 0.25F * inside) * k_squared;
}

/// The order in which the neighbours of a sample are found: by distance, then by index.
ABN_HD constexpr std::uint64_t neighbour_key(float squared, std::uint32_t index) {
  return std::uint64_t{std::bit_cast<std::uint32_t>(squared)} << 32 | index;
}

/// Whether the end `a` of a pair is the one that counts: the lower one, unless the higher one is not among its
/// neighbours. `last` is the key of the farthest neighbour of b.
ABN_HD constexpr bool counts_from(std::uint32_t a, std::uint32_t b, float squared, std::uint64_t last) {
  return a < b || neighbour_key(squared, a) > last;
}

ABN_HD inline float as_finite_float(double x) {
  constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
  return static_cast<float>(x < most ? x : most);
}

/// Root mean square over the channels of the difference of samples a and b; value [samples * channels].
ABN_HD inline float difference_of(const float* value, std::uint32_t channels, std::uint32_t a, std::uint32_t b) {
  const float* of_a = value + std::uint64_t{a} * channels;
  const float* of_b = value + std::uint64_t{b} * channels;
  if (channels == 1) return as_finite_float(std::abs(static_cast<double>(*of_a) - static_cast<double>(*of_b)));
  double sum = 0;
  for (std::uint32_t c = 0; c < channels; ++c) {
    const double d = static_cast<double>(of_a[c]) - static_cast<double>(of_b[c]);
    sum += d * d;
  }
  return as_finite_float(std::sqrt(sum / channels));
}

/// The priority of a pair of that contrast and squared length [px^2].
ABN_HD inline float pair_priority(double contrast, double floor, float squared, double length_exponent) {
  const auto exact = static_cast<double>(squared);
  const double area = length_exponent == 2 ? exact : std::pow(exact, 0.5 * length_exponent);
  return as_finite_float((contrast + floor) * area);
}

/// Priorities by the leading bits of a float >= 0: 8 steps per octave.
inline constexpr std::uint32_t priority_classes = 4096;
ABN_HD constexpr std::uint32_t priority_class(float priority) { return std::bit_cast<std::uint32_t>(priority) >> 20; }

/// What orders pairs of the same priority: no two pairs have the same lot.
ABN_HD constexpr std::uint64_t lot_of(std::uint32_t a, std::uint32_t b, std::uint64_t seed) {
  const std::uint64_t ends = a < b ? std::uint64_t{a} << 32 | b : std::uint64_t{b} << 32 | a;
  return mix64(seed ^ mix64(ends));
}

/// Midpoint number k, between a and b, displaced by half the jitter at most, inside the plane [px].
ABN_HD constexpr Vec2f jittered_midpoint(Vec2f a, Vec2f b, std::uint64_t k, float jitter, Extent plane,
                                         std::uint64_t seed) {
  constexpr std::uint32_t stream = stream_id("gabriel jitter");
  const Vec2f unit = Rng(seed, stream, k).uniform2();
  const Vec2f middle = (a + b) * 0.5F;
  const float x = middle.x + (unit.x - 0.5F) * jitter;
  const float y = middle.y + (unit.y - 0.5F) * jitter;
  const float right = just_below(static_cast<float>(plane.width));
  const float bottom = just_below(static_cast<float>(plane.height));
  return {x < 0 ? 0.0F : right < x ? right : x, y < 0 ? 0.0F : bottom < y ? bottom : y};
}

/// What stands for midpoint number k where there is no pair for it [px].
ABN_HD constexpr Vec2f random_midpoint(std::uint64_t k, Extent plane, std::uint64_t seed) {
  constexpr std::uint32_t stream = stream_id("gabriel rest");
  return to_plane(Rng(seed, stream, k).uniform2(), plane);
}

}  // namespace abn
