#include "sampling/torus_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "sampling/rng.h"

namespace abn {
namespace {

struct Torus {
  float width, height, cell;
};

TEST(TorusCells, SearchMeetsEveryImageInTheRectangleOnce) {
  for (const Torus torus : {Torus{10, 7, 1}, {0.5F, 40, 1}, {100, 0.3F, 1.5F}, {1, 1, 3}, {9, 9, 0.7F}}) {
    constexpr std::size_t n = 60;
    std::vector<float> x(n), y(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2f unit = Rng(3, stream_id("torus cells test"), i).uniform2();
      x[i] = unit.x * torus.width;
      y[i] = unit.y * torus.height;
    }
    TorusCells cells(torus.width, torus.height, torus.cell / 2, torus.cell, n);
    EXPECT_LE(cells.size(), n + 1);
    std::vector<std::uint32_t> place(n), at(n);
    cells.sort(x, y, place);
    for (std::size_t i = 0; i < n; ++i) at[place[i]] = static_cast<std::uint32_t>(i);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t cell = cells.cell(x[i], y[i]);
      ASSERT_TRUE(cells.begin()[cell] <= place[i] && place[i] < cells.begin()[cell + 1]);
    }

    const float x0 = -1.3F * torus.width, x1 = 2.2F * torus.width, y0 = 0.4F * torus.height, y1 = 1.7F * torus.height;
    std::map<std::tuple<std::uint32_t, int, int>, int> met;
    cells.for_each_run(x0, x1, y0, y1, [&](std::size_t begin, std::size_t end, float shift_x, float shift_y) {
      for (std::size_t k = begin; k < end; ++k) {
        ++met[{at[k], static_cast<int>(std::lround(shift_x / torus.width)),
               static_cast<int>(std::lround(shift_y / torus.height))}];
      }
    });
    for (const auto& entry : met) EXPECT_EQ(entry.second, 1);
    for (std::uint32_t i = 0; i < n; ++i) {
      for (int u = -3; u <= 3; ++u) {
        for (int v = -3; v <= 3; ++v) {
          const float image_x = x[i] + static_cast<float>(u) * torus.width;
          const float image_y = y[i] + static_cast<float>(v) * torus.height;
          const float slack = cells.rounding(torus.width + torus.height);
          const bool within =
              image_x > x0 + slack && image_x < x1 - slack && image_y > y0 + slack && image_y < y1 - slack;
          if (within) {
            EXPECT_EQ(met.count({i, u, v}), 1U);
          }
        }
      }
    }
  }
}

TEST(TorusCells, SortIsStable) {
  const std::vector<float> x{0.1F, 0.9F, 0.1F, 0.9F, 0.1F}, y(5, 0.5F);
  TorusCells cells(1, 1, 0.5F, 1, 5);
  std::vector<std::uint32_t> place(5);
  cells.sort(x, y, place);
  EXPECT_EQ(place, (std::vector<std::uint32_t>{0, 3, 1, 4, 2}));
}

}  // namespace
}  // namespace abn
