// Time per sample of the classical blue-noise strategies.
#include <benchmark/benchmark.h>

#include "sampling/blue_noise_test.h"
#include "sampling/dart.h"
#include "sampling/poisson_disk.h"

namespace abn {
namespace {

template <class S>
void generate(benchmark::State& state) {
  const auto budget = static_cast<std::uint64_t>(state.range(0));
  const Extent plane{200, 200};
  const Grid<PixelStats> pixels({1, 1});
  double radius = 0;
  {
    S sampler({.plane = plane, .budget = budget, .seed = 1}, {});
    const auto points = all_positions(sampler);
    radius = diagnostic(sampler, "min_distance");
    if (points.size() != budget || !(smallest_torus_distance(points, plane) >= radius)) {
      state.SkipWithError("wrong count or distance");
      return;
    }
  }
  std::uint64_t seed = 1;
  for (auto _ : state) {
    S sampler({.plane = plane, .budget = budget, .seed = seed++}, {});
    while (true) {
      const SampleBatch batch = sampler.next({pixels});
      if (batch.empty()) break;
      benchmark::DoNotOptimize(batch.position.data());
    }
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.counters["min_distance"] = radius;
}

BENCHMARK(generate<Dart>)->Name("dart")->Arg(4096)->Arg(240'000)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(generate<PoissonDisk>)
    ->Name("poisson_disk")
    ->Arg(4096)
    ->Arg(240'000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace abn
