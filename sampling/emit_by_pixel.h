// What the strategies have in common that place all samples of the plane together and then emit them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sampling/sampler.h"
#include "sampling/vec.h"

namespace abn {

namespace detail {
/// Stable counting sort by the floor of one coordinate in [0,length).
inline std::vector<Vec2f> sorted_by(const std::vector<Vec2f>& points, float Vec2f::*coordinate, std::uint32_t length) {
  std::vector<std::uint64_t> next(std::size_t{length} + 1, 0);
  for (const Vec2f p : points) ++next[static_cast<std::size_t>(p.*coordinate) + 1];
  for (std::size_t k = 1; k < next.size(); ++k) next[k] += next[k - 1];
  std::vector<Vec2f> sorted(points.size());
  for (const Vec2f p : points) sorted[next[static_cast<std::size_t>(p.*coordinate)]++] = p;
  return sorted;
}
}  // namespace detail

/// The points pixel by pixel, row by row from the top; those of a pixel keep their order. Precondition: all [px] lie
/// inside the plane.
inline std::vector<Vec2f> sorted_by_pixel(const std::vector<Vec2f>& points, Extent plane) {
  return detail::sorted_by(detail::sorted_by(points, &Vec2f::x, plane.width), &Vec2f::y, plane.height);
}

/// All samples of a plane, emitted by pixel (image reads then walk through memory in order) in batches of at most 2^20.
class EmitByPixel {
 public:
  /// Takes all samples; precondition: they lie inside the plane.
  void assign(const std::vector<Vec2f>& samples, Extent plane) {
    samples_ = sorted_by_pixel(samples, plane);
    emitted_ = 0;
  }
  /// Whether no samples have been assigned.
  bool empty() const { return samples_.empty(); }
  /// The next batch; empty after the last. The view lives as long as this object, until the next assign().
  SampleBatch next() {
    const std::size_t count = std::min(std::size_t{1} << 20, samples_.size() - emitted_);
    const auto batch = std::span<const Vec2f>(samples_).subspan(emitted_, count);
    emitted_ += count;
    return {.position = batch};
  }

 private:
  std::vector<Vec2f> samples_;
  std::size_t emitted_ = 0;
};

}  // namespace abn
