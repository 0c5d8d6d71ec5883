#include "sampling/rng.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

namespace abn {
namespace {

// Known answers of the authors' reference implementation (Random123, kat_vectors, philox4x32 with 10 rounds).
TEST(Philox, KnownAnswers) {
  const Philox4 zero = philox4x32({{0, 0, 0, 0}}, 0, 0);
  EXPECT_EQ(zero.word[0], 0x6627E8D5U);
  EXPECT_EQ(zero.word[1], 0xE169C58DU);
  EXPECT_EQ(zero.word[2], 0xBC57AC4CU);
  EXPECT_EQ(zero.word[3], 0x9B00DBD8U);
  const std::uint32_t ones = 0xFFFFFFFFU;
  const Philox4 one = philox4x32({{ones, ones, ones, ones}}, ones, ones);
  EXPECT_EQ(one.word[0], 0x408F276DU);
  EXPECT_EQ(one.word[1], 0x41C83B0EU);
  EXPECT_EQ(one.word[2], 0xA20BC7C6U);
  EXPECT_EQ(one.word[3], 0x6D5451FDU);
}

TEST(Rng, IsAFunctionOfSeedStreamAndIndex) {
  Rng a(1, stream_id("a"), 7);
  Rng same(1, stream_id("a"), 7);
  for (int i = 0; i < 100; ++i) ASSERT_EQ(a.next(), same.next());
  std::set<std::uint32_t> firsts;
  for (const std::uint64_t seed : {std::uint64_t{1}, std::uint64_t{2}, std::uint64_t{1} << 32}) {
    for (const char* stream : {"a", "b"}) {
      for (const std::uint64_t index : {std::uint64_t{7}, std::uint64_t{8}, std::uint64_t{7} << 32}) {
        firsts.insert(Rng(seed, stream_id(stream), index).next());
      }
    }
  }
  EXPECT_EQ(firsts.size(), 18U);
}

TEST(Rng, UniformStaysBelowOne) {
  EXPECT_EQ(unit_float(0), 0.0F);
  EXPECT_LT(unit_float(0xFFFFFFFFU), 1.0F);
  EXPECT_EQ(unit_float(0x80000000U), 0.5F);
}

TEST(Rng, UniformHasTheMomentsOfTheUniformDistribution) {
  Rng rng(3, stream_id("moments"));
  constexpr int n = 100000;
  double sum = 0, square = 0;
  for (int i = 0; i < n; ++i) {
    const double u = rng.uniform();
    sum += u;
    square += u * u;
  }
  EXPECT_NEAR(sum / n, 0.5, 4 * std::sqrt(1.0 / 12 / n));
  EXPECT_NEAR(square / n, 1.0 / 3, 4 * std::sqrt(4.0 / 45 / n));
}

TEST(Rng, BelowIsUniformAndInRange) {
  Rng rng(5, stream_id("below"));
  EXPECT_EQ(rng.below(1), 0U);
  std::array<int, 7> count{};
  constexpr int n = 70000;
  for (int i = 0; i < n; ++i) ++count.at(rng.below(7));
  double chi2 = 0;
  for (const int c : count) chi2 += (c - n / 7.0) * (c - n / 7.0) / (n / 7.0);
  EXPECT_LT(chi2, 22.5);  // 6 degrees of freedom, p = 0.001
  // 3/4 of 2^32: without rejection the values below 2^30 would come twice as often as the others.
  const std::uint32_t large = 0xC0000000U;
  int low = 0;
  for (int i = 0; i < n; ++i) low += rng.below(large) < 0x40000000U ? 1 : 0;
  EXPECT_NEAR(low / static_cast<double>(n), 1.0 / 3, 4 * std::sqrt(2.0 / 9 / n));
}

}  // namespace
}  // namespace abn
