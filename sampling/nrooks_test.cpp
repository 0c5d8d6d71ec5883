#include "sampling/nrooks.h"

#include <gtest/gtest.h>

#include <set>

#include "sampling/draw_for_tests.h"

namespace abn {
namespace {

TEST(NRooks, OneInEveryColumnAndRowOfEveryPixel) {
  const Extent plane{6, 5};
  for (std::size_t n = 1; n <= 64; ++n) {
    for (const auto& pixel : by_pixel(draw<NRooks>(plane, plane.area() * n, n), plane)) {
      ASSERT_TRUE(cells_equally_filled(pixel, n, 1)) << n;
      ASSERT_TRUE(cells_equally_filled(pixel, 1, n)) << n;
    }
  }
}

TEST(NRooks, HoldsOnThePlaneAcrossBatches) {
  auto positions = draw<NRooks>({256, 256}, std::uint64_t{1} << 21, 1, {.domain = "plane"});
  for (Vec2f& p : positions) p = p * (1.0F / 256);
  EXPECT_TRUE(cells_equally_filled(positions, std::size_t{1} << 15, 1));
  EXPECT_TRUE(cells_equally_filled(positions, 1, std::size_t{1} << 15));
}

TEST(NRooks, AllPairingsOccurAboutEquallyOften) {
  const Extent plane{80, 80};
  std::vector<double> count(27);
  for (const auto& pixel : by_pixel(draw<NRooks>(plane, plane.area() * 3, 1), plane)) {
    std::size_t code = 0;
    for (const Vec2f p : pixel) code = 3 * code + static_cast<std::size_t>(p.y * 3);
    ++count.at(code);
  }
  double chi2 = 0;
  std::size_t pairings = 0;
  for (const double c : count) {
    if (c == 0) continue;
    ++pairings;
    chi2 += (c - 6400 / 6.0) * (c - 6400 / 6.0) / (6400 / 6.0);
  }
  EXPECT_EQ(pairings, 6U);
  EXPECT_LT(chi2, 25.8);  // 5 degrees of freedom, p = 1e-4
}

}  // namespace
}  // namespace abn
