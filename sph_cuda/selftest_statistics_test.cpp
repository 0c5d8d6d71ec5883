// The comparisons that abn_selftest makes on a GPU, here between the CPU and the host loop, and with an engine that is
// wrong.
#include "sph_cuda/selftest_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "sph_cuda/adaptive_engine.h"
#include "sph_cuda/engine.h"
#include "sph_cuda/host_device.h"
#include "sph_cuda/kriging_engine.h"

namespace abn::sph_cuda {
namespace {

std::unique_ptr<sph::Solver> host_loop(const sph::Setup& setup) {
  return std::make_unique<DeviceSolver<HostDevice>>(setup, HostDevice());
}

TEST(SelftestStatistics, AreTheSameForTheSameSets) {
  EXPECT_TRUE(run_statistics(sph::make_cpu_solver, host_loop, 3, {15, 15}));
}

TEST(SelftestStatistics, TellAnEngineThatIsWrong) {
  EXPECT_FALSE(run_statistics(sph::make_cpu_solver,
                              [](const sph::Setup& setup) {
                                sph::Setup wrong = setup;
                                wrong.support_radius *= 1.25F;
                                return sph::make_cpu_solver(wrong);
                              },
                              5, {20, 20}));
}

TEST(SelftestStatistics, CompareDownscales) {
  const AdaptivePlaneFactory on_cpu = [](const AdaptivePlaneOptions& options) { return make_adaptive_plane(options); };
  const auto workspace = std::make_shared<AdaptiveWorkspace<HostDevice>>();
  const AdaptivePlaneFactory on_device = [&](const AdaptivePlaneOptions& options) {
    return std::make_unique<DeviceAdaptivePlane<HostDevice>>(options, workspace);
  };
  EXPECT_TRUE(run_adaptive_tests(on_cpu, on_device, 2, {32, 32}));
  const AdaptivePlaneFactory wrong = [](AdaptivePlaneOptions options) {
    options.exponent = 0.1;
    return make_adaptive_plane(options);
  };
  EXPECT_FALSE(run_adaptive_tests(on_cpu, wrong, 3, {32, 32}));
}

TEST(SelftestStatistics, ComparePictures) {
  const SampleEstimator on_device = [](auto... given) { return KrigingEngine<HostDevice>()(given...); };
  EXPECT_TRUE(run_picture_tests(on_device, on_device, {24, 24}));
  const SampleEstimator wrong = [](auto... given) {
    PixelEstimates estimates = KrigingEngine<HostDevice>()(given...);
    estimates.value[5] = NAN;
    estimates.value[50] += 0.01F;  // two of 1728 are more than one in a thousand
    return estimates;
  };
  EXPECT_FALSE(run_picture_tests(on_device, wrong, {24, 24}));
}

}  // namespace
}  // namespace abn::sph_cuda
