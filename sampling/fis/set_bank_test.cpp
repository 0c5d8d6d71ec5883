#include "sampling/fis/set_bank.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sampling/fis/set_bank_field.h"
#include "sampling/rng.h"

namespace abn {
namespace {

const FilterDensity& gaussian() {
  static const FilterDensity density(make_filter("gaussian"), "test");
  return density;
}

/// Energy distance of a set to the filter, by all pairs: twice the mean distance to the filter's points minus that
/// inside the set and inside the filter.
double energy_distance(const SetBank& bank, std::uint32_t set, const FilterDensity& density) {
  constexpr int side = 24;
  std::vector<Vec2f> truth;
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      truth.push_back(density.offset({(static_cast<float>(i) + 0.5F) / side, (static_cast<float>(j) + 0.5F) / side}));
    }
  }
  const auto mean_distance = [](const std::vector<Vec2f>& a, const std::vector<Vec2f>& b) {
    double sum = 0;
    for (const Vec2f p : a) {
      for (const Vec2f q : b) sum += static_cast<double>(std::hypot(p.x - q.x, p.y - q.y));
    }
    return sum / static_cast<double>(a.size() * b.size());
  };
  const auto first = bank.offset.begin() + static_cast<std::ptrdiff_t>(std::size_t{set} * bank.set_size);
  const std::vector<Vec2f> points(first, first + bank.set_size);
  static const double inside = mean_distance(truth, truth);
  return 2 * mean_distance(points, truth) - mean_distance(points, points) - inside;
}

// The bar: E r^2 within 5 %, KS at most .05.
TEST(SetBank, IsDistributedAsTheFilter) {
  for (const std::uint32_t size : {4U, 10U, 16U}) {
    const SetBankQuality q = measure(relax_set_bank(gaussian(), {.set_size = size}), gaussian());
    EXPECT_LT(std::abs(q.second_moment_error), size < 10 ? 0.08 : 0.05) << size;
    EXPECT_LT(q.radial_ks, size < 10 ? 0.07 : 0.05) << size;
    EXPECT_LT(q.marginal_ks, 0.02) << size;
  }
}

TEST(SetBank, HoldsForEveryKernelAndWeight) {
  for (const Repulsion repulsion : {Repulsion::energy, Repulsion::sph}) {
    for (const bool kriging : {false, true}) {
      const SetBank bank =
          relax_set_bank(gaussian(), {.set_size = 10, .sets = 256, .repulsion = repulsion, .kriging = kriging});
      const SetBankQuality q = measure(bank, gaussian());
      EXPECT_LT(std::abs(q.second_moment_error), 0.06) << kriging;
      EXPECT_LT(q.radial_ks, 0.06) << kriging;
      ASSERT_EQ(bank.weight.size(), kriging ? 2560U : 0U);
      for (std::size_t i = 0; i < bank.weight.size(); i += 10) {
        double sum = 0;
        for (std::size_t k = 0; k < 10; ++k) {
          EXPECT_GE(bank.weight[i + k], 0);
          sum += static_cast<double>(bank.weight[i + k]);
        }
        EXPECT_NEAR(sum, 10, 1e-4);
      }
    }
  }
}

// Without the controller the sets are too narrow: the reason for it.
TEST(SetBank, IsTooNarrowBeforeTheControllerActs) {
  const SetBankQuality q = measure(relax_set_bank(gaussian(), {.set_size = 10, .iterations = 30}), gaussian());
  EXPECT_LT(q.second_moment_error, -0.08);
}

TEST(SetBank, SetsAreEvenUnderTheFilter) {
  const SetBank relaxed = relax_set_bank(gaussian(), {.set_size = 10, .sets = 64});
  const SetBank random = relax_set_bank(gaussian(), {.set_size = 10, .sets = 64, .iterations = 0});
  double even = 0;
  double uneven = 0;
  for (std::uint32_t s = 0; s < 64; ++s) {
    even += energy_distance(relaxed, s, gaussian());
    uneven += energy_distance(random, s, gaussian());
  }
  EXPECT_GT(even, 0);
  EXPECT_LT(even, 0.4 * uneven);
}

TEST(SetBank, IsTheSameForAnyNumberOfThreads) {
  const SetBankSpec spec{.set_size = 6, .sets = 64, .iterations = 60, .kriging = true};
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const SetBank one = relax_set_bank(gaussian(), spec);
  omp_set_num_threads(3);
  const SetBank three = relax_set_bank(gaussian(), spec);
  omp_set_num_threads(threads);
  EXPECT_EQ(one.offset, three.offset);
  EXPECT_EQ(one.weight, three.weight);
  EXPECT_NE(one.offset, relax_set_bank(gaussian(), {.set_size = 6, .sets = 64, .iterations = 60, .seed = 2}).offset);
}

