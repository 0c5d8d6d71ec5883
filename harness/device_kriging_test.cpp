// Reconstruction by the device's kernels without a device, bit for bit against the CPU's.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "harness/edge_reconstruction.h"
#include "harness/kriging.h"
#include "harness/reconstruction.h"
#include "harness/reconstruction_cases.h"
#include "sph_cuda/host_device.h"
#include "sph_cuda/kriging_engine.h"

namespace abn::harness {
namespace {

using sph_cuda::HostDevice;
using sph_cuda::LaunchOrder;

/// What backend.cpp does with a GPU's estimator.
EstimatePixels on_host_loop(LaunchOrder order, std::uint32_t pixels_at_once = 1U << 17U) {
  const auto engine = std::make_shared<sph_cuda::KrigingEngine<HostDevice>>(HostDevice(order));
  return estimate_kept([=](std::span<const Vec2f> position, std::span<const float> value, std::span<const float> weight,
                           std::uint32_t channels, Extent plane, bool steps) {
    return (*engine)(position, value, weight, channels, plane, steps, pixels_at_once);
  });
}

std::vector<std::uint32_t> bits_of(std::span<const float> values) {
  std::vector<std::uint32_t> bits(values.size());
  if (!values.empty()) std::memcpy(bits.data(), values.data(), values.size_bytes());
  return bits;
}

void expect_same(const Developed& device, const Developed& host, const std::string& where) {
  EXPECT_EQ(bits_of(device.image.texels), bits_of(host.image.texels)) << where;
  EXPECT_EQ(bits_of(device.standard_error.cells()), bits_of(host.standard_error.cells())) << where;
  EXPECT_EQ(device.empty_pixels, host.empty_pixels) << where;
  EXPECT_EQ(device.samples, host.samples) << where;
  EXPECT_EQ(device.max_samples_per_pixel, host.max_samples_per_pixel) << where;
}

/// A straight edge on a slope, and a texture that no step explains.
void colours(Vec2f p, float* value, std::uint32_t channels) {
  const float step = (0.3584F * p.x + 0.9336F * p.y > 7.37F ? 0.9F : 0.2F) + 0.003F * p.x;
  const std::array<float, 3> all{step, p.x > 8 ? std::sin(7 * p.x) * std::cos(5 * p.y) : 2 * step, 1 - step};
  for (std::uint32_t c = 0; c < channels; ++c) value[c] = all[c];
}

struct Case {
  std::string name;
  Extent plane;
  std::vector<Vec2f> position;
  std::vector<float> weight = {};
};

std::vector<Case> cases() {
  std::vector<Case> all;
  const Extent plane{12, 9};
  const auto spread = [&](std::size_t count, std::uint64_t seed) { return scattered(plane, count, seed); };
  all.push_back({"no sample", plane, {}});
  all.push_back({"one sample", plane, {{3.25F, 4.5F}}});
  all.push_back({"two samples", plane, {{0.5F, 0.5F}, {11.5F, 8.5F}}});
  all.push_back({"1 spp", plane, spread(plane.area(), 1)});
  all.push_back({"6 spp", plane, jittered(plane, 3, 2, 2)});
  all.push_back({"40 spp", {6, 8}, scattered({6, 8}, 40 * 6 * 8, 3)});
  all.push_back({"100 spp", {4, 3}, scattered({4, 3}, 100 * 4 * 3, 4)});

  std::vector<Vec2f> crowd = spread(6 * plane.area(), 5);
  for (const Vec2f p : scattered({1, 1}, 300, 6)) crowd.push_back(p + Vec2f{7, 5});
  all.push_back({"a crowded pixel", plane, crowd});

  std::vector<Vec2f> corner = scattered({4, 4}, 130, 7);
  all.push_back({"empty regions", {40, 30}, corner});

  std::vector<Vec2f> heaps;
  for (int k = 0; k < 400; ++k) heaps.push_back({static_cast<float>(k % 7) + 0.5F, static_cast<float>(k % 3) + 0.25F});
  for (int k = 0; k < 120; ++k) heaps.push_back({9.125F, 4.5F});  // on one place, more than count alone
  for (int k = 0; k < 60; ++k) heaps.push_back({10.1F, 4.5F});    // as far from a pixel, more than are kept
  all.push_back({"coincident samples", plane, heaps});

  Case weights{"weights", plane, spread(7 * plane.area(), 8)};
  for (std::size_t i = 0; i < weights.position.size(); ++i) {
    weights.weight.push_back(i % 4 == 0 ? 0.0F : (i % 9 == 0 ? -1.0F : 0.5F + 0.1F * static_cast<float>(i % 7)));
  }
  all.push_back(weights);
  all.push_back({"weights all 0", plane, spread(50, 9), std::vector<float>(50, 0.0F)});

  std::vector<Vec2f> outside = spread(5 * plane.area(), 10);
  for (int k = 0; k < 40; ++k) outside.push_back({-2.5F + static_cast<float>(k), k % 2 == 0 ? -0.125F : 9.0F});
  all.push_back({"samples outside", plane, outside});
  all.push_back({"one row", {40, 1}, scattered({40, 1}, 300, 11)});
  all.push_back({"one column", {1, 40}, scattered({1, 40}, 300, 12)});
  all.push_back({"one pixel", {1, 1}, scattered({1, 1}, 400, 13)});
  return all;
}

Film film_of_case(const Case& one, std::uint32_t channels) {
  std::vector<float> value(one.position.size() * channels);
  std::vector<std::uint32_t> pixel;  // the nearest one: a sample outside needs an owner
  const auto along = [](float at, std::uint32_t length) {
    return static_cast<std::uint32_t>(std::clamp(at, 0.0F, static_cast<float>(length) - 0.5F));
  };
  for (std::size_t i = 0; i < one.position.size(); ++i) {
    const Vec2f p = one.position[i];
    colours(p, value.data() + i * channels, channels);
    pixel.push_back(along(p.y, one.plane.height) * one.plane.width + along(p.x, one.plane.width));
  }
  Film film(one.plane, channels, true);
  film.add({one.position, one.weight, pixel}, value);
  return film;
}

TEST(DeviceKriging, EqualsTheHostBitForBitInEveryLaunchOrder) {
  const std::array devices{on_host_loop(LaunchOrder::forward), on_host_loop(LaunchOrder::backward),
                           on_host_loop(LaunchOrder::scattered)};
  for (const Case& one : cases()) {
    for (const std::uint32_t channels : {1U, 3U}) {
      const Film film = film_of_case(one, channels);
      const Developed host = kriging(film);
      const Developed host_edge = edge(film);
      for (std::size_t k = 0; k < (channels == 3 ? devices.size() : 1); ++k) {
        const std::string where = one.name + ", " + std::to_string(channels) + " channels, order " + std::to_string(k);
        expect_same(kriging(film, devices[k]), host, where);
        expect_same(edge(film, devices[k]), host_edge, where + ", edge");
      }
    }
  }
}

TEST(DeviceKriging, DoesNotDependOnHowManyPixelsAreSolvedAtOnce) {
  for (const Case& one : cases()) {
    const Film film = film_of_case(one, 1);
    const Developed host_edge = edge(film);
    for (const std::uint32_t at_once : {1U, 37U}) {
      const EstimatePixels device = on_host_loop(LaunchOrder::forward, at_once);
      expect_same(edge(film, device), host_edge, one.name + ", edge");
    }
  }
}

void expect_same_step(const PixelStep& device, const PixelStep& host, const std::string& where) {
  EXPECT_EQ(device.found, host.found) << where;
  const auto numbers = [](const PixelStep& s) {
    return bits_of(std::array{s.threshold, s.jump[0], s.jump[1], s.jump[2], s.luminance_jump, s.share, s.share_error});
  };
  EXPECT_EQ(numbers(device), numbers(host)) << where;
}

/// Steps under every angle, so that many of them need finer angles, smaller windows or both.
void stripes(Vec2f p, float* value) {
  const float angle = 0.05F * std::floor(p.x / 3) + 0.31F * std::floor(p.y / 3);
  const float along = std::cos(angle) * p.x + std::sin(angle) * p.y;
  const float height = 1 + std::floor(p.x / 4);
  value[0] = along - 1.7F * std::floor(along / 1.7F) < 0.8F ? 0.1F * height : 0.2F;
  value[1] = value[0] + 0.01F * p.y;
  value[2] = 1 - value[0] * value[0];
}

TEST(DeviceKriging, FindsTheSameStepsInEveryLaunchOrder) {
  const Extent plane{20, 15};
  std::vector<std::vector<Vec2f>> sets{jittered(plane, 3, 2, 20), jittered(plane, 5, 4, 21),
                                       scattered(plane, 9 * plane.area(), 22)};
  for (const Vec2f p : scattered({1, 1}, 300, 23)) sets[0].push_back(p + Vec2f{11, 9});
  for (std::size_t k = 0; k < sets.size(); ++k) {
    const Film film = film_of(plane, 3, sets[k], stripes);
    const Grid<PixelStep> host = find_steps(SampleBins(film));
    int found = 0;
    for (const PixelStep& step : host.cells()) found += static_cast<int>(step.found);
    EXPECT_GT(found, 20);
    for (const LaunchOrder order : {LaunchOrder::forward, LaunchOrder::backward, LaunchOrder::scattered}) {
      const PixelEstimates device = on_host_loop(order)(film, true);
      ASSERT_EQ(device.step.size(), plane);
      for (std::size_t p = 0; p < plane.area(); ++p) {
        expect_same_step(device.step[p], host[p], std::to_string(k) + ", pixel " + std::to_string(p));
      }
    }
  }
}

TEST(DeviceKriging, SortsByPhasesWhateverTheNumber) {
  for (std::uint32_t n = 0; n < 140; ++n) {
    std::vector<float> value;
    for (std::uint32_t i = 0; i < n; ++i) value.push_back(std::floor(50 * Rng(30, n, i).uniform()));
    std::vector<float> sorted = value;
    std::sort(sorted.begin(), sorted.end());
    for (int phase = 0; phase < sph_cuda::SortingNetwork::phases(n + n % 3); ++phase) {
      for (std::uint32_t thread = 0; thread < 7; ++thread) {
        sph_cuda::SortingNetwork::run(phase, value.data(), n, thread, 7);
      }
    }
    EXPECT_EQ(value, sorted);
  }
}

TEST(DeviceKriging, TheTableHandsTheDeviceToRowsThatUseIt) {
  const Film film = film_of_case(cases()[4], 3);
  EXPECT_FALSE(estimate_kept(nullptr));
  int asked = 0;
  const EstimatePixels on_device = [&, device = on_host_loop(LaunchOrder::forward)](const Film& given, bool steps) {
    ++asked;
    return device(given, steps);
  };
  expect_same(find_reconstruction("kriging").develop(film, on_device), kriging(film), "kriging");
  expect_same(find_reconstruction("edge").develop(film, on_device), edge(film), "edge");
  EXPECT_EQ(asked, 2);
  for (const char* name : {"mean", "density", "voronoi", "kriging_tonemapped"}) {
    expect_same(find_reconstruction(name).develop(film, on_device), find_reconstruction(name).develop(film), name);
  }
  EXPECT_EQ(asked, 2);
}

}  // namespace
}  // namespace abn::harness
