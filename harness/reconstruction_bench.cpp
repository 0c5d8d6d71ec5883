// Milliseconds per picture of every row of the table: 240 000 RGB samples on 200 x 200 pixels, half of which an edge
// crosses, on one and two threads. Compare rows of one run with each other, not with those of another machine.
#include "harness/reconstruction.h"

#include <benchmark/benchmark.h>
#include <omp.h>

#include <cmath>
#include <string>

#include "harness/reconstruction_cases.h"

namespace abn::harness {
namespace {

// Discs on a slope.
void discs(Vec2f p, float* value) {
  const float x = p.x - 7.3F * std::floor(p.x / 7.3F) - 3.65F;
  const float y = p.y - 7.3F * std::floor(p.y / 7.3F) - 3.65F;
  const float light = (x * x + y * y < 7 ? 0.8F : 0.1F) + 1e-3F * p.x;
  value[0] = light;
  value[1] = 0.7F * light;
  value[2] = 0.2F;
}

const Film& film() {
  static const Film made = film_of({200, 200}, 3, jittered({200, 200}, 3, 2, 1), discs);
  return made;
}

void develop(benchmark::State& state, const std::string& name) {
  const Reconstruction& row = find_reconstruction(name);
  const int before = omp_get_max_threads();
  omp_set_num_threads(static_cast<int>(state.range(0)));
  const Developed developed = row.develop(film());
  if (!all_finite(developed) || std::abs(developed.image.texels[2] - 0.2F) > 1e-6F) {
    state.SkipWithError("the constant channel must come out");
  } else {
    for (auto _ : state) benchmark::DoNotOptimize(row.develop(film()).image.texels.data());
  }
  omp_set_num_threads(before);
}

[[maybe_unused]] const int registered = [] {
  for (const Reconstruction& row : reconstructions()) {
    benchmark::RegisterBenchmark(("reconstruction/" + row.name).c_str(),
                                 [name = row.name](benchmark::State& state) { develop(state, name); })
        ->Arg(1)
        ->Arg(2)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime()
        ->MeasureProcessCPUTime();
  }
  return 0;
}();

}  // namespace
}  // namespace abn::harness
