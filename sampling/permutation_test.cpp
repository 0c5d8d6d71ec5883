#include "sampling/permutation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <vector>

namespace abn {
namespace {

TEST(Permutation, HitsEveryElementOnce) {
  for (const std::uint32_t n : {1U, 2U, 3U, 6U, 7U, 64U, 1000U, 4097U}) {
    for (std::uint64_t key = 0; key < 20; ++key) {
      const Permutation permutation(n, key);
      std::vector<bool> hit(n);
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t p = permutation(i);
        ASSERT_LT(p, n);
        ASSERT_FALSE(hit[p]) << n << " key " << key;
        hit[p] = true;
      }
    }
  }
}

TEST(Permutation, WorksUpToTheLargestCount) {
  const Permutation permutation(0xFFFFFFFFU, 1);
  EXPECT_LT(permutation(0xFFFFFFFEU), 0xFFFFFFFFU);
  EXPECT_NE(permutation(0), permutation(1));
}

// Chi-square over all n! permutations and consecutive keys.
TEST(Permutation, AllPermutationsOfFewElementsAreAboutEquallyOften) {
  constexpr int keys = 60000;
  struct Case {
    std::uint32_t n;
    int permutations;
    double limit;  // chi-square quantile at p = 1e-4
  };
  for (const auto [n, permutations, limit] : {Case{2, 2, 15.1}, Case{3, 6, 25.8}, Case{4, 24, 58.6}}) {
    std::map<std::vector<std::uint32_t>, int> count;
    for (int key = 0; key < keys; ++key) {
      const Permutation permutation(n, static_cast<std::uint64_t>(key));
      std::vector<std::uint32_t> image;
      for (std::uint32_t i = 0; i < n; ++i) image.push_back(permutation(i));
      ++count[image];
    }
    ASSERT_EQ(count.size(), static_cast<std::size_t>(permutations));
    const double expected = static_cast<double>(keys) / permutations;
    double chi2 = 0;
    for (const auto& [image, c] : count) chi2 += (c - expected) * (c - expected) / expected;
    RecordProperty("chi2_" + std::to_string(n), std::to_string(chi2));
    EXPECT_LT(chi2, limit) << n;
  }
}

// Chi-square, as standard deviations above its mean, of element i over values, and of two elements over pairs of
// values. The sizes lie on both sides of the change of method and of a power of two.
TEST(Permutation, ElementsAreUniformAndPairsIndependent) {
  constexpr int keys = 40000;
  for (const std::uint32_t n : {12U, 16U, 17U, 20U, 32U, 33U, 64U}) {
    std::vector<int> value(n * n), pair(n * n);
    for (int key = 0; key < keys; ++key) {
      const Permutation permutation(n, static_cast<std::uint64_t>(key));
      for (std::uint32_t i = 0; i < n; ++i) ++value[i * n + permutation(i)];
      ++pair[permutation(0) * n + permutation(n / 2)];
    }
    const double one = static_cast<double>(keys) / n;
    const double two = one / (n - 1);
    double chi2_value = 0;
    double chi2_pair = 0;
    for (std::uint32_t a = 0; a < n; ++a) {
      for (std::uint32_t b = 0; b < n; ++b) {
        chi2_value += (value[a * n + b] - one) * (value[a * n + b] - one) / one;
        if (a != b) chi2_pair += (pair[a * n + b] - two) * (pair[a * n + b] - two) / two;
      }
    }
    const double freedom_value = (n - 1.0) * (n - 1.0);
    const double freedom_pair = n * (n - 1.0) - 1;
    EXPECT_LT((chi2_value - freedom_value) / std::sqrt(2 * freedom_value), 4) << n;
    EXPECT_LT((chi2_pair - freedom_pair) / std::sqrt(2 * freedom_pair), 4) << n;
  }
}

}  // namespace
}  // namespace abn
