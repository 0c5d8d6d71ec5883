#include "sampling/adaptive/straight_edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "sampling/rng.h"

namespace abn {
namespace {

/// 16 x 16 pixels of 25 jittered samples each.
double share_of(const std::function<float(Vec2f)>& image) {
  const Extent plane{16, 16};
  std::vector<Vec2f> position;
  std::vector<float> value;
  for (std::uint32_t y = 0; y < 80; ++y) {
    for (std::uint32_t x = 0; x < 80; ++x) {
      const Vec2f u = Rng(5, stream_id("straight_edges_test"), std::uint64_t{y} * 80 + x).uniform2();
      position.push_back({(static_cast<float>(x) + u.x) / 5, (static_cast<float>(y) + u.y) / 5});
      value.push_back(image(position.back()));
    }
  }
  return straight_edge_share(position, value, 1, plane);
}

TEST(StraightEdges, OneEdgeIsAllThereIs) {
  // Most pixels that it crosses hold three samples on either side; the rest are too close to a corner to count.
  EXPECT_GT(share_of([](Vec2f p) { return p.x + 0.3F * p.y > 9.4F ? 1.0F : 0.0F; }), 0.75);
}

TEST(StraightEdges, NoiseRampsAndCheckersHaveNone) {
  EXPECT_LT(share_of([](Vec2f p) { return Rng(1, 2, static_cast<std::uint64_t>(p.x * 1e5F + p.y * 77)).uniform(); }),
            0.01);
  EXPECT_LT(share_of([](Vec2f p) { return p.x / 16; }), 0.01);
  EXPECT_LT(share_of([](Vec2f p) {
              return (static_cast<int>(p.x * 2.5F) + static_cast<int>(p.y * 2.5F)) % 2 == 0 ? 1.0F : 0.0F;
            }),
            0.3);
}

TEST(StraightEdges, NothingVaries) {
  EXPECT_EQ(share_of([](Vec2f) { return 0.5F; }), 0);
  EXPECT_EQ(straight_edge_share({}, {}, 1, {4, 4}), 0);
}

TEST(StraightEdges, SamplesOnALineAndCoincidentSamples) {
  const std::vector<Vec2f> line = {{.1F, .5F}, {.2F, .5F}, {.3F, .5F}, {.4F, .5F}, {.45F, .5F}, {.5F, .5F},
                                   {.6F, .5F}, {.7F, .5F}, {.8F, .5F}, {.9F, .5F}, {.95F, .5F}};
  const std::vector<float> step = {0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1};
  EXPECT_EQ(straight_edge_share(line, step, 1, {1, 1}), 1);
  const std::vector<Vec2f> same(11, Vec2f{.5F, .5F});
  EXPECT_EQ(straight_edge_share(same, step, 1, {1, 1}), 0);
}

}  // namespace
}  // namespace abn
