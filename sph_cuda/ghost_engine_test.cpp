// The device's ring of ghosts without a device, bit for bit against the host's.
#include "sph_cuda/ghost_engine.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "sampling/sph/size_field_cases.h"
#include "sampling/sph/test_planes.h"
#include "sph_cuda/host_device.h"
#include "sph_cuda/size_field_engine.h"
#include "sph_cuda/test_device.h"

namespace abn::sph_cuda {
namespace {

struct Engines {
  explicit Engines(LaunchOrder order) : device(order) {}
  HostDevice device;
  SizeFieldEngine<HostDevice> sizes;
  GhostEngine<HostDevice> ring{device};
};

/// s without cells: no size field.
void expect_same(Engines& engines, const sph::Setup& setup, const Grid<float>& s, const std::string& where) {
  const bool sized = s.size().area() > 0;
  const sph::Problem expected = sph::make_problem(setup, setup.positions, sized ? &s : nullptr);
  sph::Problem problem = sph::problem_without_field(setup, setup.positions.size());
  const sph::FieldOptions options = sph::field_options(setup, problem);
  const sph::FieldCell* cells = nullptr;
  if (sized) {
    const auto copy = on_device(s);
    engines.sizes.prepare(engines.device, copy.data(), s.size(), options);
    sph::set_field(setup, engines.sizes.field(), engines.sizes.tile_density(), problem);
    cells = problem.field.uniform ? nullptr : engines.sizes.cells();
  } else {
    sph::set_field(setup, sph::uniform_size_field(options), {}, problem);
  }
  const std::uint32_t count = engines.ring.find(setup, problem, cells);
  ASSERT_EQ(count, expected.count() - expected.particles) << where;
  ASSERT_GT(count, 10U) << where;
  const HostMemory::Access access;
  std::size_t different = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    different += double{engines.ring.x()[i]} == expected.x[expected.particles + i] &&
                         double{engines.ring.y()[i]} == expected.y[expected.particles + i]
                     ? 0
                     : 1;
  }
  EXPECT_EQ(different, 0U) << where << " of " << count;
}

sph::Setup walled(Extent plane, const std::vector<Vec2f>& positions, int steps) {
  sph::Setup setup = sph::setup_of(plane, positions);
  setup.boundary = sph::Boundary::ghost;
  setup.background = false;
  setup.ghost_steps = steps;
  return setup;
}

/// One engine for all of them: what an earlier ring left behind must not matter.
TEST(GhostEngine, EqualsTheHostBitForBit) {
  Engines engines(LaunchOrder::forward);
  std::vector<std::string> words = {"", "smooth:100", "step:100"};
  for (const sph::SizeFieldCase& field : sph::size_field_cases()) words.push_back(field.name);
  for (const std::string& word : words) {
    for (const Extent plane : {Extent{40, 31}, Extent{9, 120}}) {
      const std::vector<Vec2f> positions = sph::white_positions(plane, 900);
      sph::Setup setup = walled(plane, positions, 3);
      setup.seed = plane.width;
      expect_same(engines, setup, word.empty() ? Grid<float>() : sph::make_size_field(word, {70, 52}),
                  word + " " + std::to_string(plane.width));
    }
  }
}

TEST(GhostEngine, EqualsTheHostForEverySetup) {
  Engines engines(LaunchOrder::forward);
  const Extent plane{30, 24};
  const Grid<float> fields[] = {Grid<float>(), sph::make_size_field("disc", {40, 40})};
  for (const Grid<float>& s : fields) {
    for (const std::uint64_t n : {1U, 3U, 400U}) {
      const std::vector<Vec2f> positions = sph::white_positions(plane, n);
      for (const float support : {1.0F, 2.5F}) {
        for (const float stiffness : {0.5F, std::numeric_limits<float>::infinity()}) {
          sph::Setup setup = walled(plane, positions, n == 3 ? 0 : 2);
          setup.support_radius = support;
          setup.stiffness_ratio = stiffness;
          setup.kernel = sph::Kernel::cubic;
          expect_same(engines, setup, s, std::to_string(n) + " H " + std::to_string(support));
        }
      }
    }
  }
}

TEST(GhostEngine, DoesNotDependOnTheOrderOfThreads) {
  const Extent plane{70, 50};
  const std::vector<Vec2f> positions = sph::white_positions(plane, 4000);
  for (const LaunchOrder order : {LaunchOrder::forward, LaunchOrder::backward, LaunchOrder::scattered}) {
    Engines engines(order);
    for (const char* word : {"constant", "ring"}) {
      expect_same(engines, walled(plane, positions, 4), sph::make_size_field(word, {140, 100}),
                  std::string(word) + " order " + std::to_string(static_cast<int>(order)));
    }
  }
}

}  // namespace
}  // namespace abn::sph_cuda
