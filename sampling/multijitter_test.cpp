#include "sampling/multijitter.h"

#include <gtest/gtest.h>

#include <map>

#include "sampling/draw_for_tests.h"

namespace abn {
namespace {

TEST(MultiJitter, OneInEveryCellColumnAndRowOfEveryPixel) {
  const Extent plane{6, 5};
  for (std::size_t n = 1; n <= 64; ++n) {
    const auto [columns, rows] = most_square_factors(n);
    for (const auto& pixel :
         with_axes_restored(by_pixel(draw<MultiJitter>(plane, plane.area() * n, n), plane), plane)) {
      ASSERT_TRUE(cells_equally_filled(pixel, columns, rows)) << n;
      ASSERT_TRUE(cells_equally_filled(pixel, n, 1)) << n;
      ASSERT_TRUE(cells_equally_filled(pixel, 1, n)) << n;
    }
  }
}

TEST(MultiJitter, HoldsOnThePlaneAcrossBatches) {
  auto positions = draw<MultiJitter>({256, 256}, std::uint64_t{1} << 22, 1, {.domain = "plane"});
  for (Vec2f& p : positions) p = p * (1.0F / 256);
  EXPECT_TRUE(cells_equally_filled(positions, 2048, 2048));
  EXPECT_TRUE(cells_equally_filled(positions, std::size_t{1} << 15, 1));
  EXPECT_TRUE(cells_equally_filled(positions, 1, std::size_t{1} << 15));
}

// The shuffles of different columns are independent (in cmj they are the same): 2 x 2 cells, so every column has one
// of two orders; all four combinations of both columns come equally often.
TEST(MultiJitter, ColumnsAreShuffledIndependently) {
  const Extent plane{80, 80};
  std::map<int, int> count;
  for (const auto& pixel : by_pixel(draw<MultiJitter>(plane, plane.area() * 4, 1), plane)) {
    int code = 0;  // per column, whether its upper point is the left one
    for (const Vec2f p : pixel) {
      const int column = p.x < 0.5F ? 0 : 1;
      if (p.y < 0.5F && p.x * 4 - static_cast<float>(2 * column) < 1) code |= 1 << column;
    }
    ++count[code];
  }
  ASSERT_EQ(count.size(), 4U);
  double chi2 = 0;
  for (const auto& [code, c] : count) chi2 += (c - 1600.0) * (c - 1600.0) / 1600;
  EXPECT_LT(chi2, 21.1);  // 3 degrees of freedom, p = 1e-4
}

}  // namespace
}  // namespace abn
