// Films for the tests and benchmarks of reconstructions.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "harness/film.h"
#include "sampling/rng.h"

namespace abn::harness {

/// A function on the plane: writes the channels of a position [px].
using TestFunction = std::function<void(Vec2f position, float* value)>;

inline Film film_of(Extent plane, std::uint32_t channels, const std::vector<Vec2f>& position,
                    const TestFunction& function, const std::vector<float>& weight = {}) {
  std::vector<float> value(position.size() * channels);
  for (std::size_t i = 0; i < position.size(); ++i) function(position[i], value.data() + i * channels);
  Film film(plane, channels, true);
  film.add({position, weight}, value);
  return film;
}

/// `columns` x `rows` jittered samples in every pixel.
inline std::vector<Vec2f> jittered(Extent plane, std::uint32_t columns, std::uint32_t rows, std::uint64_t seed) {
  std::vector<Vec2f> position;
  Rng rng(seed, stream_id("reconstruction_cases jitter"));
  for (std::uint32_t y = 0; y < plane.height; ++y) {
    for (std::uint32_t x = 0; x < plane.width; ++x) {
      for (std::uint32_t k = 0; k < columns * rows; ++k) {
        const Vec2f unit = rng.uniform2();
        position.push_back(to_pixel({(static_cast<float>(k % columns) + unit.x) / static_cast<float>(columns),
                                     (static_cast<float>(k / columns) + unit.y) / static_cast<float>(rows)},
                                    x, y));
      }
    }
  }
  return position;
}

/// `count` independent samples, uniform on the plane.
inline std::vector<Vec2f> scattered(Extent plane, std::size_t count, std::uint64_t seed) {
  std::vector<Vec2f> position;
  Rng rng(seed, stream_id("reconstruction_cases scatter"));
  for (std::size_t i = 0; i < count; ++i) position.push_back(to_plane(rng.uniform2(), plane));
  return position;
}

/// The mean of a function with one channel over pixel (x, y), by n x n midpoints.
inline double pixel_mean(const TestFunction& function, std::uint32_t x, std::uint32_t y, int n = 64) {
  double sum = 0;
  for (int v = 0; v < n; ++v) {
    for (int u = 0; u < n; ++u) {
      float value = 0;
      function({static_cast<float>(x) + (static_cast<float>(u) + 0.5F) / static_cast<float>(n),
                static_cast<float>(y) + (static_cast<float>(v) + 0.5F) / static_cast<float>(n)},
               &value);
      sum += double{value};
    }
  }
  return sum / (n * n);
}

/// Root mean square error of a picture of one channel against pixel_mean().
inline double error_of(const Image& image, const TestFunction& function) {
  double sum = 0;
  for (std::uint32_t y = 0; y < image.size.height; ++y) {
    for (std::uint32_t x = 0; x < image.size.width; ++x) {
      const double error = double{*image.texel(x, y)} - pixel_mean(function, x, y);
      sum += error * error;
    }
  }
  return std::sqrt(sum / static_cast<double>(image.size.area()));
}

inline bool all_finite(const Developed& developed) {
  for (const float texel : developed.image.texels) {
    if (!std::isfinite(texel)) return false;
  }
  for (const float error : developed.standard_error.cells()) {
    if (!std::isfinite(error) || error < 0) return false;
  }
  return true;
}

}  // namespace abn::harness
