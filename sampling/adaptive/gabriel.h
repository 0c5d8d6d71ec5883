// Refinement of a sampled plane at the edges of the integrand: new samples halfway between neighbours that differ.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sampling/vec.h"

namespace abn {

struct GabrielOptions {
  int neighbours = 9;        // a pair: one is among so many nearest of the other; 1 to 31
  double floor = 0.02;       // difference that every pair is taken to have, in standard deviations of the values
  double min_length = 0.02;  // of a pair [px]: the resolution at which refinement ends
  double jitter = 0.003;     // side of the square in which a midpoint is displaced [px], so that no lattice forms
  /// A pair counts at least this share of the smaller of its ends' largest differences: > 0 goes on refining around a
  /// feature after an edge has been straddled.
  double activity = 0;
  double length_exponent = 2;  // of the priority
};

/// New samples, the most urgent first.
struct GabrielMidpoints {
  std::vector<Vec2f> position;  // [wanted] [px], inside the plane
  std::size_t pairs = 0;        // how many of them, from the front, are midpoints of pairs; the others are random
};

/// The midpoints of the `wanted` most urgent pairs of neighbours; where there are fewer pairs, uniformly random points
/// for the rest.
///
/// `position` [px], [n], inside the plane; `value` [n * channels], finite. A pair is an edge of the Gabriel graph (no
/// other sample inside the circle whose diameter it is: Gabriel & Sokal 1969), so that the midpoint is its own widest
/// gap, with one end among the nearest `neighbours` of the other. Its urgency is (|difference| + floor * standard
/// deviation) * length^2, |difference| the root mean square over the channels, the standard deviation likewise: an
/// error that a sample may remove grows with the contrast and with the area it decides. If all values are equal, it is
/// length^2 alone. Equally urgent pairs come in random order. Each pair counts once. The result does not depend on the
/// number of threads.
GabrielMidpoints gabriel_midpoints(std::span<const Vec2f> position, std::span<const float> value,
                                   std::uint32_t channels, Extent plane, std::size_t wanted, std::uint64_t seed,
                                   const GabrielOptions& options = {});

}  // namespace abn
