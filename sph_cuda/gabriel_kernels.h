// The kernels of gabriel_midpoints() as bodies (kernels.h): edges of the graph, their priorities, the choice of pairs.
//
// An edge is known by its slot: the e-th edge of sample i is slot e * n + i.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "sampling/adaptive/gabriel_pair.h"
#include "sampling/hd.h"
#include "sampling/vec.h"
#include "sph_cuda/kernels.h"
#include "sph_cuda/sample_cells.h"

namespace abn::sph_cuda {

/// The values in the order of the samples.
struct OrderValues {
  const float* from;
  const std::uint32_t* index;  // [n], of the samples in their order
  std::uint32_t channels;
  float* to;  // [n * channels]
  ABN_HD void operator()(std::uint32_t at) const {
    const std::uint32_t k = at / channels;
    to[at] = from[std::uint64_t{index[k]} * channels + (at - k * channels)];
  }
};

/// The values of a channel.
struct ValueOfChannel {
  const float* value;
  std::uint32_t channels;
  ABN_HD double operator()(std::uint32_t channel, std::uint32_t i) const {
    return static_cast<double>(value[std::uint64_t{i} * channels + channel]);
  }
};

/// Their squared distances from the mean of the channel.
struct SquaredDeviation {
  ValueOfChannel value;
  const double* sum;  // [channels]
  double n;
  ABN_HD double operator()(std::uint32_t channel, std::uint32_t i) const {
    const double deviation = value(channel, i) - sum[channel] / n;
    return deviation * deviation;
  }
};

/// One thread: the difference that every pair is taken to have.
struct FindFloor {
  const double* squares;  // [channels], sums over the samples
  std::uint32_t channels;
  double values;   // of all samples and channels
  double options;  // GabrielOptions::floor
  double* floor;
  ABN_HD void operator()(std::uint32_t) const {
    double sum = 0;
    for (std::uint32_t channel = 0; channel < channels; ++channel) sum += squares[channel];
    const double deviation = std::sqrt(sum / values);
    *floor = deviation > 0 ? options * deviation : 1.0;
  }
};

/// The edges from every sample to neighbours far enough away.
struct FindEdges {
  SamplesInCells all;
  std::uint32_t n;
  int neighbours;  // 1 to 31, fewer than n
  float least_squared;
  const float* value;  // [n * channels], in the order of `all`
  std::uint32_t channels;
  std::uint64_t* last;   // [n], key of the farthest neighbour
  std::uint32_t* count;  // [n], of edges
  std::uint32_t* end;    // [slots], the sample at the other end
  float* activity;       // [n], the largest difference along an edge; null = not asked for

