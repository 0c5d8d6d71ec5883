// Samples per second of the baseline, stratified and low-discrepancy strategies, and the bare Sobol-Owen kernel.
// First the answers are checked, then the clock runs; one item is one sample.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "sampling/cmj.h"
#include "sampling/halton.h"
#include "sampling/hammersley.h"
#include "sampling/jitter.h"
#include "sampling/multijitter.h"
#include "sampling/nrooks.h"
#include "sampling/pmj02.h"
#include "sampling/random.h"
#include "sampling/regular.h"
#include "sampling/sobol.h"
#include "sampling/sobol2d.h"
#include "sampling/sobol_owen.h"
#include "sampling/zero_two.h"

namespace abn {
namespace {

constexpr Extent kPlane{200, 200};

// Number of samples inside the plane.
std::uint64_t drain(Sampler& sampler) {
  const Grid<PixelStats> none;
  const Feedback feedback{none};
  std::uint64_t inside = 0;
  for (SampleBatch batch = sampler.next(feedback); !batch.empty(); batch = sampler.next(feedback)) {
    // One sample in 64 is looked at, so that reading costs nothing beside making.
    for (std::size_t i = 0; i < batch.position.size(); i += 64) {
      const Vec2f p = batch.position[i];
      const bool ok = p.x >= 0 && p.y >= 0 && p.x < 200 && p.y < 200;
      inside += ok ? std::min<std::size_t>(64, batch.position.size() - i) : 0;
    }
  }
  return inside;
}

void fail(const std::string& what) {
  std::fprintf(stderr, "wrong answer: %s\n", what.c_str());
  std::exit(1);
}

template <class T>
void emit_all(benchmark::State& state, const typename T::Params& parameters) {
  const auto budget = static_cast<std::uint64_t>(state.range(0));
  T once(SamplingTask{kPlane, 240000, 1}, parameters);
  if (drain(once) != 240000) fail(T::info.name);
  for (auto _ : state) {
    T sampler(SamplingTask{kPlane, budget, 1}, parameters);
    benchmark::DoNotOptimize(drain(sampler));
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(budget) * state.iterations());
}

template <class T>
void strategy(benchmark::State& state) {
  emit_all<T>(state, {});
}

template <class T>
void strategy_on_plane(benchmark::State& state) {
  emit_all<T>(state, {.domain = "plane"});
}

void sobol_owen_kernel(benchmark::State& state) {
  std::vector<UnitPoint> points(4096);
  sobol_owen_points(0, 123, 456, points);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (points[i].y != reverse_bits(owen_hash(pascal_bits(i), 456))) fail("sobol_owen kernel");
  }
  std::uint32_t first = 0;
  for (auto _ : state) {
    sobol_owen_points(first, 123, 456, points);
    benchmark::DoNotOptimize(points.data());
    benchmark::ClobberMemory();
    first += 4096;
  }
  state.SetItemsProcessed(4096 * state.iterations());
}
BENCHMARK(sobol_owen_kernel);

void sizes(benchmark::internal::Benchmark* bench) {
  bench->Arg(240000)->Arg(40000000)->Unit(benchmark::kMillisecond)->UseRealTime();
}
BENCHMARK_TEMPLATE(strategy, Random)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy, RandomPixel)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy, Regular)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy, Jitter)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy, JitterPlane)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy, NRooks)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy, MultiJitter)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy, Cmj)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy, Hammersley)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy, Halton)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy, Sobol)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy, SobolOwen)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy, ZeroTwo)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy, Pmj02)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy_on_plane, NRooks)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy_on_plane, MultiJitter)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy_on_plane, Cmj)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy_on_plane, SobolOwen)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy_on_plane, ZeroTwo)->Apply(sizes);
BENCHMARK_TEMPLATE(strategy_on_plane, Pmj02)->Apply(sizes);

}  // namespace
}  // namespace abn
