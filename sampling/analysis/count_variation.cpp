#include "sampling/analysis/count_variation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <vector>

#include "sampling/error.h"

namespace abn::analysis {
namespace {

void require(std::size_t samples, Extent plane) {
  if (samples == 0) throw ConfigError("count variation: the point set is empty; give at least one point");
  if (plane.area() == 0) {
    throw ConfigError("count variation: the plane is " + std::to_string(plane.width) + " x " +
                      std::to_string(plane.height) + " pixels; give at least one");
  }
}

CountVariation summarise(const std::vector<std::uint32_t>& counts) {
  CountVariation result;
  double sum = 0;
  double squares = 0;  // both are sums of integers, exact below 2^53
  for (const std::uint32_t count : counts) {
    sum += count;
    squares += static_cast<double>(count) * count;
    result.empty += count == 0 ? 1 : 0;
  }
  const auto pixels = static_cast<double>(counts.size());
  result.mean = sum / pixels;
  result.coefficient = std::sqrt(std::max(0.0, squares * pixels - sum * sum)) / sum;
  result.least = *std::min_element(counts.begin(), counts.end());
  result.most = *std::max_element(counts.begin(), counts.end());
  return result;
}

}  // namespace

CountVariation count_variation(const SampleBatch& samples, Extent plane) {
  require(samples.position.size(), plane);
  assert(samples.pixel.empty() || samples.pixel.size() == samples.position.size());
  std::vector<std::uint32_t> counts(plane.area(), 0);
  for (std::size_t i = 0; i < samples.position.size(); ++i) {
    const Vec2f p = samples.position[i];
    std::uint64_t pixel = plane.area();  // none
    if (!samples.pixel.empty()) {
      pixel = samples.pixel[i];
    } else if (p.x >= 0 && p.x < static_cast<float>(plane.width) && p.y >= 0 &&
               p.y < static_cast<float>(plane.height)) {
      pixel = static_cast<std::uint64_t>(p.y) * plane.width + static_cast<std::uint64_t>(p.x);
    }
    if (pixel >= plane.area()) {
      throw ConfigError("count variation: sample " + std::to_string(i) + " at (" + std::to_string(p.x) + ", " +
                        std::to_string(p.y) + ") has no pixel on the plane of " + std::to_string(plane.width) + " x " +
                        std::to_string(plane.height) + "; give the plane the samples were made for");
    }
    ++counts[pixel];
  }
  return summarise(counts);
}

CountVariation count_variation(Points points, Extent plane) {
  require(points.size(), plane);
  std::vector<std::uint32_t> counts(plane.area(), 0);
  for (const Point& p : points) {
    const auto x = std::min(static_cast<std::uint32_t>(p.x * plane.width), plane.width - 1);
    const auto y = std::min(static_cast<std::uint32_t>(p.y * plane.height), plane.height - 1);
    ++counts[std::size_t{y} * plane.width + x];
  }
  return summarise(counts);
}

}  // namespace abn::analysis
