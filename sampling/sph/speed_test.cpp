// Ratios of speed inside one process, with wide margins: a regression of several times fails, a busy machine does not.
#include <gtest/gtest.h>
#include <omp.h>

#include <string>
#include <vector>

#include "sampling/sph/solver.h"
#include "sampling/sph/test_pair_loops.h"
#include "sampling/sph/test_planes.h"

namespace abn::sph {
namespace {

#if defined(__SANITIZE_ADDRESS__) || !defined(NDEBUG)
constexpr bool optimised = false;
#elif defined(__OPTIMIZE__)
constexpr bool optimised = true;
#else
constexpr bool optimised = false;
#endif

std::vector<Vec2f> relaxed(Extent plane, std::uint64_t n) {
  const auto start = drawn_positions(plane, Grid<float>({1, 1}, 1.0F), n);
  const auto solver = make_cpu_solver(setup_of(plane, start));
  solver->relax(15, false);
  return {solver->positions().begin(), solver->positions().end()};
}

TEST(SphSpeed, VectorisedPairLoopsBeatScalarBodies) {
  const auto positions = relaxed({100, 100}, 20000);
  const Problem problem = make_problem(setup_of({100, 100}, positions), positions, nullptr);
  PairLoops loops(problem);
  loops.run_scalar();
  const std::vector<float> density = loops.density;
  const std::vector<float> force = loops.force_x;
  for (const InstructionSet set : {InstructionSet::baseline, best_instruction_set()}) {
    loops.run(set);
    EXPECT_EQ(loops.density, density);  // bit for bit: first right, then fast
    EXPECT_EQ(loops.force_x, force);
  }
  if (!optimised) GTEST_SKIP() << "not an optimised build";
  const double scalar = median_seconds(5, [&] { loops.run_scalar(); });
  const double baseline = median_seconds(7, [&] { loops.run(InstructionSet::baseline); });
  const double best = median_seconds(7, [&] { loops.run(best_instruction_set()); });
  RecordProperty("baseline_over_scalar", std::to_string(scalar / baseline));
  RecordProperty("best_over_scalar", std::to_string(scalar / best));
  EXPECT_GE(scalar / baseline, 1.5);
  if (best_instruction_set() == InstructionSet::avx2) {
    EXPECT_GE(scalar / best, 3.0);
  }
}

TEST(SphSpeed, SizeFieldCostsLessThanFourUniformPlanes) {
  if (!optimised) GTEST_SKIP() << "not an optimised build";
  const Extent plane{100, 100};
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const auto uniform_start = drawn_positions(plane, Grid<float>({1, 1}, 1.0F), 30000);
  const Grid<float> s = smooth_size_field({200, 200}, 10);
  const auto sized_start = drawn_positions(plane, s, 30000);
  const auto uniform = make_cpu_solver(setup_of(plane, uniform_start));
  const auto sized = make_cpu_solver(setup_of(plane, sized_start));
  sized->set_size_field(s);
  uniform->relax(10, false);
  sized->relax(10, false);
  const double of_uniform = median_seconds(9, [&] { uniform->relax(1, false); });
  const double of_sized = median_seconds(9, [&] { sized->relax(1, false); });
  omp_set_num_threads(threads);
  RecordProperty("sized_over_uniform", std::to_string(of_sized / of_uniform));
  EXPECT_LE(of_sized / of_uniform, 4.0);
}

}  // namespace
}  // namespace abn::sph
