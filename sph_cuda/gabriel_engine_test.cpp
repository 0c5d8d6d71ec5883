// Refinement on a device without a device, bit for bit against gabriel_midpoints().
#include "sph_cuda/gabriel_engine.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "sampling/adaptive/gabriel.h"
#include "sampling/adaptive/nearest_samples.h"
#include "sph_cuda/test_device.h"

namespace abn::sph_cuda {
namespace {

class GabrielEngineTest : public ::testing::Test {
 protected:
  void expect_equal(const Samples& samples, std::uint32_t channels, Extent plane, std::size_t wanted,
                    const GabrielOptions& options, const std::vector<LaunchOrder>& orders) {
    const auto position = on_device(samples.position);
    const auto value = on_device(samples.value);
    const auto n = static_cast<std::uint32_t>(samples.position.size());
    const GabrielMidpoints expected =
        gabriel_midpoints(samples.position, samples.value, channels, plane, wanted, 7, options);
    for (const LaunchOrder order : orders) {
      HostDevice device(order);
      const GabrielMidpoints found =
          engine_.midpoints(device, position.data(), value.data(), n, channels, plane, wanted, 7, options);
      const std::string where = std::to_string(plane.width) + " wide, " + std::to_string(n) + " samples, " +
                                std::to_string(options.neighbours) + " neighbours, " + std::to_string(wanted) +
                                " wanted";
      EXPECT_EQ(found.pairs, expected.pairs) << where;
      EXPECT_TRUE(found.position == expected.position) << where;
    }
  }
  const std::vector<LaunchOrder> all_orders_{LaunchOrder::forward, LaunchOrder::backward, LaunchOrder::scattered};

 private:
  GabrielEngine<HostDevice> engine_;
};

TEST_F(GabrielEngineTest, EqualsGabrielMidpointsBitForBit) {
  for (const Extent plane : {Extent{40, 30}, Extent{3, 200}, Extent{1, 1}}) {
    for (const std::uint32_t n : {0U, 1U, 2U, 3U, 7U, 40U, 2500U}) {
      for (const std::uint32_t channels : {1U, 3U}) {
        const Samples samples = samples_of(plane, n, channels);
        expect_equal(samples, channels, plane, 0, {}, all_orders_);
        expect_equal(samples, channels, plane, 1, {}, all_orders_);
        expect_equal(samples, channels, plane, n / 5 + 2, {}, all_orders_);
        expect_equal(samples, channels, plane, n / 3, {.neighbours = 1, .floor = 0, .min_length = 0}, all_orders_);
        expect_equal(samples, channels, plane, 5 * n, {.neighbours = 31, .activity = 0.4}, all_orders_);
        expect_equal(samples, channels, plane, n, {.min_length = 0.4, .jitter = 0.5, .length_exponent = 1},
                     all_orders_);
      }
    }
  }
}

TEST_F(GabrielEngineTest, CoincidentSamples) {
  const Extent plane{20, 10};
  Samples samples = samples_of(plane, 400, 1);
  for (Vec2f& at : samples.position) at = {3.5F, 4.25F};
  expect_equal(samples, 1, plane, 50, {}, all_orders_);
  for (std::size_t i = 0; i < 400; i += 40) samples.position[i] = {static_cast<float>(i % 19), 2};
  expect_equal(samples, 1, plane, 50, {.activity = 1}, all_orders_);
}

// All pairs of a lattice are equally urgent: lots decide.
TEST_F(GabrielEngineTest, EqualPriorities) {
  Samples samples;
  for (int i = 0; i < 1600; ++i) {
    samples.position.push_back({static_cast<float>(i * 7 % 1600 % 40) + 0.5F, static_cast<float>(i * 7 % 1600 / 40)});
    samples.value.push_back(1);
  }
  for (const std::size_t wanted : {1U, 100U, 3000U, 4000U}) {
    expect_equal(samples, 1, {40, 40}, wanted, {}, all_orders_);
  }
}

TEST_F(GabrielEngineTest, HugeAndZeroDifferences) {
  Samples samples = samples_of({20, 20}, 600, 3);
  for (std::size_t i = 0; i < samples.value.size(); i += 7) samples.value[i] = i % 2 == 0 ? 3e38F : -3e38F;
  expect_equal(samples, 3, {20, 20}, 400, {}, all_orders_);
  for (float& v : samples.value) v = v < 0.3F ? 0.25F : 0.5F;
  expect_equal(samples, 3, {20, 20}, 900, {.floor = 0}, all_orders_);
}

// The sums of the standard deviation go over several chunks, the samples of an adapted plane get smaller cells.
TEST_F(GabrielEngineTest, RealSize) {
  const Extent plane{250, 240};
  Samples samples = samples_of(plane, 60'000, 3);
  EXPECT_GT(NearestSamples(samples.position, plane, 2).crowd(), 5);
  expect_equal(samples, 3, plane, 12'000, {}, {LaunchOrder::forward});
}

}  // namespace
}  // namespace abn::sph_cuda
