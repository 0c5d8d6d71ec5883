// Cost of the SPH engine per particle and iteration. Each row first checks density and force against the brute-force
// twin (or the double engine, where the twin is too slow), then times.
#include <benchmark/benchmark.h>
#include <omp.h>

#include <cmath>
#include <string>

#include "sampling/sph/brute_force.h"
#include "sampling/sph/solver.h"
#include "sampling/sph/test_planes.h"

namespace abn::sph {
namespace {

/// A plane of n particles, relaxed a little by the caller's solver; `ratio` > 1 adds a smooth size field 1:ratio.
struct Problem {
  std::vector<Vec2f> positions;
  Grid<float> size;
  Setup setup;

  Problem(std::uint64_t n, double ratio) {
    setup.plane = {200, 200};
    size = smooth_size_field({200, 200}, ratio);
    positions = positions_by_size(setup.plane, size, n);
    setup.positions = positions;
  }
  std::unique_ptr<Solver> solver(SolverFactory make) const {
    auto made = make(setup);
    made->set_size_field(size);
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

/// One step of the engine. Arguments: particles, ratio of the size field, threads.
void BM_Step(benchmark::State& state, SolverFactory make) {
  const Problem problem(static_cast<std::uint64_t>(state.range(0)), static_cast<double>(state.range(1)));
  const int threads = omp_get_max_threads();
  if (state.range(2) > omp_get_num_procs()) {
    state.SkipWithError("more threads than processors");
    return;
  }
  const auto solver = problem.solver(make);
  if (largest_difference(solver->evaluate(), problem.solver(make_cpu_solver_double)->evaluate()) > 2e-3) {
    state.SkipWithError("density or force differs from the double engine");
    return;
  }
  omp_set_num_threads(static_cast<int>(state.range(2)));
  solver->relax(10, false);  // past the white start, whose clusters cost more
  for (auto _ : state) solver->relax(1, false);
  per_particle(state, static_cast<double>(state.range(0)));
  omp_set_num_threads(threads);
}
BENCHMARK_CAPTURE(BM_Step, float, make_cpu_solver)
    ->ArgNames({"particles", "size_ratio", "threads"})
    ->Args({240000, 1, 1})
    ->Args({240000, 1, 2})
    ->Args({60000, 10, 1})
    ->Args({60000, 10, 2})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK_CAPTURE(BM_Step, double, make_cpu_solver_double)
    ->ArgNames({"particles", "size_ratio", "threads"})
    ->Args({240000, 1, 1})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

/// Density and force of 2000 particles: the engine against its brute-force twin, one thread each.
void BM_Evaluate(benchmark::State& state, bool engine) {
  const Problem problem(2000, 1);
  const auto solver = problem.solver(make_cpu_solver);
  const BruteForce twin(problem.setup);
  if (largest_difference(solver->evaluate(), twin.evaluate()) > 1e-4) {
    state.SkipWithError("density or force differs from brute force");
    return;
  }
  for (auto _ : state) benchmark::DoNotOptimize(engine ? solver->evaluate() : twin.evaluate());
  per_particle(state, 2000);
}
BENCHMARK_CAPTURE(BM_Evaluate, float_engine, true)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_Evaluate, brute_force_double, false)->Unit(benchmark::kMillisecond)->UseRealTime();

/// 240 000 samples of blue noise, 25 iterations from white positions, all threads.
void BM_Relax25(benchmark::State& state) {
  const Problem problem(240000, 1);
  RelaxReport report;
  for (auto _ : state) {
    const auto solver = make_cpu_solver(problem.setup);
    report = solver->relax(25, false);
    benchmark::DoNotOptimize(solver->positions().data());
  }
  if (!(report.mean_displacement < 0.02) || report.non_finite > 0) state.SkipWithError("did not relax");
  per_particle(state, 240000.0 * 25);
}
BENCHMARK(BM_Relax25)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace abn::sph
