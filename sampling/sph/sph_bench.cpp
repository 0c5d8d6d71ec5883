// Cost of the SPH engine. Every row checks its answer first, then times.
#include <benchmark/benchmark.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sampling/sph/solver.h"
#include "sampling/sph/test_pair_loops.h"
#include "sampling/sph/test_planes.h"

namespace abn::sph {
namespace {

constexpr Extent plane{200, 200};

Grid<float> no_field() { return Grid<float>({1, 1}, 1.0F); }

/// A solver on n particles drawn from the field's density; `ratio` > 1: a smooth size field 1:ratio.
struct Start {
  Grid<float> size;
  std::vector<Vec2f> positions;
  Start(std::uint64_t n, double ratio)
      : size(ratio > 1 ? smooth_size_field({400, 400}, ratio) : no_field()),
        positions(drawn_positions(plane, size, n)) {}
  std::unique_ptr<Solver> solver(const SolverFactory& make) const {
    auto made = make(setup_of(plane, positions));
    if (size.size().area() > 1) made->set_size_field(size);
    return made;
  }
};

double largest_difference(const Evaluation& a, const Evaluation& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.density.size(); ++i) {
    largest = std::max({largest, std::abs(a.density[i] / b.density[i] - 1), std::abs(a.force_x[i] - b.force_x[i]),
                        std::abs(a.force_y[i] - b.force_y[i])});
  }
  return largest;
}

void per_particle(benchmark::State& state, double particles) {
  state.counters["per_particle"] =
      benchmark::Counter(particles, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// Density and force of 60 000 particles on one thread: the vectorised passes, and how many times faster than the
/// scalar bodies they are. Argument: ratio of the size field.
void BM_PairLoops(benchmark::State& state, InstructionSet set) {
  if (set == InstructionSet::avx2 && best_instruction_set() != InstructionSet::avx2) {
    state.SkipWithError("no AVX2 here");
    return;
  }
  const Start start(60000, static_cast<double>(state.range(0)));
  const auto solver = start.solver(make_cpu_solver);
  solver->relax(15, false);
  const std::vector<Vec2f> positions(solver->positions().begin(), solver->positions().end());
  const auto setup = setup_of(plane, positions);
  PairLoops loops(make_problem(setup, positions, start.size.size().area() > 1 ? &start.size : nullptr));
  loops.run_scalar();
  const std::vector<float> density = loops.density;
  const std::vector<float> force = loops.force_x;
  loops.run(set);
  if (loops.density != density || loops.force_x != force) {
    state.SkipWithError("density or force differs from the scalar bodies");
    return;
  }
  for (auto _ : state) loops.run(set);
  per_particle(state, 60000);
  const double scalar = median_seconds(7, [&] { loops.run_scalar(); });
  state.counters["times_faster_than_scalar"] = scalar / median_seconds(7, [&] { loops.run(set); });
}
BENCHMARK_CAPTURE(BM_PairLoops, baseline, InstructionSet::baseline)
    ->ArgName("size_ratio")
    ->Arg(1)
    ->Arg(10)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(BM_PairLoops, avx2, InstructionSet::avx2)
    ->ArgName("size_ratio")
    ->Arg(1)
    ->Arg(10)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// One step of the engine. Arguments: particles, ratio of the size field, threads. Beside a field also its cost
/// relative to that of a uniform plane.
void BM_Step(benchmark::State& state, const SolverFactory& make) {
  const auto n = static_cast<std::uint64_t>(state.range(0));
  const Start start(n, static_cast<double>(state.range(1)));
  const int threads = omp_get_max_threads();
  if (state.range(2) > omp_get_num_procs()) {
    state.SkipWithError("more threads than processors");
    return;
  }
  const auto solver = start.solver(make);
  if (largest_difference(solver->evaluate(), start.solver(make_cpu_solver_double)->evaluate()) > 2e-3) {
    state.SkipWithError("density or force differs from the double engine");
    return;
  }
  omp_set_num_threads(static_cast<int>(state.range(2)));
  solver->relax(10, false);  // past the white start, whose clusters cost more
  for (auto _ : state) solver->relax(1, false);
  per_particle(state, static_cast<double>(n));
  if (state.range(1) > 1 && state.range(2) == 1) {
    const auto uniform = Start(n, 1).solver(make);
    uniform->relax(10, false);
    const double of_uniform = median_seconds(7, [&] { uniform->relax(1, false); });
    state.counters["times_uniform"] = median_seconds(7, [&] { solver->relax(1, false); }) / of_uniform;
  }
  omp_set_num_threads(threads);
}
BENCHMARK_CAPTURE(BM_Step, float, make_cpu_solver)
    ->ArgNames({"particles", "size_ratio", "threads"})
    ->Args({240000, 1, 1})
    ->Args({240000, 1, 2})
    ->Args({240000, 10, 1})
    ->Args({240000, 10, 2})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK_CAPTURE(BM_Step, double, make_cpu_solver_double)
    ->ArgNames({"particles", "size_ratio", "threads"})
    ->Args({240000, 1, 1})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

/// 240 000 samples from coarse cells to a mean displacement below 0.01 d. Argument: threads.
void BM_BlueNoise(benchmark::State& state) {
  const Start start(240000, 1);
  const int threads = omp_get_max_threads();
  if (state.range(0) > omp_get_num_procs()) {
    state.SkipWithError("more threads than processors");
    return;
  }
  omp_set_num_threads(static_cast<int>(state.range(0)));
  RelaxReport report;
  for (auto _ : state) {
    const auto solver = make_cpu_solver(setup_of(plane, start.positions));
    report = solver->relax(100, true);
    benchmark::DoNotOptimize(solver->positions().data());
  }
  omp_set_num_threads(threads);
  if (!report.converged || report.non_finite > 0) state.SkipWithError("did not relax");
  state.counters["steps"] = report.steps;
  per_particle(state, 240000.0 * report.steps);
}
BENCHMARK(BM_BlueNoise)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

/// Preparing a 400x400 size field for 240 000 particles.
void BM_SetSizeField(benchmark::State& state) {
  const Start start(240000, static_cast<double>(state.range(0)));
  const auto solver = make_cpu_solver(setup_of(plane, start.positions));
  solver->set_size_field(start.size);
  const Evaluation evaluation = solver->evaluate();
  double mean = 0;
  for (const double density : evaluation.density) mean += density / 240000;
  if (!(mean > 1 && mean < 2)) {  // of white points in coarse cells about 1.5
    state.SkipWithError("the mean density is not that of the field");
    return;
  }
  for (auto _ : state) solver->set_size_field(start.size);
}
BENCHMARK(BM_SetSizeField)
    ->ArgName("size_ratio")
    ->Arg(10)
    ->Arg(100)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace abn::sph
