// Points and extents of the plane. The plane is measured in output pixels: [0,width) x [0,height), y down,
// and the pixel that contains a position is floor(position).
#pragma once

#include <bit>
#include <cstdint>

#include "sampling/hd.h"

namespace abn {

/// A point or a displacement on the plane [px], or on the unit square [1] where a function says so.
struct Vec2f {
  float x = 0;
  float y = 0;
  friend ABN_HD constexpr Vec2f operator+(Vec2f a, Vec2f b) { return {a.x + b.x, a.y + b.y}; }
  friend ABN_HD constexpr Vec2f operator-(Vec2f a, Vec2f b) { return {a.x - b.x, a.y - b.y}; }
  friend ABN_HD constexpr Vec2f operator*(Vec2f a, float s) { return {a.x * s, a.y * s}; }
  friend constexpr bool operator==(Vec2f, Vec2f) = default;
};

/// Width and height of a raster or a plane [px].
struct Extent {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  ABN_HD constexpr std::uint64_t area() const { return std::uint64_t{width} * height; }
  friend constexpr bool operator==(Extent, Extent) = default;
};

/// The largest float below `limit` (limit > 0, finite).
ABN_HD constexpr float just_below(float limit) {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(limit) - 1u);
}

/// origin + offset, kept below `origin + size`: a float sum may round up to the next cell, which would put the
/// sample into a neighbour's pixel. Precondition: 0 <= offset < size, origin >= 0.
ABN_HD constexpr float place(float origin, float offset, float size) {
  const float position = origin + offset;
  const float end = origin + size;
  return position < end ? position : just_below(end);
}

/// Scales a point of the unit square [0,1)^2 onto the plane, never onto its far border.
ABN_HD constexpr Vec2f to_plane(Vec2f unit, Extent plane) {
  const auto w = static_cast<float>(plane.width);
  const auto h = static_cast<float>(plane.height);
  return {place(0.0F, unit.x * w, w), place(0.0F, unit.y * h, h)};
}

/// Puts a point of the unit square into pixel (x, y) of the plane, never onto its far border.
ABN_HD constexpr Vec2f to_pixel(Vec2f unit, std::uint32_t x, std::uint32_t y) {
  return {place(static_cast<float>(x), unit.x, 1.0F), place(static_cast<float>(y), unit.y, 1.0F)};
}

}  // namespace abn
