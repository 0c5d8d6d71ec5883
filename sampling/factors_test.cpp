#include "sampling/factors.h"

#include <gtest/gtest.h>

namespace abn {
namespace {

TEST(MostSquareFactors, MatchesSearchByHand) {
  for (std::uint64_t n = 1; n <= 2000; ++n) {
    std::uint64_t best = 1;
    for (std::uint64_t d = 1; d * d <= n; ++d) best = n % d == 0 ? d : best;
    ASSERT_EQ(most_square_factors(n), (CellCounts{best, n / best}));
  }
  EXPECT_EQ(most_square_factors(40000000), (CellCounts{6250, 6400}));
}

TEST(NearSquareCells, MatchesSearchByHand) {
  for (const Extent area : {Extent{1, 1}, Extent{200, 100}, Extent{3, 7}, Extent{1, 1000}}) {
    for (std::uint64_t n = 1; n <= 600; ++n) {
      double best = 1e30;
      for (std::uint64_t rows = 1; rows <= n; ++rows) {
        if (n % rows == 0) best = std::min(best, cell_aspect({n / rows, rows}, area));
      }
      const auto cells = near_square_cells(n, area);
      ASSERT_EQ(cells.has_value(), best <= 2) << n << " on " << area.width << "x" << area.height;
      if (cells) {
        ASSERT_EQ(cells->columns * cells->rows, n);
        ASSERT_EQ(cell_aspect(*cells, area), best);
      }
    }
  }
}

TEST(NearSquareCells, SixAreTwoColumnsByThreeRows) {
  EXPECT_EQ(near_square_cells(6, {1, 1}), (CellCounts{2, 3}));
  EXPECT_EQ(near_square_cells(240000, {200, 200}), (CellCounts{480, 500}));
}

}  // namespace
}  // namespace abn