  ABN_HD void operator()(std::uint32_t i) const {
    const Vec2f here = all.position[i];
    NearestFound found;
    find_nearest(all, here, neighbours, i, found);
    float x[NearestFound::most];
    float y[NearestFound::most];
    for (int k = 0; k < found.count; ++k) {
      const Vec2f d = all.position[found.index(k)] - here;
      x[k] = d.x;
      y[k] = d.y;
    }
    std::uint32_t edges = 0;
    float largest = 0;
    for (int k = 0; k < found.count; ++k) {
      const float squared = found.squared(k);
      bool blocked = false;
      for (int s = 0; s < found.count && !blocked; ++s) {
        blocked = in_circle(x[s], y[s], found.squared(s), x[k], y[k], squared);
      }
      if (blocked) continue;
      if (squared >= least_squared && squared > 0) end[std::uint64_t{edges++} * n + i] = found.index(k);
      if (activity != nullptr) {
        const float difference = difference_of(value, channels, i, found.index(k));
        largest = difference > largest ? difference : largest;
      }
    }
    last[i] = found.key[found.count - 1];
    count[i] = edges;
    if (activity != nullptr) activity[i] = largest;
  }
};

/// The slot of an edge that the other end counts.
inline constexpr float counts_elsewhere = -1;

/// Whether a class of priorities is needed for `wanted` pairs; 0 is the highest class here.
struct NeededClasses {
  const std::uint32_t* above;  // [priority_classes], pairs in higher classes
  std::uint32_t wanted;
  ABN_HD static std::uint32_t class_of(float priority) { return priority_classes - 1 - priority_class(priority); }
  ABN_HD bool has(float priority) const { return priority != counts_elsewhere && above[class_of(priority)] < wanted; }
};

/// The priorities of edges, and how many are in every class.
struct RatePairs {
  const Vec2f* position;  // [n]
  std::uint32_t n;
  const float* value;  // [n * channels]
  std::uint32_t channels;
  const std::uint64_t* last;
  const std::uint32_t* count;
  const std::uint32_t* end;
  const float* activity;  // null = not asked for
  const double* floor;
  double activity_share;    // GabrielOptions::activity
  double length_exponent;   // GabrielOptions::length_exponent
  float* priority;          // [slots]
  std::uint32_t* in_class;  // [priority_classes + 1], 0 before
  ABN_HD void operator()(std::uint32_t a) const {
    const std::uint32_t edges = count[a];
    for (std::uint32_t e = 0; e < edges; ++e) {
      const std::uint64_t slot = std::uint64_t{e} * n + a;
      const std::uint32_t b = end[slot];
      const Vec2f d = position[a] - position[b];
      const float squared = d.x * d.x + d.y * d.y;
      if (!counts_from(a, b, squared, last[b])) {
        priority[slot] = counts_elsewhere;
        continue;
      }
      auto contrast = static_cast<double>(difference_of(value, channels, a, b));
      if (activity != nullptr) {
        const float both = activity[b] < activity[a] ? activity[b] : activity[a];
        const double least = activity_share * static_cast<double>(both);
        contrast = contrast < least ? least : contrast;
      }
      const float found = pair_priority(contrast, *floor, squared, length_exponent);
      priority[slot] = found;
      add_atomically(in_class + NeededClasses::class_of(found), 1);
    }
  }
};

/// How many pairs of every sample are in classes that are needed; 0 after the last.
struct CountCandidates {
  NeededClasses needed;
  std::uint32_t n;
  const std::uint32_t* edges;  // [n], counts
  const float* priority;
  std::uint32_t* count;  // [n + 1]
  ABN_HD void operator()(std::uint32_t i) const {
    std::uint32_t candidates = 0;
    for (std::uint32_t e = 0; i < n && e < edges[i]; ++e) {
      candidates += needed.has(priority[std::uint64_t{e} * n + i]) ? 1 : 0;
    }
    count[i] = candidates;
  }
};

/// Their slots and lots.
struct WriteCandidates {
  NeededClasses needed;
  std::uint32_t n;
  const std::uint32_t* edges;
  const std::uint32_t* end;
  const float* priority;
  const std::uint32_t* start;  // [n + 1], the first candidate of every sample
  std::uint64_t seed;
  std::uint64_t* lot;   // [candidates]
  std::uint32_t* slot;  // [candidates]
  ABN_HD void operator()(std::uint32_t i) const {
    std::uint32_t to = start[i];
    for (std::uint32_t e = 0; e < edges[i]; ++e) {
      const std::uint32_t here = e * n + i;
      if (!needed.has(priority[here])) continue;
      lot[to] = lot_of(i, end[here], seed);
      slot[to++] = here;
    }
  }
};

/// Keys by which the highest priority comes first.
struct KeyByPriority {
  const float* priority;
  const std::uint32_t* slot;  // [candidates]
  std::uint64_t* key;         // [candidates]
  ABN_HD void operator()(std::uint32_t k) const {
    key[k] = 0xFFFFFFFFU - std::bit_cast<std::uint32_t>(priority[slot[k]]);
  }
};

/// The midpoints of the first pairs, then random points.
struct PlaceMidpoints {
  const Vec2f* position;
  std::uint32_t n;
  const std::uint32_t* slot;  // [pairs], the most urgent first
  const std::uint32_t* end;
  std::uint32_t pairs;
  float jitter;
  Extent plane;
  std::uint64_t seed;
  Vec2f* midpoint;
  ABN_HD void operator()(std::uint32_t k) const {
    if (k < pairs) {
      midpoint[k] = jittered_midpoint(position[slot[k] % n], position[end[slot[k]]], k, jitter, plane, seed);
    } else {
      midpoint[k] = random_midpoint(k, plane, seed);
    }
  }
};

}  // namespace abn::sph_cuda
