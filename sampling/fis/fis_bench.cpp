// Time of the banks of fis_sph and of the strategies that draw from a pixel filter, 200 x 200 pixels with 10 samples.
#include <benchmark/benchmark.h>
#include <omp.h>

#include <cmath>
#include <cstdint>
#include <string>

#include "sampling/fis/fis_inversion.h"
#include "sampling/fis/fis_jitter.h"
#include "sampling/fis/fis_metropolis.h"
#include "sampling/fis/fis_rejection.h"
#include "sampling/fis/fis_sph.h"
#include "sampling/fis/set_bank.h"

namespace abn {
namespace {

/// Arguments: samples in a set, kriging weights or not. One thread.
void relax_bank(benchmark::State& state) {
  const FilterDensity density(make_filter("gaussian"), "bench");
  SetBankSpec spec;
  spec.set_size = static_cast<std::uint32_t>(state.range(0));
  spec.kriging = state.range(1) != 0;
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const SetBankQuality quality = measure(relax_set_bank(density, spec), density);
  if (!(std::abs(quality.second_moment_error) < 0.08 && quality.radial_ks < 0.07)) {
    state.SkipWithError("the bank is not distributed as the filter");
  } else {
    for (auto _ : state) {
      ++spec.seed;
      benchmark::DoNotOptimize(relax_set_bank(density, spec).offset.data());
    }
  }
  omp_set_num_threads(threads);
  state.counters["second_moment_error"] = quality.second_moment_error;
  state.counters["ks"] = quality.radial_ks;
}
BENCHMARK(relax_bank)
    ->Args({4, 0})
    ->Args({10, 0})
    ->Args({16, 0})
    ->Args({10, 1})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// Samples of a whole plane, banks included: relaxed anew every time.
template <class T>
void draw_plane(benchmark::State& state) {
  SamplingTask task{.plane = {200, 200}, .budget = 400'000};
  task.filter = make_filter("gaussian");
  task.cache = false;
  const Grid<PixelStats> none;
  std::uint64_t count = 0;
  for (auto _ : state) {
    T sampler(task, {});
    count = 0;
    for (SampleBatch batch = sampler.next({none}); !batch.empty(); batch = sampler.next({none})) {
      count += batch.position.size();
    }
    ++task.seed;
  }
  if (count != task.budget) state.SkipWithError("wrong count");
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(task.budget));
}
BENCHMARK(draw_plane<FisJitter>)->Name("draw_plane/fis_jitter")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(draw_plane<FisInversion>)->Name("draw_plane/fis_inversion")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(draw_plane<FisRejection>)->Name("draw_plane/fis_rejection")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(draw_plane<FisMetropolis>)->Name("draw_plane/fis_metropolis")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(draw_plane<FisSph>)->Name("draw_plane/fis_sph")->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace abn
