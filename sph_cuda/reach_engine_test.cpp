// The device's reach without a device, against reach_by_block().
#include "sph_cuda/reach_engine.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sampling/rng.h"
#include "sph_cuda/host_device.h"
#include "sph_cuda/test_device.h"

namespace abn::sph_cuda {
namespace {

TEST(ReachEngine, EqualsTheHostsReach) {
  for (const LaunchOrder order : {LaunchOrder::forward, LaunchOrder::scattered}) {
    HostDevice device(order);
    ReachEngine<HostDevice> engine;
    for (const Extent size : {Extent{1, 1}, Extent{61, 34}, Extent{3, 200}, Extent{16, 16}, Extent{17, 15},
                              Extent{2, 1}, Extent{133, 90}}) {
      for (const float largest : {0.3F, 3.0F, 70.0F}) {  // the last one sees around the torus
        Grid<float> s(size);
        for (std::size_t i = 0; i < s.cells().size(); ++i) {
          const float u = Rng(12, stream_id("rough field"), i).uniform();
          s[i] = 0.1F + u * u * u * u;
        }
        s[size.area() / 3] = largest;
        for (const double support : {1.0, 2.5}) {
          const Grid<float> expected = sph::reach_by_block(s, 0.4, 0.6, support);
          const auto copy = on_device(s);
          engine.find(device, copy.data(), size, 0.4, 0.6, support);
          ASSERT_EQ(engine.blocks(), expected.size());
          EXPECT_TRUE(same_bits(engine.reach(), expected.cells().data(), expected.size().area()))
              << size.width << " x " << size.height << ", s up to " << largest << ", H " << support;
        }
      }
    }
  }
}

}  // namespace
}  // namespace abn::sph_cuda
