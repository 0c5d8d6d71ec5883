// The passes of an adaptive plane on the device, without a device, bit for bit against the CPU's.
#include "sph_cuda/adaptive_engine.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sampling/adaptive/sph_adaptive.h"
#include "sph_cuda/host_device.h"
#include "sph_cuda/test_downscale.h"

namespace abn::sph_cuda {
namespace {

AdaptivePlaneFactory host_loop(LaunchOrder order) {
  const auto workspace = std::make_shared<AdaptiveWorkspace<HostDevice>>(HostDevice(order));
  return [workspace](const AdaptivePlaneOptions& options) {
    return std::make_unique<DeviceAdaptivePlane<HostDevice>>(options, workspace);
  };
}

const AdaptivePlaneFactory on_cpu = [](const AdaptivePlaneOptions& options) { return make_adaptive_plane(options); };

void expect_same(const Downscale& got, const Downscale& expected, const std::string& where) {
  EXPECT_EQ(got.position, expected.position) << where;
  EXPECT_EQ(got.uniform_share, expected.uniform_share) << where;
  EXPECT_EQ(got.straight_edge_share, expected.straight_edge_share) << where;
  EXPECT_EQ(got.ghosts, expected.ghosts) << where;
}

AdaptivePlaneOptions options_of(Extent plane) {
  AdaptivePlaneOptions options;
  options.plane = plane;
  options.map = {2 * plane.width, 2 * plane.height};
  options.floor = 0.02;
  options.delta = std::numeric_limits<float>::infinity();
  options.seed = 5;
  return options;
}

TEST(AdaptiveEngine, EqualsTheCpuBitForBit) {
  const Extent plane{48, 36};
  const std::uint64_t budget = 6 * plane.area();
  const std::vector<Vec2f> base = jittered_base(plane, budget / 4, 3);
  std::vector<std::pair<std::string, AdaptivePlaneOptions>> all;
  all.emplace_back("as sph_adaptive", options_of(plane));
  all.emplace_back("periodic, by pressure", options_of(plane));
  all.back().second.boundary = sph::Boundary::periodic;
  all.back().second.delta = 0.3F;
  all.emplace_back("both lights", options_of(plane));
  all.back().second.both_lights = true;
  all.back().second.light_share = 0.15;
  all.emplace_back("gradient, another exponent", options_of(plane));
  all.back().second.driver = Driver::gradient;
  all.back().second.exponent = 0.8;
  all.back().second.refine_activity = 0.5;
  all.emplace_back("guide, coarse map", options_of(plane));
  all.back().second.driver = Driver::guide;
  all.back().second.map = {19, 17};
  all.back().second.guide = std::make_shared<Grid<float>>(Extent{5, 4}, 0.5F);
  for (const auto& [name, options] : all) {
    const Downscale expected = run_downscale(on_cpu, options, base, budget);
    ASSERT_EQ(expected.position.size(), budget) << name;
    for (const LaunchOrder order : {LaunchOrder::forward, LaunchOrder::scattered}) {
      expect_same(run_downscale(host_loop(order), options, base, budget), expected, name);
    }
  }
}

TEST(AdaptiveEngine, AWorkspaceServesOnePlaneAfterTheOther) {
  const AdaptivePlaneFactory on_device = host_loop(LaunchOrder::backward);
  for (const Extent plane : {Extent{30, 30}, Extent{40, 20}, Extent{12, 50}}) {
    const std::uint64_t budget = 5 * plane.area();
    const std::vector<Vec2f> base = jittered_base(plane, budget / 3, 4);
    expect_same(run_downscale(on_device, options_of(plane), base, budget),
                run_downscale(on_cpu, options_of(plane), base, budget), std::to_string(plane.width) + " wide");
  }
}

TEST(AdaptiveEngine, AStrategyRunsOnIt) {
  SamplingTask task{.plane = {40, 30}, .budget = 7200, .seed = 2, .cache = false};
  std::vector<std::vector<Vec2f>> positions;
  std::vector<std::string> backends;
  for (const bool device : {false, true}) {
    if (device) task.adaptive_plane = host_loop(LaunchOrder::forward);
    SphAdaptive sampler(task, {});
    const Grid<PixelStats> unused(task.plane);
    std::vector<float> value;
    positions.emplace_back();
    for (;;) {
      const SampleBatch batch = sampler.next({unused, value, 3});
      if (batch.empty()) break;
      value = values_at(batch.position, task.plane);
      positions.back().insert(positions.back().end(), batch.position.begin(), batch.position.end());
    }
    for (const Diagnostic& d : sampler.diagnostics()) {
      if (d.name == "backend") backends.push_back(d.text);
    }
  }
  EXPECT_EQ(positions[1], positions[0]);
  ASSERT_EQ(backends.size(), 2U);
  EXPECT_NE(backends[0], "host loop");
  EXPECT_EQ(backends[1], "host loop");
}

}  // namespace
}  // namespace abn::sph_cuda
