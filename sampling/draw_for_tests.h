// For tests and benchmarks: everything a sampler emits.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "sampling/sampler.h"

namespace abn {

/// All positions of a sampler that ignores its feedback [px].
inline std::vector<Vec2f> draw_all(Sampler& sampler) {
  const Grid<PixelStats> none;
  const Feedback feedback{none};
  std::vector<Vec2f> all;
  for (SampleBatch batch = sampler.next(feedback); !batch.empty(); batch = sampler.next(feedback)) {
    all.insert(all.end(), batch.position.begin(), batch.position.end());
  }
  return all;
}

/// All positions of strategy T.
template <class T>
std::vector<Vec2f> draw(Extent plane, std::uint64_t budget, std::uint64_t seed,
                        const typename T::Params& parameters = {}) {
  T sampler(SamplingTask{plane, budget, seed}, parameters);
  return draw_all(sampler);
}

/// The offsets inside their pixel of the samples of every pixel, in order of emission.
inline std::vector<std::vector<Vec2f>> by_pixel(const std::vector<Vec2f>& positions, Extent plane) {
  std::vector<std::vector<Vec2f>> pixels(plane.area());
  for (const Vec2f p : positions) {
    const auto x = static_cast<std::uint32_t>(p.x);
    const auto y = static_cast<std::uint32_t>(p.y);
    pixels.at(std::size_t{y} * plane.width + x).push_back({p.x - static_cast<float>(x), p.y - static_cast<float>(y)});
  }
  return pixels;
}

/// Whether every one of columns * rows cells of the unit square holds the same number of points.
inline bool cells_equally_filled(const std::vector<Vec2f>& unit_points, std::size_t columns, std::size_t rows) {
  std::vector<std::size_t> count(columns * rows);
  for (const Vec2f p : unit_points) {
    const auto x = static_cast<std::size_t>(static_cast<double>(p.x) * static_cast<double>(columns));
    const auto y = static_cast<std::size_t>(static_cast<double>(p.y) * static_cast<double>(rows));
    if (x >= columns || y >= rows) return false;
    ++count[y * columns + x];
  }
  for (const std::size_t c : count) {
    if (c * columns * rows != unit_points.size()) return false;
  }
  return true;
}

/// Whether 2^m points of the unit square are a (0,m,2)-net in base 2: one in every elementary interval of area 2^-m.
inline bool is_zero_net(const std::vector<Vec2f>& unit_points, unsigned m) {
  if (unit_points.size() != std::size_t{1} << m) return false;
  for (unsigned a = 0; a <= m; ++a) {
    if (!cells_equally_filled(unit_points, std::size_t{1} << a, std::size_t{1} << (m - a))) return false;
  }
  return true;
}

/// A set as its strategy made it: every second pixel of a strategy that alternates axes has x and y exchanged. `pixels`
/// as by_pixel gives them.
inline std::vector<std::vector<Vec2f>> with_axes_restored(std::vector<std::vector<Vec2f>> pixels, Extent plane) {
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if ((i % plane.width + i / plane.width) % 2 == 0) continue;
    for (Vec2f& p : pixels[i]) p = {p.y, p.x};
  }
  return pixels;
}

}  // namespace abn
