// Time and quality of the competitors that relax all samples together: gbn, lloyd, ccvt, and sph_blue_noise beside
// them. One thread, so that items per second are of one core.
#include <benchmark/benchmark.h>
#include <omp.h>

#include <cstdint>

#include "sampling/blue_noise_test.h"
#include "sampling/ccvt.h"
#include "sampling/gbn.h"
#include "sampling/lloyd.h"
#include "sampling/relaxation_test.h"
#include "sampling/sph_blue_noise.h"

namespace abn {
namespace {

/// Arguments: samples, side of the plane [px], least relative radius and greatest half-plane error in thousandths.
template <class S>
void relax(benchmark::State& state) {
  const auto budget = static_cast<std::uint64_t>(state.range(0));
  const auto side = static_cast<std::uint32_t>(state.range(1));
  const Extent plane{side, side};
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  S sampler({.plane = plane, .budget = budget, .seed = 1}, {});
  const auto samples = all_positions(sampler);
  const Spacing spacing = nearest_neighbours(samples, plane);
  const double half_planes = half_plane_error(samples, plane);
  const double axes = largest_axis_power(samples, plane);
  if (samples.size() != budget || !(spacing.least >= 1e-3 * static_cast<double>(state.range(2))) ||
      !(half_planes <= 1e-3 * static_cast<double>(state.range(3))) || !(axes <= 60)) {
    state.SkipWithError("wrong count or quality");
  } else {
    std::uint64_t seed = 1;
    for (auto _ : state) {
      S timed({.plane = plane, .budget = budget, .seed = seed++}, {});
      benchmark::DoNotOptimize(all_positions(timed).data());
    }
  }
  omp_set_num_threads(threads);
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.counters["relative_radius"] = spacing.least;
  state.counters["mean_neighbour"] = spacing.mean;
  state.counters["half_plane"] = half_planes;
  state.counters["axis_power"] = axes;
}

void sizes(benchmark::internal::Benchmark* benchmark, std::int64_t radius, std::int64_t half_planes) {
  benchmark->Args({4096, 64, radius, half_planes})->Args({16384, 128, radius, half_planes});
  benchmark->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(relax<SphBlueNoise>)->Name("relax/sph_blue_noise")->Apply([](auto* b) { sizes(b, 650, 160); });
BENCHMARK(relax<Gbn>)->Name("relax/gbn")->Apply([](auto* b) { sizes(b, 350, 160); });
BENCHMARK(relax<Lloyd>)->Name("relax/lloyd")->Apply([](auto* b) { sizes(b, 650, 220); });
BENCHMARK(relax<Ccvt>)->Name("relax/ccvt")->Apply([](auto* b) { sizes(b, 550, 160); });

}  // namespace
}  // namespace abn
