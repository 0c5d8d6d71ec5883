#include "sampling/fis/filter_density.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn {
namespace {

const std::vector<std::string> words = {"box",
                                        "triangle:radius=1.5",
                                        "gaussian",
                                        "gaussian:sigma=0.5,radius=1",
                                        "mitchell:b=1,c=0",
                                        "gaussian:sigma=0.5,radius=1,support=disc"};

/// Mean of g(x,y) under f, by the midpoint rule on a fine grid.
template <class Function>
double mean_under(const PixelFilter& filter, const Function& g) {
  constexpr int steps = 480;
  const double radius = filter.radius();
  double sum = 0;
  double mass = 0;
  for (int j = 0; j < steps; ++j) {
    for (int i = 0; i < steps; ++i) {
      const double x = radius * (2 * (i + 0.5) / steps - 1);
      const double y = radius * (2 * (j + 0.5) / steps - 1);
      const double f = filter.value(x, y);
      mass += f;
      sum += f * g(x, y);
    }
  }
  return sum / mass;
}

TEST(FilterDensity, AgreesWithBruteForce) {
  for (const std::string& name : words) {
    const auto filter = make_filter(name);
    const FilterDensity density(filter, "test");
    const double second = mean_under(*filter, [](double x, double y) { return x * x + y * y; });
    EXPECT_NEAR(density.second_moment() / second, 1, 5e-4) << name;
    for (const double part : {0.25, 0.8}) {
      const double r = part * filter->radius();
      const double inside = mean_under(*filter, [&](double x, double y) { return x * x + y * y <= r * r ? 1 : 0; });
      EXPECT_NEAR(static_cast<double>(density.radial(static_cast<float>(r))), inside, 4e-3) << name << " " << part;
      const double left = mean_under(*filter, [&](double x, double) { return x < r ? 1 : 0; });
      EXPECT_NEAR(static_cast<double>(density.marginal(static_cast<float>(r))), left, 4e-3) << name << " " << part;
      const double cell =
          mean_under(*filter, [&](double x, double y) { return x >= 0 && x < r && y >= 0 && y < r / 2 ? 1 : 0; });
      EXPECT_NEAR(density.share(0, r, 0, r / 2), cell, 4e-3) << name << " " << part;
    }
  }
}

TEST(FilterDensity, SecondMomentOfTheDefaultGaussian) {
  EXPECT_NEAR(FilterDensity(make_filter("gaussian"), "test").second_moment(), 0.4867, 5e-5);
  EXPECT_NEAR(FilterDensity(nullptr, "test").second_moment(), 1.0 / 6, 1e-9);
}

TEST(FilterDensity, OffsetsAreDistributedAsTheFilter) {
  constexpr int count = 200;  // x count points of a grid: no noise
  for (const std::string& name : words) {
    const FilterDensity density(make_filter(name), "test");
    std::vector<float> radial;
    std::vector<float> marginal;
    for (int j = 0; j < count; ++j) {
      for (int i = 0; i < count; ++i) {
        const Vec2f unit{(static_cast<float>(i) + 0.5F) / count, (static_cast<float>(j) + 0.5F) / count};
        const Vec2f p = density.offset(unit);
        ASSERT_LE(std::max(std::abs(p.x), std::abs(p.y)), density.radius());
        radial.push_back(density.radial(std::sqrt(p.x * p.x + p.y * p.y)));
        marginal.push_back(density.marginal(p.x));
      }
    }
    for (auto* shares : {&radial, &marginal}) {
      std::sort(shares->begin(), shares->end());
      double greatest = 0;
      for (std::size_t i = 0; i < shares->size(); ++i) {
        greatest = std::max(greatest, std::abs(static_cast<double>((*shares)[i]) -
                                               static_cast<double>(i) / static_cast<double>(shares->size())));
      }
      EXPECT_LT(greatest, 0.008) << name;
    }
  }
}

TEST(FilterDensity, ExtremesOfTheSquareStayInside) {
  for (const std::string& name : words) {
    const FilterDensity density(make_filter(name), "test");
    for (const float u : {0.0F, 0.5F, just_below(1)}) {
      for (const float v : {0.0F, 0.5F, just_below(1)}) {
        const Vec2f p = density.offset({u, v});
        EXPECT_LE(std::abs(p.x), density.radius());
        EXPECT_LE(std::abs(p.y), density.radius());
      }
    }
  }
}

TEST(FilterDensity, NegativeLobesAreRefused) {
  EXPECT_THROW(FilterDensity(make_filter("mitchell"), "test"), ConfigError);
  EXPECT_THROW(FilterDensity(make_filter("lanczos"), "test"), ConfigError);
}

TEST(LinearTable, IsExactForLinesAndClampsBeyond) {
  const LinearTable table(-1, 3, {0, 1, 2});
  EXPECT_FLOAT_EQ(table(-1), 0);
  EXPECT_FLOAT_EQ(table(0), 0.5F);
  EXPECT_FLOAT_EQ(table(3), 2);
  EXPECT_FLOAT_EQ(table(-5), 0);
  EXPECT_FLOAT_EQ(table(9), 2);
}

}  // namespace
}  // namespace abn
