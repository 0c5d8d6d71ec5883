// The device's variance map without a device, bit for bit against local_variance().
#include "sph_cuda/variance_engine.h"

#include <gtest/gtest.h>

#include <vector>

#include "sampling/adaptive/local_variance.h"
#include "sph_cuda/test_device.h"

namespace abn::sph_cuda {
namespace {

std::vector<float> values_of(const Grid<float>& map) { return {map.cells().begin(), map.cells().end()}; }

TEST(VarianceEngine, EqualsLocalVarianceBitForBit) {
  VarianceEngine<HostDevice> engine;
  for (const Extent plane : {Extent{40, 30}, Extent{3, 200}, Extent{1, 1}}) {
    for (const std::uint32_t n : {0U, 1U, 2U, 7U, 100U, 5000U}) {
      for (const std::uint32_t channels : {1U, 3U}) {
        const Samples samples = samples_of(plane, n, channels);
        for (const int neighbours : {1, 2, 8, 32}) {
          const Extent map{2 * plane.width, 2 * plane.height};
          const std::vector<float> expected =
              values_of(local_variance(samples.position, samples.value, channels, plane, map, neighbours));
          for (const LaunchOrder order : {LaunchOrder::forward, LaunchOrder::scattered}) {
            HostDevice device(order);
            EXPECT_EQ(values_of(engine(device, samples.position, samples.value, channels, plane, map, neighbours)),
                      expected)
                << plane.width << " wide, " << n << " samples, " << neighbours << " neighbours";
          }
        }
      }
    }
  }
}

TEST(VarianceEngine, LeavesItsResultOnTheDevice) {
  const Samples samples = samples_of({30, 20}, 900, 3);
  HostDevice device(LaunchOrder::backward);
  const auto position = on_device(samples.position);
  const auto value = on_device(samples.value);
  HostDevice::Buffer<float> variance;
  variance.reset(30 * 20);
  VarianceEngine<HostDevice> engine;
  engine.find(device, position.data(), value.data(), 900, 3, {30, 20}, {30, 20}, 8, variance.data());
  EXPECT_EQ(variance.download(30 * 20),
            values_of(local_variance(samples.position, samples.value, 3, {30, 20}, {30, 20}, 8)));
}

TEST(VarianceEngine, HugeValuesStayFinite) {
  Samples samples = samples_of({20, 20}, 500, 1);
  for (std::size_t i = 0; i < samples.value.size(); i += 3) samples.value[i] = i % 2 == 0 ? 1e30F : -1e30F;
  HostDevice device;
  VarianceEngine<HostDevice> engine;
  EXPECT_EQ(values_of(engine(device, samples.position, samples.value, 1, {20, 20}, {40, 40}, 8)),
            values_of(local_variance(samples.position, samples.value, 1, {20, 20}, {40, 40}, 8)));
}

}  // namespace
}  // namespace abn::sph_cuda
