#include "sampling/regular.h"

#include <gtest/gtest.h>

#include "sampling/draw_for_tests.h"

namespace abn {
namespace {

std::string complaint(Extent plane, std::uint64_t budget) {
  try {
    draw<Regular>(plane, budget, 1);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(Regular, CentresOfTheCellsOfEveryPixel) {
  const Extent plane{20, 10};
  const std::pair<std::uint64_t, CellCounts> cases[] = {{1, {1, 1}}, {2, {1, 2}}, {4, {2, 2}},
                                                        {6, {2, 3}}, {9, {3, 3}}, {64, {8, 8}}};
  for (const auto& [n, cells] : cases) {
    const auto positions = draw<Regular>(plane, plane.area() * n, 1);
    for (const auto& pixel : by_pixel(positions, plane)) {
      ASSERT_EQ(pixel.size(), n);
      for (std::size_t i = 0; i < n; ++i) {
        const double x = (static_cast<double>(i % cells.columns) + 0.5) / static_cast<double>(cells.columns);
        const double y = (static_cast<double>(i / cells.columns) + 0.5) / static_cast<double>(cells.rows);
        ASSERT_NEAR(pixel[i].x, x, 2e-6);  // one unit in the last place of a float below 20
        ASSERT_NEAR(pixel[i].y, y, 2e-6);
      }
    }
  }
}

TEST(Regular, SpansThePlaneWhereNoGridFitsThePixels) {
  const Extent plane{200, 200};
  const auto positions = draw<Regular>(plane, 200000, 1);  // 5 per pixel: 400 columns by 500 rows
  ASSERT_EQ(positions.size(), 200000U);
  EXPECT_NEAR(positions[0].x, 0.25, 1e-6);
  EXPECT_NEAR(positions[0].y, 0.2, 1e-6);
  EXPECT_NEAR(positions[1].x, 0.75, 1e-6);
  EXPECT_NEAR(positions[400].y, 0.6, 1e-6);
}

TEST(Regular, RefusesOtherBudgetsAndNamesTheNearest) {
  const std::string text = complaint({200, 200}, 240001);
  EXPECT_NE(text.find("240001"), std::string::npos) << text;
  EXPECT_NE(text.find("240000"), std::string::npos) << text;
  // The named budgets are possible and none between them is.
  const std::string seven = complaint({1, 1}, 7);
  EXPECT_NE(seven.find(" 6 and 8"), std::string::npos) << seven;
  EXPECT_NE(complaint({1, 1}, 5).find(" 4 and 6"), std::string::npos);
  EXPECT_NO_THROW(draw<Regular>({1, 1}, 6, 1));
  EXPECT_NO_THROW(draw<Regular>({1, 1}, 8, 1));
}

TEST(Regular, LongPlanesGetOneLine) {
  const auto positions = draw<Regular>({1000, 1}, 7, 1);
  ASSERT_EQ(positions.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(positions[i].x, (static_cast<double>(i) + 0.5) * 1000 / 7, 1e-3);
}

TEST(Regular, SeedHasNoEffect) {
  EXPECT_FALSE(Regular::info.random);
  EXPECT_EQ(draw<Regular>({9, 7}, 63 * 4, 1), draw<Regular>({9, 7}, 63 * 4, 2));
}

}  // namespace
}  // namespace abn
