// Time per Voronoi cell, for even and uneven densities.
#include "sampling/voronoi.h"

#include <benchmark/benchmark.h>

#include <cmath>

#include "sampling/rng.h"

namespace abn {
namespace {

constexpr Extent plane{200, 200};
constexpr std::uint64_t count = 240'000;

/// How a benchmark places point i from a random point of the unit square.
using Placement = Vec2f (*)(Vec2f unit, std::uint64_t i);

Vec2f white(Vec2f unit, std::uint64_t) { return to_plane(unit, plane); }

Vec2f jittered(Vec2f unit, std::uint64_t i) {
  const std::uint64_t row = i / 600;  // of 400, 600 cells each
  return to_plane({place(static_cast<float>(i % 600) / 600, unit.x / 600, 1.0F / 600),
                   place(static_cast<float>(row) / 400, unit.y / 400, 1.0F / 400)},
                  plane);
}

/// The right half is a hundred times as dense as the left one.
Vec2f density_jump(Vec2f unit, std::uint64_t i) {
  return to_plane({i % 101 == 0 ? unit.x / 2 : 0.5F + unit.x / 2, unit.y}, plane);
}

/// All within a thousandth of the plane's side.
Vec2f cluster(Vec2f unit, std::uint64_t) { return {100 + 0.2F * unit.x, 100 + 0.2F * unit.y}; }

void cells(benchmark::State& state, Placement placement) {
  std::vector<Vec2f> points;
  for (std::uint64_t i = 0; i < count; ++i) {
    points.push_back(placement(Rng(1, stream_id("voronoi bench"), i).uniform2(), i));
  }
  VoronoiCell cell;
  const auto total_area = [&] {
    const PeriodicVoronoi voronoi(points, plane);
    double sum = 0;
    for (const std::uint32_t i : voronoi.order()) {
      voronoi.cell(i, cell);
      sum += cell.area();
    }
    return sum;
  };
  if (!(std::abs(total_area() / static_cast<double>(plane.area()) - 1) < 1e-9)) {
    state.SkipWithError("the cells do not cover the plane");
    return;
  }
  for (auto _ : state) benchmark::DoNotOptimize(total_area());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
}

BENCHMARK_CAPTURE(cells, white, white)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(cells, jittered, jittered)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(cells, density_jump, density_jump)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(cells, cluster, cluster)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace abn
