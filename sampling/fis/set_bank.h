// A bank of small point sets drawn from a filter and relaxed together: what fis_sph gives the pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sampling/fis/filter_density.h"
#include "sampling/vec.h"

namespace abn {

/// `sets` point sets of `set_size` offsets from the pixel's centre each.
struct SetBank {
  std::uint32_t set_size = 0;
  std::uint32_t sets = 0;
  std::vector<Vec2f> offset;  // [sets * set_size] [px], set by set
  std::vector<float> weight;  // [sets * set_size], mean 1 in every set; empty = all 1
};

/// How the points of a set repel each other.
enum class Repulsion {
  energy,  // kernel |r| of the energy distance (Szekely and Rizzo 2013): long-range, parameter-free
  sph,     // the SPH force, gradient of the Wendland kernel with a fixed support
};

struct SetBankSpec {
  std::uint32_t set_size = 1;  // K, 1 ... 256
  std::uint32_t sets = 512;    // rounded up to a multiple of 8
  int iterations = 400;
  Repulsion repulsion = Repulsion::energy;
  double axis_weight = 0.03;  // a: 0 ... .05; above, the controller loses its hold (E r^2 14 % too large at .06)
  double short_range = 0.15;  // b: >= 0
  double union_weight = -1;   // repulsion between eight sets, relative to that inside one; < 0: 1 up to K = 5, else 0
  bool kriging = false;       // weights by kriging in the loop instead of equal ones
  std::uint64_t seed = 1;
};

/// Relaxes random sets drawn from f until every set is even under f and all sets together are distributed as f.
///
/// The points of a set repel each other and are attracted by a background of the wanted density. That alone makes the
/// sets too narrow (E r^2 more than 8 % below the filter's), so a controller compares after every second iteration the
/// density of the whole bank with f, in 16 radial and 12 marginal bins of equal mass, and adds the integral of the
/// error (gain .15, clamped at 30) and the error itself (.5) to the background: n = f (1 + c). Kriging weights (nugget
/// .3, negative ones set to 0) are recomputed every fourth iteration. The repulsion is |r| + a (|dx| + |dy|) and, at
/// short range, b times the kernel (1 - q^2)^4 of SPH: without it the energy distance neglects fine detail (zone plate,
/// 10 samples: RMSE 1.00 of inversion's instead of .97). Up to 5 points in a set, eight sets repel each other too, or
/// all sets would gather on the same ring. All lengths scale with the filter's rms radius.
///
/// The background acts through a potential on a grid of 40 x 40 cells. It has the eight symmetries of the filter and is
/// linear in c, so an update sums 29 potentials over 210 cells instead of multiplying by a 1600 x 1600 matrix. Sets of
/// one point are not relaxed, only spread. The result is the same for any number of threads.
SetBank relax_set_bank(const FilterDensity& filter, const SetBankSpec& spec);

/// What the bank says of itself under the filter.
struct SetBankQuality {
  double second_moment_error = 0;  // E r^2 over that of the filter, minus 1
  double radial_ks = 0;            // greatest difference of the radial distributions
  double marginal_ks = 0;          // likewise along the axes, over the eight symmetries of the sets
};
SetBankQuality measure(const SetBank& bank, const FilterDensity& filter);

/// A bank as bytes for the disk cache and back; nothing if the bytes are not a bank of these sizes.
std::vector<std::byte> to_bytes(const SetBank& bank);
std::optional<SetBank> from_bytes(std::span<const std::byte> bytes, const SetBankSpec& spec);

}  // namespace abn
