#include "sampling/halton.h"

#include <gtest/gtest.h>

#include <map>

#include "sampling/draw_for_tests.h"

namespace abn {
namespace {

double inverse(unsigned i, unsigned base) {
  double value = 0;
  double place = 1;
  for (; i > 0; i /= base) value += (i % base) * (place /= base);
  return value;
}

TEST(Halton, UnscrambledIsTheDefinition) {
  const auto points = draw<Halton>({1, 1}, 1000, 1, {.scramble = "none"});
  for (unsigned i = 0; i < 1000; ++i) {
    EXPECT_NEAR(points[i].x, inverse(i, 2), 1e-7);
    EXPECT_NEAR(points[i].y, inverse(i, 3), 1e-7);
  }
  EXPECT_EQ(draw<Halton>({1, 1}, 1000, 2, {.scramble = "none"}), points);
}

// Any 2^a 3^b points in a row from a multiple on have one in each of the 2^a by 3^b cells.
TEST(Halton, ScrambledElementaryIntervalsHoldOne) {
  for (const char* scramble : {"owen", "digit"}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const auto points = draw<Halton>({1, 1}, 5 * 2592, seed, {.scramble = scramble});
      for (const auto& [columns, rows] :
           {std::pair{1U, 1U}, {2U, 3U}, {32U, 1U}, {1U, 81U}, {16U, 9U}, {8U, 27U}, {32U, 81U}}) {
        const std::size_t n = columns * rows;
        for (std::size_t start = 0; start + n <= points.size(); start += n) {
          const std::vector<Vec2f> part(points.begin() + static_cast<std::ptrdiff_t>(start),
                                        points.begin() + static_cast<std::ptrdiff_t>(start + n));
          ASSERT_TRUE(cells_equally_filled(part, columns, rows)) << scramble << " " << columns << "x" << rows;
        }
      }
    }
  }
}

TEST(Halton, HoldsOnThePlaneAcrossBatches) {
  // 2^9 3^8 = 3.4 million points, more than three batches.
  const auto points = draw<Halton>({1, 1}, 512 * 6561, 1);
  EXPECT_TRUE(cells_equally_filled(points, 512, 1));
  EXPECT_TRUE(cells_equally_filled(points, 1, 6561));
}

// Nested scrambling: the order of the thirds is one of six, about equally often, and that of the ninths inside one
// third is independent of that inside another; with one permutation per digit it is the same.
TEST(Halton, OwenPermutesEveryNodeIndependently) {
  std::map<int, int> first, pair;
  constexpr int seeds = 6000;
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto points = draw<Halton>({1, 1}, 9, static_cast<std::uint64_t>(seed));
    const auto third = [&](std::size_t i) { return static_cast<int>(points[i].y * 3); };
    const auto ninth = [&](std::size_t i) { return static_cast<int>(points[i].y * 9) % 3; };
    ++first[3 * third(0) + third(1)];
    ++pair[3 * ninth(0) + ninth(1)];  // points 0 and 1 are in different thirds
  }
  ASSERT_EQ(first.size(), 6U);
  ASSERT_EQ(pair.size(), 9U);
  double chi2 = 0;
  for (const auto& [code, c] : first) chi2 += (c - seeds / 6.0) * (c - seeds / 6.0) / (seeds / 6.0);
  EXPECT_LT(chi2, 25.8);  // 5 degrees of freedom, p = 1e-4
  chi2 = 0;
  for (const auto& [code, c] : pair) chi2 += (c - seeds / 9.0) * (c - seeds / 9.0) / (seeds / 9.0);
  EXPECT_LT(chi2, 31.9);  // 8 degrees of freedom, p = 1e-4
}

}  // namespace
}  // namespace abn
