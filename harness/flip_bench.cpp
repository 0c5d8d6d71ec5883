#include "harness/flip.h"

#include <benchmark/benchmark.h>

#include <cmath>

#include "sampling/rng.h"

namespace abn::harness {
namespace {

Image noise(Extent size, std::uint64_t seed) {
  Image image(size, 3);
  Rng rng(seed, stream_id("flip_bench"));
  for (float& texel : image.texels) texel = rng.uniform();
  return image;
}

// Milliseconds per pair of images; width and height are arguments.
template <FlipResult (*flip)(const Image&, const Image&, double)>
void flip_pair(benchmark::State& state) {
  const Extent size{static_cast<std::uint32_t>(state.range(0)), static_cast<std::uint32_t>(state.range(1))};
  const Image test = noise(size, 1);
  const Image reference = noise(size, 2);
  if (flip(test, test, flip_pixels_per_degree).mean != 0 || !(flip(test, reference, flip_pixels_per_degree).mean > 0)) {
    state.SkipWithError("equal images must give 0, different ones more");
    return;
  }
  for (auto _ : state) benchmark::DoNotOptimize(flip(test, reference, flip_pixels_per_degree).mean);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(size.area()));
}

BENCHMARK_TEMPLATE(flip_pair, ldr_flip)
    ->Args({200, 200})
    ->Args({1920, 1080})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_TEMPLATE(flip_pair, hdr_flip)->Args({200, 200})->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace abn::harness
