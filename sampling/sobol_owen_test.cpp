#include "sampling/sobol_owen.h"

#include <gtest/gtest.h>

#include "sampling/draw_for_tests.h"
#include "sampling/sobol2d.h"

namespace abn {
namespace {

TEST(SobolOwen, EveryPowerOfTwoPerPixelIsANet) {
  const Extent plane{9, 7};
  for (unsigned m = 0; m <= 8; ++m) {
    for (const auto& pixel : by_pixel(draw<SobolOwen>(plane, plane.area() << m, m), plane)) {
      ASSERT_TRUE(is_zero_net(pixel, m)) << m;
    }
  }
}

TEST(SobolOwen, EveryAlignedBlockOfASetIsANet) {
  const auto points = draw<SobolOwen>({1, 1}, 4096, 3);
  for (unsigned m = 0; m <= 12; ++m) {
    const auto size = std::ptrdiff_t{1} << m;
    for (auto start = points.begin(); start != points.end(); start += size) {
      ASSERT_TRUE(is_zero_net(std::vector<Vec2f>(start, start + size), m)) << m;
    }
  }
}

TEST(SobolOwen, HoldsOnThePlaneAcrossBatches) {
  auto positions = draw<SobolOwen>({256, 64}, std::uint64_t{1} << 22, 1, {.domain = "plane"});
  for (Vec2f& p : positions) p = {p.x / 256, p.y / 64};
  for (unsigned a = 7; a <= 15; ++a) {
    EXPECT_TRUE(cells_equally_filled(positions, std::size_t{1} << a, std::size_t{1} << (22 - a))) << a;
  }
}

TEST(SobolOwenPoints, VectorLoopMatchesTheDefinition) {
  std::vector<UnitPoint> points(1003);
  sobol_owen_points(77, 0xDEADBEEFU, 0x12345678U, points);
  for (std::uint32_t k = 0; k < points.size(); ++k) {
    ASSERT_EQ(points[k].x, reverse_bits(owen_hash(77 + k, 0xDEADBEEFU)));
    ASSERT_EQ(points[k].y, reverse_bits(owen_hash(pascal_bits(77 + k), 0x12345678U)));
  }
}

}  // namespace
}  // namespace abn
