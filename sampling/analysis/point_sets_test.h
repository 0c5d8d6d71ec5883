// Point sets of the unit torus for the tests and benchmarks of this folder.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "sampling/analysis/points.h"
#include "sampling/draw_for_tests.h"
#include "sampling/strategy.h"

namespace abn::analysis {

/// One set of `count` points by the strategy of that name, on a plane of one pixel.
inline std::vector<Point> make_set(std::string_view strategy, std::uint64_t count, std::uint64_t seed,
                                   ParameterWords words = {}) {
  const Strategy& row = find_strategy(strategy, words);
  const auto sampler = row.make({.plane = {1, 1}, .budget = count, .seed = seed}, words);
  return to_unit(draw_all(*sampler), {1, 1});
}

/// The square lattice of side * side points.
inline std::vector<Point> square_lattice(int side, Point offset = {}) {
  std::vector<Point> points;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) points.push_back({(x + offset.x) / side, (y + offset.y) / side});
  }
  return points;
}

}  // namespace abn::analysis
