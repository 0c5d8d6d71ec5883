#include "sampling/analysis/harmonic_products.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <numbers>

#include "sampling/rng.h"

namespace abn::analysis {
namespace {

struct Phases {
  std::vector<double> row, column;
};

Phases random_phases(std::size_t count) {
  Phases phases;
  Rng rng(3, stream_id("phases"));
  for (std::size_t j = 0; j < count; ++j) {
    phases.row.push_back(rng.next() * 0x1p-32 + rng.next() * 0x1p-52);
    phases.column.push_back(rng.next() * 0x1p-32 - 0.5);
  }
  return phases;
}

TEST(HarmonicProducts, EqualTheDirectSums) {
  const Harmonics rows{21, 47};
  const Harmonics columns{50, 1};
  const Phases phases = random_phases(300);
  HarmonicProducts sums(rows, columns);
  sums.add(phases.row, phases.column);
  for (std::size_t k = 0; k < rows.count; ++k) {
    for (std::size_t l = 0; l < columns.count; ++l) {
      long double expected[4] = {};
      for (std::size_t j = 0; j < phases.row.size(); ++j) {
        const long double turn = 2 * std::numbers::pi_v<long double>;
        const long double a = turn * static_cast<long double>(k * rows.step) * phases.row[j];
        const long double b = turn * static_cast<long double>(l * columns.step) * phases.column[j];
        expected[0] += std::cos(a) * std::cos(b);
        expected[1] += std::sin(a) * std::sin(b);
        expected[2] += std::cos(a) * std::sin(b);
        expected[3] += std::sin(a) * std::cos(b);
      }
      ASSERT_NEAR(sums.cos_cos(k, l), static_cast<double>(expected[0]), 1e-12) << k << " " << l;
      ASSERT_NEAR(sums.sin_sin(k, l), static_cast<double>(expected[1]), 1e-12) << k << " " << l;
      ASSERT_NEAR(sums.cos_sin(k, l), static_cast<double>(expected[2]), 1e-12) << k << " " << l;
      ASSERT_NEAR(sums.sin_cos(k, l), static_cast<double>(expected[3]), 1e-12) << k << " " << l;
    }
  }
}

TEST(HarmonicProducts, PointsMayComeInParts) {
  const Phases phases = random_phases(256);
  HarmonicProducts whole({9, 1}, {9, 1});
  HarmonicProducts parts({9, 1}, {9, 1});
  whole.add(phases.row, phases.column);
  parts.add(std::span(phases.row).first(128), std::span(phases.column).first(128));
  parts.add(std::span(phases.row).last(128), std::span(phases.column).last(128));
  for (std::size_t k = 0; k < 9; ++k) EXPECT_EQ(whole.sin_cos(k, 8 - k), parts.sin_cos(k, 8 - k));
}

TEST(HarmonicProducts, SameBitsForAnyInstructionsAndThreads) {
  const Phases phases = random_phases(1000);
  HarmonicProducts expected({100, 1}, {70, 1}, VectorUnit::baseline);
  expected.add(phases.row, phases.column);
  const int before = omp_get_max_threads();
  for (const VectorUnit unit : vector_units()) {
    for (const int threads : {1, 2, 5}) {
      omp_set_num_threads(threads);
      HarmonicProducts sums({100, 1}, {70, 1}, unit);
      sums.add(phases.row, phases.column);
      for (std::size_t k = 0; k < 100; ++k) {
        for (std::size_t l = 0; l < 70; ++l) {
          ASSERT_EQ(sums.cos_cos(k, l), expected.cos_cos(k, l)) << to_string(unit) << " " << threads;
          ASSERT_EQ(sums.sin_sin(k, l), expected.sin_sin(k, l)) << to_string(unit) << " " << threads;
          ASSERT_EQ(sums.cos_sin(k, l), expected.cos_sin(k, l)) << to_string(unit) << " " << threads;
          ASSERT_EQ(sums.sin_cos(k, l), expected.sin_cos(k, l)) << to_string(unit) << " " << threads;
        }
      }
    }
  }
  omp_set_num_threads(before);
}

}  // namespace
}  // namespace abn::analysis
