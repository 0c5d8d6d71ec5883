// Cost of the exact spectrum, the lattice alarm and the pair correlation. Each first checks its answer against the
// definition, then times; ratios are taken inside this process.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "sampling/analysis/axis_power.h"
#include "sampling/analysis/pair_correlation.h"
#include "sampling/analysis/periodogram.h"
#include "sampling/analysis/point_sets_test.h"
#include "sampling/rng.h"

namespace abn::analysis {
namespace {

constexpr int kReach = 256;
constexpr std::uint64_t kPlane = 240'000;

struct Frequency {
  int u, v;
};

std::vector<Frequency> random_frequencies(int count) {
  Rng rng(1, stream_id("frequencies"));
  std::vector<Frequency> frequencies;
  for (int i = 0; i < count; ++i) {
    const int u = static_cast<int>(rng.below(2 * kReach)) - kReach;
    frequencies.push_back({u, static_cast<int>(rng.below(2 * kReach)) - kReach});
  }
  return frequencies;
}

// What one would write first: a sine and a cosine for every point and frequency.
double direct_power(Points points, Frequency f) {
  double cosine = 0;
  double sine = 0;
  for (const Point p : points) {
    const double turns = f.u * p.x + f.v * p.y;
    const double angle = 2 * std::numbers::pi * (turns - std::floor(turns));
    cosine += std::cos(angle);
    sine += std::sin(angle);
  }
  return (cosine * cosine + sine * sine) / static_cast<double>(points.size());
}

double seconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// 512^2 frequencies. Arguments: points, instructions (0 baseline, 1 AVX2, 2 AVX-512).
void BM_Periodogram(benchmark::State& state) {
  const auto units = vector_units();
  const auto unit = static_cast<VectorUnit>(state.range(1));
  if (std::find(units.begin(), units.end(), unit) == units.end()) {
    state.SkipWithError("not on this processor");
    return;
  }
  state.SetLabel(to_string(unit));
  const auto points = make_set("jitter", static_cast<std::uint64_t>(state.range(0)), 1);
  const auto frequencies = random_frequencies(40);
  const Periodogram spectrum(points, kReach, unit);
  double error = 0;
  double direct_s = seconds_of([&] {
    for (const Frequency f : frequencies) {
      error = std::max(error, std::abs(spectrum.power(f.u, f.v) - direct_power(points, f)));
    }
  });
  if (!(error < 1e-11)) {
    state.SkipWithError("power differs from the direct sum");
    return;
  }
  direct_s *= 4.0 * kReach * kReach / static_cast<double>(frequencies.size());
  double best_s = 1e30;
  for (auto _ : state) {
    best_s = std::min(best_s, seconds_of([&] { benchmark::DoNotOptimize(Periodogram(points, kReach, unit)); }));
  }
  state.counters["error"] = error;
  state.counters["direct_s"] = direct_s;
  state.counters["times_faster"] = direct_s / best_s;
}
BENCHMARK(BM_Periodogram)
    ->Args({16384, 0})
    ->Args({16384, 1})
    ->Args({16384, 2})
    ->Args({4096, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void BM_AxisPower(benchmark::State& state) {
  const auto points = make_set("random", kPlane, 1);
  const AxisPower power = axis_power(points);
  for (const int k : {1, 777, 1960}) {
    const auto i = static_cast<std::size_t>(k);
    const double error = std::max({std::abs(power.x[i] - direct_power(points, {k, 0})),
                                   std::abs(power.y[i] - direct_power(points, {0, k})),
                                   std::abs(power.anti_diagonal[i] - direct_power(points, {k, -k}))});
    if (!(error < 1e-10)) {
      state.SkipWithError("power differs from the direct sum");
      return;
    }
  }
  for (auto _ : state) benchmark::DoNotOptimize(axis_power(points));
  state.counters["largest"] = power.largest;
}
BENCHMARK(BM_AxisPower)->Unit(benchmark::kMillisecond)->UseRealTime();

// Argument: ratio of sizes.
void BM_PairCorrelation(benchmark::State& state) {
  const auto points = make_set("random", kPlane, 1);
  std::vector<float> size;
  for (const Point p : points) size.push_back(static_cast<float>(1 + (static_cast<double>(state.range(0)) - 1) * p.x));
  const PairCorrelation correlation = pair_correlation(points, size);
  if (!(std::abs(correlation.plateau - 1) < 0.02)) {  // random points have no correlation, whatever the sizes
    state.SkipWithError("random points appear correlated");
    return;
  }
  for (auto _ : state) benchmark::DoNotOptimize(pair_correlation(points, size));
  state.counters["pairs"] = static_cast<double>(correlation.pairs);
}
BENCHMARK(BM_PairCorrelation)->Arg(1)->Arg(5)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace abn::analysis
