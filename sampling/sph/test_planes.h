// Start positions and size fields that the SPH tests and benchmarks share.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "sampling/grid.h"
#include "sampling/rng.h"
#include "sampling/sph/draw.h"
#include "sampling/sph/solver.h"
#include "sampling/vec.h"

namespace abn::sph {

inline std::vector<Vec2f> white_positions(Extent plane, std::uint64_t n, std::uint64_t seed = 1) {
  std::vector<Vec2f> positions;
  for (std::uint64_t i = 0; i < n; ++i) {
    positions.push_back(to_plane(Rng(seed, stream_id("white positions"), i).uniform2(), plane));
  }
  return positions;
}

/// All defaults. `positions` must outlive the result.
inline sph::Setup setup_of(Extent plane, const std::vector<Vec2f>& positions) {
  sph::Setup setup;
  setup.plane = plane;
  setup.positions = positions;
  return setup;
}

/// s between 1 and `ratio`, a smooth hill with exponential flanks.
inline Grid<float> smooth_size_field(Extent size, double ratio) {
  Grid<float> field(size);
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = 0; x < size.width; ++x) {
      const double u = std::sin(3.14159265358979 * (x + 0.5) / size.width);
      const double v = std::sin(3.14159265358979 * (y + 0.5) / size.height);
      field.at(x, y) = static_cast<float>(std::pow(ratio, u * u * v * v));
    }
  }
  return field;
}

/// s = 1 on the left half and `ratio` on the right.
inline Grid<float> jump_size_field(Extent size, float ratio) {
  Grid<float> field(size, 1.0F);
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = size.width / 2; x < size.width; ++x) field.at(x, y) = ratio;
  }
  return field;
}

/// White positions with density s^-2, by rejection.
inline std::vector<Vec2f> positions_by_size(Extent plane, const Grid<float>& size, std::uint64_t n,
                                            std::uint64_t seed = 1) {
  float smallest = size[0];
  for (const float s : size.cells()) smallest = s < smallest ? s : smallest;
  std::vector<Vec2f> positions;
  Rng rng(seed, stream_id("positions by size"));
  while (positions.size() < n) {
    const Vec2f unit = rng.uniform2();
    const float s = size.at(static_cast<std::uint32_t>(unit.x * static_cast<float>(size.size().width)),
                            static_cast<std::uint32_t>(unit.y * static_cast<float>(size.size().height)));
    if (rng.uniform() < smallest * smallest / (s * s)) positions.push_back(to_plane(unit, plane));
  }
  return positions;
}

/// Start positions of density s^-2 without long waves.
inline std::vector<Vec2f> drawn_positions(Extent plane, const Grid<float>& size, std::uint64_t n,
                                          std::uint64_t seed = 1) {
  const auto density = [&](double u, double v) {
    const double s = double{
        size.at(static_cast<std::uint32_t>(u * size.size().width), static_cast<std::uint32_t>(v * size.size().height))};
    return 1 / (s * s);
  };
  std::vector<Vec2f> positions;
  for (const UnitPosition p : draw_by_density(density, static_cast<double>(plane.width) / plane.height, n, seed)) {
    positions.push_back(to_plane({static_cast<float>(p.x), static_cast<float>(p.y)}, plane));
  }
  return positions;
}

}  // namespace abn::sph