TEST(SetBank, ScalesWithTheFilter) {
  const FilterDensity small(make_filter("triangle:radius=1"), "test");
  const FilterDensity large(make_filter("triangle:radius=2"), "test");
  const SetBank a = relax_set_bank(small, {.set_size = 8, .sets = 8, .iterations = 40});
  const SetBank b = relax_set_bank(large, {.set_size = 8, .sets = 8, .iterations = 40});
  for (std::size_t i = 0; i < a.offset.size(); ++i) {
    EXPECT_NEAR(2 * a.offset[i].x, b.offset[i].x, 1e-2);
    EXPECT_NEAR(2 * a.offset[i].y, b.offset[i].y, 1e-2);
  }
}

TEST(SetBank, StaysInsideTheFilter) {
  for (const char* words : {"box", "gaussian:radius=1,support=disc"}) {
    const FilterDensity density(make_filter(words), "test");
    const SetBank bank = relax_set_bank(density, {.set_size = 5, .sets = 32, .iterations = 100});
    for (const Vec2f p : bank.offset) {
      ASSERT_LE(std::max(std::abs(p.x), std::abs(p.y)), density.radius());
      if (density.disc()) {
        ASSERT_LE(std::hypot(p.x, p.y), density.radius() * 1.000001F);
      }
    }
  }
}

TEST(SetBank, SinglePointsArePlacedBySharesOfTheFilter) {
  const SetBankQuality q = measure(relax_set_bank(gaussian(), {.set_size = 1}), gaussian());
  EXPECT_LT(std::abs(q.second_moment_error), 0.01);
  EXPECT_LT(q.radial_ks, 0.02);
}

TEST(SetBank, SurvivesTheDiskAndRefusesOtherBytes) {
  const SetBankSpec spec{.set_size = 3, .sets = 8, .iterations = 40, .kriging = true};
  const SetBank bank = relax_set_bank(gaussian(), spec);
  auto bytes = to_bytes(bank);
  const auto back = from_bytes(bytes, spec);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->offset, bank.offset);
  EXPECT_EQ(back->weight, bank.weight);
  EXPECT_FALSE(from_bytes(bytes, {.set_size = 4, .sets = 8, .kriging = true}).has_value());
  EXPECT_FALSE(from_bytes(bytes, {.set_size = 3, .sets = 8}).has_value());
  bytes.pop_back();
  EXPECT_FALSE(from_bytes(bytes, spec).has_value());
  EXPECT_FALSE(from_bytes({}, spec).has_value());
}

// The grid field against a sum over many points of the filter.
TEST(SetBankField, GradientIsThatOfTheFilteredPotential) {
  const SetBankSpec spec{.set_size = 10, .axis_weight = 0.03, .short_range = 0.15};
  const detail::BankLengths lengths(gaussian());
  const detail::BankField field(gaussian(), lengths, spec);
  const auto potential = [&](double x, double y) {
    constexpr int side = 300;
    double sum = 0;
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        const Vec2f p =
            gaussian().offset({(static_cast<float>(i) + 0.5F) / side, (static_cast<float>(j) + 0.5F) / side});
        sum += detail::pair_potential(std::abs(x - static_cast<double>(p.x)), std::abs(y - static_cast<double>(p.y)),
                                      lengths, spec);
      }
    }
    return sum / (side * side);
  };
  for (const Vec2f at : {Vec2f{0.3F, -0.2F}, Vec2f{-0.9F, 0.7F}, Vec2f{1.2F, 0.1F}}) {
    const auto x = static_cast<double>(at.x);
    const auto y = static_cast<double>(at.y);
    constexpr double step = 0.05;
    const double dx = (potential(x + step, y) - potential(x - step, y)) / (2 * step);
    const double dy = (potential(x, y + step) - potential(x, y - step)) / (2 * step);
    const Vec2f gradient = field.gradient(at.x, at.y);
    EXPECT_NEAR(gradient.x, dx, 0.02);
    EXPECT_NEAR(gradient.y, dy, 0.02);
    EXPECT_NEAR(static_cast<double>(field.potential(at.x, at.y)), potential(x, y), 0.01);
  }
}

TEST(SetBankField, ControllerPullsTowardsWhereTheBankIsTooThin) {
  const SetBankSpec spec{.set_size = 10};
  const detail::BankLengths lengths(gaussian());
  detail::BankField field(gaussian(), lengths, spec);
  const float before = field.gradient(0.5F, 0).x;
  detail::BankHistogram histogram;
  for (std::size_t b = 0; b < histogram.size(); ++b) {
    histogram[b] = 1.0 / (b < detail::BankFeatures::radial_bins ? 16 : 12);
  }
  field.control(histogram);
  EXPECT_NEAR(field.gradient(0.5F, 0).x, before, 1e-6);
  histogram[15] *= 0.5;  // the outermost ring holds half of its points
  histogram[0] *= 1.5;
  for (int i = 0; i < 20; ++i) field.control(histogram);
  EXPECT_LT(field.gradient(0.5F, 0).x, before - 0.01F);  // less attraction to the centre
}

}  // namespace
}  // namespace abn
