#include "sampling/pmj02.h"

#include <gtest/gtest.h>

#include "sampling/draw_for_tests.h"

namespace abn {
namespace {

std::vector<Vec2f> prefix(const std::vector<Vec2f>& points, std::size_t n) {
  return {points.begin(), points.begin() + static_cast<std::ptrdiff_t>(n)};
}

TEST(Pmj02, EveryPowerOfTwoPrefixIsANet) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto points = draw<Pmj02>({1, 1}, 4096, seed);
    for (unsigned m = 0; m <= 12; ++m) ASSERT_TRUE(is_zero_net(prefix(points, std::size_t{1} << m), m)) << m;
  }
}

TEST(Pmj02, EveryPowerOfTwoPerPixelIsANet) {
  const Extent plane{9, 7};
  for (unsigned m = 0; m <= 8; ++m) {
    for (const auto& pixel : by_pixel(draw<Pmj02>(plane, plane.area() << m, m), plane)) {
      ASSERT_TRUE(is_zero_net(pixel, m)) << m;
    }
  }
}

// The order that names the method: see pmj02.h.
TEST(Pmj02, CellsAreFilledDiagonallyFirst) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto points = draw<Pmj02>({1, 1}, 4096, seed);
    for (unsigned k = 0; k < 6; ++k) {
      const std::size_t n = std::size_t{1} << (2 * k);
      const auto side = static_cast<float>(1U << k);
      for (std::size_t j = 0; j < n; ++j) {
        const auto cell = [&](std::size_t i) {
          return std::pair{static_cast<int>(points[i].x * side), static_cast<int>(points[i].y * side)};
        };
        const auto half_x = [&](std::size_t i) { return static_cast<int>(points[i].x * side * 2) & 1; };
        const auto half_y = [&](std::size_t i) { return static_cast<int>(points[i].y * side * 2) & 1; };
        for (const std::size_t i : {j + n, j + 2 * n, j + 3 * n}) ASSERT_EQ(cell(i), cell(j));
        ASSERT_NE(half_x(j + n), half_x(j));
        ASSERT_NE(half_y(j + n), half_y(j));
        ASSERT_NE(half_x(j + 3 * n), half_x(j + 2 * n));
        ASSERT_NE(half_y(j + 3 * n), half_y(j + 2 * n));
      }
    }
  }
}

TEST(Pmj02, LastTwoSubquadrantsComeInRandomOrder) {
  const auto points = draw<Pmj02>({1, 1}, 4096, 1);
  int same_row = 0;  // of 1024 cells of the last level: whether the third point lies beside the first
  for (std::size_t j = 0; j < 1024; ++j) {
    same_row += static_cast<int>(points[j].y * 64) == static_cast<int>(points[j + 2048].y * 64) ? 1 : 0;
  }
  EXPECT_NEAR(same_row, 512, 4 * 16);
}

// Why no search is needed: given the first 2^m points, the strata of the next 2^m are forced. From the first 16 points
// alone, go through all 32 * 32 fine strata of every diagonal subquadrant: exactly one keeps the net property.
TEST(Pmj02, StrataOfTheNextPointsAreForced) {
  const auto points = draw<Pmj02>({1, 1}, 32, 7);
  const auto fine = [](float v) { return static_cast<unsigned>(v * 32); };
  for (std::size_t j = 0; j < 16; ++j) {
    int allowed = 0;
    bool taken = false;
    for (unsigned x = 0; x < 32; ++x) {
      for (unsigned y = 0; y < 32; ++y) {
        // 8 x 8 subquadrants are 4 x 4 fine strata: the one diagonally opposite to point j in its cell.
        if (x / 4 != (fine(points[j].x) / 4 ^ 1U) || y / 4 != (fine(points[j].y) / 4 ^ 1U)) continue;
        bool free = true;
        for (unsigned a = 0; a <= 5; ++a) {
          for (std::size_t i = 0; i < 16; ++i) {
            free = free && !(fine(points[i].x) >> (5 - a) == x >> (5 - a) && fine(points[i].y) >> a == y >> a);
          }
        }
        allowed += free ? 1 : 0;
        taken = taken || (free && fine(points[j + 16].x) == x && fine(points[j + 16].y) == y);
      }
    }
    EXPECT_EQ(allowed, 1);
    EXPECT_TRUE(taken);
  }
}

TEST(Pmj02, HoldsOnThePlaneAcrossBatches) {
  auto positions = draw<Pmj02>({256, 64}, std::uint64_t{1} << 22, 1, {.domain = "plane"});
  for (Vec2f& p : positions) p = {p.x / 256, p.y / 64};
  for (unsigned a = 7; a <= 15; ++a) {
    EXPECT_TRUE(cells_equally_filled(positions, std::size_t{1} << a, std::size_t{1} << (22 - a))) << a;
  }
}

}  // namespace
}  // namespace abn
