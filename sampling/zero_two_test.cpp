#include "sampling/zero_two.h"

#include <gtest/gtest.h>

#include "sampling/draw_for_tests.h"
#include "sampling/sobol2d.h"

namespace abn {
namespace {

TEST(ZeroTwo, EveryPowerOfTwoPerPixelIsANet) {
  const Extent plane{9, 7};
  for (unsigned m = 0; m <= 8; ++m) {
    for (const auto& pixel : by_pixel(draw<ZeroTwo>(plane, plane.area() << m, m), plane)) {
      ASSERT_TRUE(is_zero_net(pixel, m)) << m;
    }
  }
}

TEST(ZeroTwo, EveryAlignedBlockOfASetIsANet) {
  const auto points = draw<ZeroTwo>({1, 1}, 4096, 3);
  for (unsigned m = 0; m <= 12; ++m) {
    const auto size = std::ptrdiff_t{1} << m;
    for (auto start = points.begin(); start != points.end(); start += size) {
      ASSERT_TRUE(is_zero_net(std::vector<Vec2f>(start, start + size), m)) << m;
    }
  }
}

TEST(ZeroTwo, HoldsOnThePlaneAcrossBatches) {
  auto positions = draw<ZeroTwo>({256, 64}, std::uint64_t{1} << 22, 1, {.domain = "plane"});
  for (Vec2f& p : positions) p = {p.x / 256, p.y / 64};
  for (unsigned a = 7; a <= 15; ++a) {
    EXPECT_TRUE(cells_equally_filled(positions, std::size_t{1} << a, std::size_t{1} << (22 - a))) << a;
  }
}

// One word is xor-ed to all points: the digits in which two points differ are those of the plain sequence.
TEST(ZeroTwo, ScramblingIsOneWordPerCoordinate) {
  const auto points = draw<ZeroTwo>({1, 1}, 256, 3);
  const auto digits = [](float v) { return static_cast<std::uint32_t>(static_cast<double>(v) * 65536); };
  for (std::uint32_t i = 0; i < 256; ++i) {
    ASSERT_EQ(digits(points[i].x) ^ digits(points[0].x), reverse_bits(i) >> 16);
    ASSERT_EQ(digits(points[i].y) ^ digits(points[0].y), reverse_bits(pascal_bits(i)) >> 16);
  }
}

}  // namespace
}  // namespace abn
