// The stages of adaptive sampling that look at all samples, at six samples per pixel of 200 x 200.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sampling/adaptive/gabriel.h"
#include "sampling/adaptive/local_variance.h"
#include "sampling/adaptive/rank_order.h"
#include "sampling/rng.h"
#include "sampling/sph_blue_noise.h"

namespace abn {
namespace {

constexpr Extent plane{200, 200};

/// A disk of contrast 1 on black.
std::vector<float> disk(const std::vector<Vec2f>& position) {
  std::vector<float> value;
  value.reserve(position.size());
  for (const Vec2f p : position) value.push_back(std::hypot(p.x - 100, p.y - 100) < 60 ? 1.0F : 0.0F);
  return value;
}

/// The distance of a place from the disk's edge [px].
float from_edge(float x, float y) { return std::abs(std::hypot(x - 100, y - 100) - 60); }

void variance_map(benchmark::State& state) {
  const auto position = coarse_cell_positions(plane, 100'000, 1, 2);
  const auto value = disk(position);
  const Extent map{400, 400};
  const auto first = local_variance(position, value, 1, plane, map);
  for (std::uint32_t y = 0; y < map.height; ++y) {
    for (std::uint32_t x = 0; x < map.width; ++x) {
      const bool far = from_edge((static_cast<float>(x) + 0.5F) / 2, (static_cast<float>(y) + 0.5F) / 2) > 4;
      if (far && first.at(x, y) != 0) state.SkipWithError("variance where nothing varies");
    }
  }
  if (*std::max_element(first.cells().begin(), first.cells().end()) < 0.25F) state.SkipWithError("the edge is missed");
  for (auto _ : state) benchmark::DoNotOptimize(local_variance(position, value, 1, plane, map));
}
BENCHMARK(variance_map)->Unit(benchmark::kMillisecond)->UseRealTime();

void gabriel_pass(benchmark::State& state) {
  const auto position = coarse_cell_positions(plane, 204'000, 1, 2);
  const auto value = disk(position);
  std::size_t at_edge = 0;
  for (const Vec2f p : gabriel_midpoints(position, value, 1, plane, 500, 1).position) {
    at_edge += from_edge(p.x, p.y) < 1 ? 1 : 0;
  }
  if (at_edge < 500) state.SkipWithError("the first midpoints do not lie at the edge");
  for (auto _ : state) benchmark::DoNotOptimize(gabriel_midpoints(position, value, 1, plane, 18'000, 1));
}
BENCHMARK(gabriel_pass)->Unit(benchmark::kMillisecond)->UseRealTime();

void rank_order(benchmark::State& state) {
  const auto position = coarse_cell_positions(plane, 204'000, 1, 2);
  auto order = farthest_first_order(position, plane, 1);
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (order[i] != i) state.SkipWithError("not an order of all points");
  }
  for (auto _ : state) benchmark::DoNotOptimize(farthest_first_order(position, plane, 1));
}
BENCHMARK(rank_order)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace abn
