// The device's engine without a device: every kernel of every step in a loop over blocks and threads, bit for bit
// against the CPU engine, in several orders. The sanitizer build runs the same on arrays of exactly their size.
#include "sph_cuda/engine.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sampling/adaptive/sph_adaptive.h"
#include "sampling/adaptive/sph_adaptive_thesis.h"
#include "sampling/error.h"
#include "sampling/sph/test_engines.h"
#include "sampling/sph_blue_noise.h"
#include "sph_cuda/host_device.h"

namespace abn::sph_cuda {
namespace {

using sph::Boundary;
using sph::Kernel;

sph::SolverFactory host_loop(LaunchOrder order) {
  return
      [order](const sph::Setup& setup) { return std::make_unique<DeviceSolver<HostDevice>>(setup, HostDevice(order)); };
}

/// What the engine says after so many steps more.
sph::Outcome after(sph::Solver& solver, int steps) {
  sph::Outcome result;
  result.report = solver.relax(steps, false);
  const auto positions = solver.positions();
  result.positions.assign(positions.begin(), positions.end());
  result.state = solver.evaluate();
  return result;
}

TEST(DeviceSolver, EqualsTheCpuEngineBitForBit) {
  for (const auto& planes : {sph::all_planes(130), sph::odd_planes()}) {
    for (const sph::Plane& plane : planes) {
      expect_same(outcome(plane, sph::make_cpu_solver, 6), outcome(plane, host_loop(LaunchOrder::forward), 6),
                  plane.name);
    }
  }
}

TEST(DeviceSolver, DoesNotDependOnTheOrderOfThreads) {
  std::vector<sph::Plane> planes = {sph::make_plane({100, 61}, 9500, "", Kernel::wendland, Boundary::periodic),
                                    sph::make_plane({100, 61}, 9500, "step", Kernel::wendland, Boundary::periodic),
                                    sph::make_plane({100, 61}, 9500, "smooth", Kernel::poly6_spiky, Boundary::ghost),
                                    sph::make_plane({100, 61}, 9500, "", Kernel::wendland, Boundary::periodic)};
  for (std::size_t i = 0; i < 9500; ++i) planes.back().classes.push_back(static_cast<std::uint8_t>(i % 3));
  for (const sph::Plane& plane : planes) {
    const sph::Outcome cpu = outcome(plane, sph::make_cpu_solver, 3);
    for (const LaunchOrder order : {LaunchOrder::forward, LaunchOrder::backward, LaunchOrder::scattered}) {
      expect_same(cpu, outcome(plane, host_loop(order), 3),
                  plane.name + " order " + std::to_string(static_cast<int>(order)));
    }
  }
}

TEST(DeviceSolver, SumsInSeveralLevelsAsTheCpuEngine) {
  // More than 1024 chunks of 1024: three levels of sums. Without a step, which would take long here.
  const Extent extent{1100, 1000};
  const std::vector<Vec2f> positions = sph::white_positions(extent, 1'100'000);
  const auto setup = sph::setup_of(extent, positions);
  const auto cpu = sph::make_cpu_solver(setup);
  const auto device = host_loop(LaunchOrder::forward)(setup);
  EXPECT_EQ(cpu->relax(1, false).mean_density, device->relax(1, false).mean_density);
}

TEST(DeviceSolver, ManyParticlesAtOnePlace) {
  sph::Plane plane = sph::make_plane({20, 17}, 300, "", Kernel::wendland, Boundary::periodic);
  for (std::size_t i = 0; i < 200; ++i) plane.positions[i] = {3, 4};  // one cell: sorted by heap
  for (const LaunchOrder order : {LaunchOrder::forward, LaunchOrder::scattered}) {
    expect_same(outcome(plane, sph::make_cpu_solver, 4), outcome(plane, host_loop(order), 4), "one place");
  }
}

TEST(DeviceSolver, FrozenParticlesStayAndCount) {
  for (const char* field : {"", "smooth"}) {
    for (const float stiffness : {0.3F, std::numeric_limits<float>::infinity()}) {
      sph::Plane plane = sph::make_plane({40, 30}, 1500, field, Kernel::wendland, Boundary::ghost);
      plane.setup.stiffness_ratio = stiffness;
      std::vector<sph::Outcome> outcomes;
      for (const sph::SolverFactory& make :
           {sph::SolverFactory(sph::make_cpu_solver), host_loop(LaunchOrder::forward)}) {
        const auto solver = start(plane, make);
        const std::vector<std::uint32_t> held = {3, 5, 700};
        solver->freeze(held);
        solver->relax(3, false);
        const std::vector<std::uint32_t> more = {9, 10, 11};
        solver->freeze(more);
        outcomes.push_back(after(*solver, 4));
      }
      expect_same(outcomes[0], outcomes[1], plane.name);
      EXPECT_GT(outcomes[1].report.mean_displacement, 0);
    }
  }
}

TEST(DeviceSolver, TakesAnotherSizeFieldWhereItIs) {
  for (const bool background : {false, true}) {  // on the device, and through the host
    for (const Boundary boundary : {Boundary::periodic, Boundary::ghost}) {
      sph::Plane plane = sph::make_plane({40, 30}, 1500, "", Kernel::wendland, boundary);
      plane.setup.background = background;
      std::vector<sph::Outcome> outcomes;
      std::vector<std::vector<Vec2f>> rings;
      for (const sph::SolverFactory& make :
           {sph::SolverFactory(sph::make_cpu_solver), host_loop(LaunchOrder::scattered)}) {
        const auto solver = start(plane, make);
        const std::vector<std::uint32_t> held = {3, 5, 700};
        solver->freeze(held);
        for (const double ratio : {10.0, 1.0, 3.0}) {
          solver->relax(3, false);
          solver->set_size_field(sph::smooth_size_field({50, 40}, ratio));
        }
        outcomes.push_back(after(*solver, 4));
        const auto ring = solver->ghosts();
        rings.emplace_back(ring.begin(), ring.end());
        EXPECT_THROW(solver->set_size_field(Grid<float>({3, 3}, -1.0F)), ConfigError);
      }
      expect_same(outcomes[0], outcomes[1], background ? "background" : "no background");
      EXPECT_EQ(rings[0], rings[1]);
      EXPECT_EQ(rings[0].empty(), boundary == Boundary::periodic);
    }
  }
}

TEST(DeviceSolver, StopsWhereTheCpuEngineStops) {
  // Between the batches of steps, at their ends, and by convergence.
  const sph::Plane plane = sph::make_plane({40, 30}, 1500, "", Kernel::wendland, Boundary::periodic);
  for (const int steps : {0, 1, 7, 8, 9, 16, 200}) {
    const auto cpu = start(plane, sph::make_cpu_solver);
    const auto device = start(plane, host_loop(LaunchOrder::forward));
    const sph::RelaxReport a = cpu->relax(steps, true);
    const sph::RelaxReport b = device->relax(steps, true);
    EXPECT_EQ(a.steps, b.steps);
    EXPECT_EQ(a.converged, b.converged);
    EXPECT_EQ(a.mean_displacement, b.mean_displacement);
    EXPECT_EQ(a.mean_converged_at, b.mean_converged_at);
    EXPECT_EQ(a.every_converged_at, b.every_converged_at);
    EXPECT_EQ(a.step, b.step);
    EXPECT_EQ(std::vector<Vec2f>(cpu->positions().begin(), cpu->positions().end()),
              std::vector<Vec2f>(device->positions().begin(), device->positions().end()));
  }
}

struct Emitted {
  std::vector<Vec2f> position;
  std::string backend;
};

Emitted emit(const Strategy& strategy, const SamplingTask& task, const ParameterWords& words = {}) {
  Emitted all;
  const Grid<PixelStats> unused(task.plane);
  std::vector<float> values;
  const auto sampler = strategy.make(task, words);
  for (;;) {
    const SampleBatch batch = sampler->next({unused, values});
    if (batch.empty()) break;
    values.clear();
    for (const Vec2f p : batch.position) values.push_back(p.x + 0.2F * p.y > 17.3F ? 1.0F : 0.0F);
    all.position.insert(all.position.end(), batch.position.begin(), batch.position.end());
  }
  for (const Diagnostic& diagnostic : sampler->diagnostics()) {
    if (diagnostic.name == "backend") all.backend = diagnostic.text;
  }
  return all;
}

TEST(DeviceSolver, StrategiesRunOnIt) {
  SamplingTask task{.plane = {30, 20}, .budget = 3000, .seed = 5, .cache = false};
  const std::pair<Strategy, ParameterWords> all[] = {{row<SphBlueNoise>(), {}},
                                                     {row<SphAdaptive>(), {}},
                                                     {row<SphAdaptive>(), {{"delta", "0.3"}}},
                                                     {row<SphAdaptiveThesis>(), {}}};
  for (const auto& [strategy, words] : all) {
    task.solver = nullptr;
    const Emitted on_cpu = emit(strategy, task, words);
    task.solver = host_loop(LaunchOrder::backward);
    const Emitted on_device = emit(strategy, task, words);
    EXPECT_EQ(on_device.position, on_cpu.position) << strategy.info.name;
    EXPECT_EQ(on_device.backend, "host loop") << strategy.info.name;
  }
}

}  // namespace
}  // namespace abn::sph_cuda
