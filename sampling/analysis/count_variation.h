// How unevenly samples fall into the pixels.
#pragma once

#include <cstdint>

#include "sampling/analysis/points.h"
#include "sampling/sampler.h"

namespace abn::analysis {

/// Samples per pixel, over all pixels.
struct CountVariation {
  double mean = 0;
  double coefficient = 0;  // of variation: standard deviation over all pixels / mean; 1 / sqrt(mean) for white noise
  std::uint64_t least = 0;
  std::uint64_t most = 0;
  std::uint64_t empty = 0;  // pixels without a sample
};

/// Counts `samples` on `plane`, each in its `pixel` if it has one, otherwise in floor(position). Throws ConfigError for
/// an empty set, a plane without pixels, or a sample whose pixel is not on the plane.
CountVariation count_variation(const SampleBatch& samples, Extent plane);

/// The same for points of the unit torus stretched over `plane`.
CountVariation count_variation(Points points, Extent plane);

}  // namespace abn::analysis
