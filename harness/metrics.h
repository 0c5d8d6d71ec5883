// The table of metrics: how far one image is from another, as one number and, where it makes sense, as a map.
//
// Common to all rows: x is the test image, y the reference, both in linear light, means are over pixels and channels
// in double precision, and the number does not depend on the number of threads. A value that is not finite in an image
// gives a score that is not finite (null in JSON), never a crash.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/image.h"
#include "sampling/grid.h"

namespace abn::harness {

/// What a metric compares; both images must outlive the call.
struct MetricInput {
  const Image& test;
  const Image& reference;
  bool high_dynamic_range = false;  // true: values above 1 mean something (floating-point source)
};

/// A row of the table. `score` and `map` throw ConfigError when the images differ in size or channels.
struct Metric {
  std::string name;
  std::string unit;  // empty: none
  std::string summary;
  std::string cite;
  bool smaller_is_better = true;  // for bias: smaller magnitude
  std::function<double(const MetricInput&)> score;
  std::function<Grid<float>(const MetricInput&)> map;  // per pixel, over channels; empty where there is none
};

/// All metrics, the primary one first.
const std::vector<Metric>& metrics();

/// The row of that name. Throws ConfigError that lists the known names.
const Metric& find_metric(std::string_view name);

/// The value that differs most.
struct WorstPixel {
  std::uint32_t x = 0;  // [px]
  std::uint32_t y = 0;  // [px]
  std::uint32_t channel = 0;
  double difference = 0;  // signed, test - reference
};

/// Finds the largest |x-y|: the first in row order of equals, the first NaN if there is one. Throws like a metric.
WorstPixel worst_pixel(const Image& test, const Image& reference);

/// Throws ConfigError naming both sizes unless the images have the same size and channels and at least one pixel.
void require_comparable(const Image& test, const Image& reference);

}  // namespace abn::harness
