#include "sampling/emit_by_pixel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "sampling/rng.h"

namespace abn {
namespace {

TEST(EmitByPixel, GivesEverySampleOnceInPixelOrderAndBatches) {
  const Extent plane{7, 5};
  constexpr std::size_t count = (std::size_t{1} << 20) + 1000;
  std::vector<Vec2f> samples(count);
  for (std::size_t i = 0; i < count; ++i) samples[i] = to_plane(Rng(1, 2, i).uniform2(), plane);
  EmitByPixel emit;
  EXPECT_TRUE(emit.empty());
  EXPECT_TRUE(emit.next().empty());
  emit.assign(samples, plane);
  EXPECT_FALSE(emit.empty());
  std::vector<Vec2f> emitted;
  int batches = 0;
  for (SampleBatch batch = emit.next(); !batch.empty(); batch = emit.next(), ++batches) {
    EXPECT_LE(batch.position.size(), std::size_t{1} << 20);
    emitted.insert(emitted.end(), batch.position.begin(), batch.position.end());
  }
  EXPECT_EQ(batches, 2);
  EXPECT_TRUE(emit.next().empty());
  const auto pixel = [&](Vec2f p) {
    return static_cast<std::size_t>(p.y) * plane.width + static_cast<std::size_t>(p.x);
  };
  std::stable_sort(samples.begin(), samples.end(), [&](Vec2f a, Vec2f b) { return pixel(a) < pixel(b); });
  EXPECT_EQ(emitted, samples);
}

}  // namespace
}  // namespace abn
