#include "sampling/sobol2d.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>

namespace abn {
namespace {

TEST(ReverseBits, MatchesTheLoop) {
  for (std::uint32_t v = 1, k = 0; k < 1000; ++k, v = v * 1664525U + 1013904223U) {
    std::uint32_t expected = 0;
    for (unsigned b = 0; b < 32; ++b) expected |= ((v >> b) & 1U) << (31 - b);
    ASSERT_EQ(reverse_bits(v), expected);
  }
}

TEST(PascalBits, MatchesTheRecurrenceOfTheDirections) {
  for (std::uint32_t i = 1, k = 0; k < 1000; ++k, i = i * 1664525U + 1013904223U) {
    std::uint32_t expected = 0;
    std::uint32_t direction = 0x80000000U;
    for (unsigned b = 0; b < 32; ++b, direction ^= direction >> 1) {
      if (((i >> b) & 1U) != 0) expected ^= direction;
    }
    ASSERT_EQ(reverse_bits(pascal_bits(i)), expected);
  }
}

// What makes it an Owen scrambling: bit b of the result depends on bits 0 ... b only, and changing bit b changes it.
TEST(OwenHash, IsNested) {
  for (std::uint32_t seed = 1; seed < 200; ++seed) {
    const std::uint32_t v = seed * 2654435761U;
    for (unsigned b = 0; b < 32; ++b) {
      const std::uint32_t difference = owen_hash(v, seed * 40503U) ^ owen_hash(v ^ (1U << b), seed * 40503U);
      ASSERT_EQ(std::countr_zero(difference), static_cast<int>(b));
    }
  }
}

// The flip of a bit depends on the bits before it: over seeds, the flips at the two nodes of one level are independent.
TEST(OwenHash, FlipsOfANodesAreIndependentAndFair) {
  std::array<int, 4> count{};
  constexpr int seeds = 40000;
  std::uint32_t seed = 12345;
  for (int s = 0; s < seeds; ++s) {
    seed = seed * 1664525U + 1013904223U;
    const std::uint32_t mixed = (seed ^ (seed >> 15)) * 0x2C1B3C6DU;
    const std::uint32_t a = (owen_hash(0, mixed) >> 2) & 1U;  // third bit under the nodes 00 and 11
    const std::uint32_t b = (owen_hash(3, mixed) >> 2) & 1U;
    ++count[2 * a + b];
  }
  for (const int c : count) EXPECT_NEAR(c, seeds / 4, 4 * std::sqrt(seeds * 3 / 16.0));
}

}  // namespace
}  // namespace abn
