// The device's maps without a device, bit for bit against the CPU's.
#include "sph_cuda/map_engine.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sampling/adaptive/allocation.h"
#include "sampling/adaptive/drivers.h"
#include "sampling/adaptive/local_variance.h"
#include "sph_cuda/test_device.h"

namespace abn::sph_cuda {
namespace {

using Map = HostDevice::Buffer<float>;

std::vector<float> values_of(const Grid<float>& map) { return {map.cells().begin(), map.cells().end()}; }
std::vector<float> values_of(const Map& map) { return map.download(map.size()); }

/// Mostly 0, with a few steep hills.
Grid<float> hills(Extent size, std::uint64_t seed) {
  Grid<float> map(size);
  for (std::uint64_t i = 0; i < size.area(); ++i) {
    const float u = Rng(seed, 1, i).uniform();
    map[i] = u < 0.6F ? 0 : u * u * (i % 97 == 0 ? 50.0F : 0.3F);
  }
  return map;
}

class MapEngineTest : public testing::TestWithParam<LaunchOrder> {
 protected:
  HostDevice device{GetParam()};
  const std::vector<Extent> sizes = {{1, 1}, {1, 40}, {33, 1}, {60, 47}, {90, 33}};
};

TEST_P(MapEngineTest, BlursAsTheHost) {
  for (const Extent size : sizes) {
    Grid<float> map = hills(size, 3);
    Map copy = on_device(map);
    MapEngine<HostDevice> engine(device);
    engine.reset(size, size);
    engine.blur(copy.data(), 3);
    blur(map, 3);
    EXPECT_EQ(values_of(copy), values_of(map)) << size.width << "x" << size.height;
  }
}

TEST_P(MapEngineTest, WeighsAndMixesAsTheHost) {
  for (const Extent size : sizes) {
    MapEngine<HostDevice> engine(device);
    engine.reset(size, size);
    const Grid<float> nothing(size, 0.0F);
    for (const Grid<float>& a : {hills(size, 4), nothing}) {
      const Grid<float> b = hills(size, 5);
      Map copy_a = on_device(a);
      const Map copy_b = on_device(b);
      EXPECT_EQ(engine.uniform_share(copy_a.data()), uniform_share(a));
      for (const double exponent : {0.5, 0.8}) {
        Map weight = on_device(nothing);
        engine.weigh(copy_a.data(), 0.02, exponent, weight.data());
        EXPECT_EQ(values_of(weight), values_of(density_weights(a, 0.02, exponent)));
      }
      engine.mix(copy_a.data(), copy_b.data(), 0.5, 0.15);
      EXPECT_EQ(values_of(copy_a), values_of(both_drivers(a, b, 0.5, 0.15)));
    }
  }
}

TEST_P(MapEngineTest, AllocatesAsTheHost) {
  for (const Extent size : sizes) {
    const Extent plane{size.width, 2 * size.height};
    MapEngine<HostDevice> engine(device);
    engine.reset(plane, size);
    Grid<float> have = hills(size, 6);
    for (float& h : have.cells()) h += 0.5F;
    const Map have_copy = on_device(have);
    for (const Grid<float>& weight : {hills(size, 7), Grid<float>(size, 0.0F), Grid<float>(size, 1.0F)}) {
      const Map weight_copy = on_device(weight);
      // Less than there is, some more, and more than fits.
      for (const double per_pixel : {0.1, 2.0, 9.0, 1e6}) {
        const double total = per_pixel * static_cast<double>(plane.area());
        Map density = on_device(weight);
        engine.allocate(weight_copy.data(), have_copy.data(), total, 40, density.data());
        EXPECT_EQ(values_of(density), values_of(allocate(weight, have, total, 40, plane)))
            << size.width << "x" << size.height << ", " << per_pixel;
      }
    }
  }
}

TEST_P(MapEngineTest, DrawsAsTheHost) {
  for (const Extent size : sizes) {
    const Extent plane{3 * size.width, size.height};
    MapEngine<HostDevice> engine(device);
    engine.reset(plane, size);
    const Grid<float> wanted = hills(size, 8);
    const Map wanted_copy = on_device(wanted);
    for (const Grid<float>& have : {hills(size, 9), wanted}) {  // the same: nothing is missing anywhere
      const Map have_copy = on_device(have);
      for (const std::uint64_t count : {1U, 17U, 5000U}) {
        HostDevice::Buffer<Vec2f> points;
        points.reset(count);
        engine.draw(wanted_copy.data(), have_copy.data(), count, 11, 12, points.data());
        EXPECT_EQ(points.download(count), draw_deficit(wanted, have, count, plane, 11, 12))
            << size.width << "x" << size.height << ", " << count;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(InAnyOrder, MapEngineTest,
                         testing::Values(LaunchOrder::forward, LaunchOrder::backward, LaunchOrder::scattered));

}  // namespace
}  // namespace abn::sph_cuda
