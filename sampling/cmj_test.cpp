#include "sampling/cmj.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sampling/draw_for_tests.h"

namespace abn {
namespace {

TEST(Cmj, OneInEveryRowAndAtMostOneInEveryStratumForAllCounts) {
  const Extent plane{6, 5};
  for (std::size_t n = 1; n <= 64; ++n) {
    const auto columns = static_cast<std::size_t>(std::sqrt(static_cast<double>(n)));
    const std::size_t rows = (n + columns - 1) / columns;
    for (const auto& pixel : by_pixel(draw<Cmj>(plane, plane.area() * n, n), plane)) {
      ASSERT_TRUE(cells_equally_filled(pixel, 1, n)) << n;
      std::vector<int> fine(columns * rows);
      for (const Vec2f p : pixel) ++fine.at(static_cast<std::size_t>(p.x * static_cast<float>(columns * rows)));
      ASSERT_LE(*std::max_element(fine.begin(), fine.end()), 1) << n;
      if (columns * rows == n) {
        ASSERT_TRUE(cells_equally_filled(pixel, columns, rows)) << n;
      }
    }
  }
}

TEST(Cmj, HoldsOnThePlaneAcrossBatches) {
  auto positions = draw<Cmj>({256, 256}, std::uint64_t{1} << 22, 1, {.domain = "plane"});
  for (Vec2f& p : positions) p = p * (1.0F / 256);
  EXPECT_TRUE(cells_equally_filled(positions, 2048, 2048));
  EXPECT_TRUE(cells_equally_filled(positions, std::size_t{1} << 15, 1));
  EXPECT_TRUE(cells_equally_filled(positions, 1, std::size_t{1} << 15));
}

}  // namespace
}  // namespace abn
