// The share of straight edges on a device without a device, bit for bit against straight_edge_share().
#include "sph_cuda/straight_edge_engine.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "sampling/adaptive/straight_edges.h"
#include "sampling/rng.h"
#include "sph_cuda/test_device.h"

namespace abn::sph_cuda {
namespace {

struct Samples {
  std::vector<Vec2f> position;
  std::vector<float> value;
};

/// Some of them crowded in a corner, some at the same place.
Samples samples_of(Extent plane, std::uint32_t n, std::uint32_t channels, const std::function<float(Vec2f)>& image) {
  Samples samples;
  for (std::uint32_t i = 0; i < n; ++i) {
    Vec2f at = to_plane(Rng(5, 6, i).uniform2(), plane);
    if (i % 9 == 0) at = at * 0.02F;
    if (i % 50 == 1) at = {static_cast<float>(plane.width) / 2, 0.5F};
    samples.position.push_back(at);
    for (std::uint32_t c = 0; c < channels; ++c) samples.value.push_back(image(at) + 0.1F * static_cast<float>(c));
  }
  return samples;
}

/// What the host finds, after comparing.
double expect_equal(const Samples& samples, std::uint32_t channels, Extent plane) {
  const auto position = on_device(samples.position);
  const auto value = on_device(samples.value);
  const auto n = static_cast<std::uint32_t>(samples.position.size());
  const double expected = straight_edge_share(samples.position, samples.value, channels, plane);
  StraightEdgeEngine<HostDevice> engine;
  for (const LaunchOrder order : {LaunchOrder::forward, LaunchOrder::backward, LaunchOrder::scattered}) {
    HostDevice device(order);
    EXPECT_EQ(engine.share(device, position.data(), value.data(), n, channels, plane), expected)
        << plane.width << " wide, " << n << " samples, " << channels << " channels";
  }
  return expected;
}

TEST(StraightEdgeEngine, EqualsStraightEdgeShareBitForBit) {
  const auto step = [](Vec2f p) { return p.x + 0.3F * p.y > 9.4F ? 1.0F : 0.0F; };
  const auto noisy_step = [&](Vec2f p) {
    return step(p) + 0.1F * Rng(1, 2, static_cast<std::uint64_t>(p.x * 1e5F + p.y * 77)).uniform();
  };
  const auto rings = [](Vec2f p) { return static_cast<int>(p.x * p.x + p.y * p.y) % 9 < 3 ? 3e38F : -3e38F; };
  for (const Extent plane : {Extent{16, 16}, Extent{70, 40}, Extent{1, 1}}) {
    for (const std::uint32_t n : {0U, 1U, 9U, 40U, 4000U, 20'000U}) {
      for (const std::uint32_t channels : {1U, 3U}) {
        if (n / plane.area() > 1000) continue;
        const double share = expect_equal(samples_of(plane, n, channels, step), channels, plane);
        if (plane.width == 16 && n == 20'000) {
          EXPECT_GT(share, 0.5);
          EXPECT_LT(share, 1);
        }
        expect_equal(samples_of(plane, n, channels, noisy_step), channels, plane);
        expect_equal(samples_of(plane, n, channels, rings), channels, plane);
        EXPECT_EQ(expect_equal(samples_of(plane, n, channels, [](Vec2f) { return 0.5F; }), channels, plane), 0);
      }
    }
  }
}

TEST(StraightEdgeEngine, SamplesOnALineAndCoincidentSamples) {
  Samples line;
  for (int k = 0; k < 11; ++k) {
    line.position.push_back({0.1F + 0.07F * static_cast<float>(k), .5F});
    line.value.push_back(k < 5 ? 0.0F : 1.0F);
  }
  EXPECT_EQ(expect_equal(line, 1, {1, 1}), 1);
  for (Vec2f& at : line.position) at = {.5F, .5F};
  EXPECT_EQ(expect_equal(line, 1, {1, 1}), 0);
}

}  // namespace
}  // namespace abn::sph_cuda
