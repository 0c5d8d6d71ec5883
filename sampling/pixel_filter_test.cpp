#include "sampling/pixel_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn {
namespace {

const std::vector<std::string> separable = {
    "box",
    "triangle",
    "triangle:radius=2.5",
    "triangle:radius=0.01",
    "gaussian",
    "gaussian:sigma=0.5,radius=1",
    "gaussian:sigma=1.5,radius=3",
    "gaussian:sigma=100,radius=0.5",
    "gaussian:sigma=0.05,radius=8",
    "mitchell",
    "mitchell:b=1,c=0",
    "mitchell:b=0,c=0.5",
    "mitchell:b=0,c=0",
    "lanczos",
    "lanczos:lobes=1",
    "lanczos:lobes=8",
};

/// The sum of function over n midpoints of [a, b], times their distance: error O(n^-2) where it is smooth.
double midpoint_rule(double a, double b, int n, const auto& function) {
  double sum = 0;
  for (int i = 0; i < n; ++i) sum += function(a + (b - a) * (i + 0.5) / n);
  return sum * (b - a) / n;
}

TEST(PixelFilter, ProfileHasIntegralOne) {
  for (const auto& words : separable) {
    const auto filter = make_filter(words);
    const double radius = filter->radius();
    EXPECT_NEAR(midpoint_rule(-radius, radius, 100000, [&](double x) { return filter->profile(x); }), 1, 1e-8) << words;
    EXPECT_EQ(filter->integral(-radius), 0) << words;
    EXPECT_EQ(filter->integral(radius), 1) << words;
    EXPECT_EQ(filter->integral(-radius - 1), 0) << words;
    EXPECT_EQ(filter->integral(std::numeric_limits<double>::infinity()), 1) << words;
    EXPECT_NEAR(filter->integral(0), 0.5, 1e-15) << words;
    EXPECT_EQ(filter->profile(radius + 1e-9), 0) << words;
  }
}

// An antiderivative is one whose differences are the integral of the profile, here by a rule of another order.
TEST(PixelFilter, DifferencesOfTheIntegralAreIntegralsOfTheProfile) {
  for (const auto& words : separable) {
    const auto filter = make_filter(words);
    const double radius = filter->radius();
    const int pieces = 96;  // the kinks at 0, 1 and 2 lie between pieces
    for (int i = 0; i < pieces; ++i) {
      const double a = -radius + 2 * radius * i / pieces;
      const double b = -radius + 2 * radius * (i + 1) / pieces;
      // Midpoint rule, extrapolated twice: order 6.
      const auto rule = [&](int n) { return midpoint_rule(a, b, n, [&](double x) { return filter->profile(x); }); };
      const double coarse = rule(32);
      const double middle = rule(64);
      const double fine = rule(128);
      const double first = (4 * middle - coarse) / 3;
      const double second = (4 * fine - middle) / 3;
      const double exact = (16 * second - first) / 15;
      EXPECT_NEAR(filter->integral(b) - filter->integral(a), exact, 1e-12) << words << " at " << a;
    }
  }
}

TEST(PixelFilter, IsEvenAndAProductOfProfiles) {
  Rng rng(1, stream_id("pixel_filter_test"));
  for (const auto& words : separable) {
    const auto filter = make_filter(words);
    for (int i = 0; i < 200; ++i) {
      const double x = 1.1 * filter->radius() * (2 * double{rng.uniform()} - 1);
      const double y = 1.1 * filter->radius() * (2 * double{rng.uniform()} - 1);
      EXPECT_EQ(filter->profile(x), filter->profile(-x)) << words;
      EXPECT_NEAR(filter->integral(-x), 1 - filter->integral(x), 1e-15) << words;
      EXPECT_EQ(filter->value(x, y), filter->profile(x) * filter->profile(y)) << words;
      if (filter->non_negative()) {
        EXPECT_GE(filter->profile(x), 0) << words;
      }
    }
  }
}

TEST(PixelFilter, InverseUndoesTheIntegral) {
  for (const auto& words : separable) {
    const auto filter = make_filter(words);
    if (!filter->non_negative()) continue;
    const double radius = filter->radius();
    for (int i = 0; i <= 20000; ++i) {
      const double x = -radius + radius * i / 10000;
      // Where there is next to no density, u does not determine x in double.
      if (filter->profile(x) * radius < 1e-6) continue;
      EXPECT_NEAR(filter->inverse(filter->integral(x)), x, 1e-8) << words;
    }
    EXPECT_EQ(filter->inverse(0), -radius);
    EXPECT_EQ(filter->inverse(1), radius);
    EXPECT_EQ(filter->inverse(0.5), 0);
  }
}

TEST(PixelFilter, InverseRisesAndStaysInside) {
  for (const auto& words : separable) {
    const auto filter = make_filter(words);
    if (!filter->non_negative()) continue;
    double last = filter->inverse(0);
    const int n = 100000;
    for (int i = 1; i <= n; ++i) {
      const double x = filter->inverse(static_cast<double>(i) / n);
      ASSERT_GE(x, last) << words << " at " << i;
      ASSERT_LE(x, filter->radius()) << words;
      last = x;
    }
    for (const double u : {1e-300, 1e-18, 1 - 1e-16, std::nextafter(0.5, 0.0), std::nextafter(0.5, 1.0)}) {
      EXPECT_LE(std::abs(filter->inverse(u)), filter->radius()) << words;
    }
    EXPECT_LE(filter->inverse(std::numeric_limits<double>::quiet_NaN()), filter->radius()) << words;
  }
}

TEST(PixelFilter, SignsAreWhatTheySay) {
  for (const auto& words : separable) {
    const auto filter = make_filter(words);
    bool negative = false;
    for (int i = 0; i < 4000; ++i) {
      negative = negative || filter->profile(filter->radius() * (i / 2000.0 - 1)) < -1e-12;
    }
    EXPECT_EQ(filter->non_negative(), !negative) << words;
  }
}

// E r^2 = 2 sigma^2 (1 - 2 a phi(a) / (2 Phi(a) - 1)), a = radius / sigma: the truncated normal distribution.
TEST(PixelFilter, GaussianHasTheVarianceOfATruncatedNormal) {
  const auto filter = make_filter("gaussian");
  const auto second = [&](const PixelFilter& f) {
    return 2 * midpoint_rule(-f.radius(), f.radius(), 200000, [&](double x) { return x * x * f.profile(x); });
  };
  EXPECT_NEAR(second(*filter), 0.4867, 5e-5);
  const double a = 3;
  const double density = std::exp(-a * a / 2) / std::sqrt(2 * std::numbers::pi);
  EXPECT_NEAR(second(*filter), 0.5 * (1 - 2 * a * density / std::erf(a / std::numbers::sqrt2)), 1e-8);
  EXPECT_NEAR(second(*make_filter("triangle:radius=2")), 4.0 / 3, 1e-6);
  EXPECT_NEAR(second(*make_filter("mitchell:b=1,c=0")), 2.0 / 3, 1e-6);  // four boxes
}

TEST(PixelFilter, MitchellSumsToOneOverPixelsAndTakesKnownValues) {
  const auto filter = make_filter("mitchell");
  for (const double x : {0.0, 0.1, 0.25, 0.5, 0.77}) {
    double sum = 0;
    for (int k = -3; k <= 3; ++k) sum += filter->profile(x + k);
    EXPECT_NEAR(sum, 1, 1e-15);
  }
  EXPECT_NEAR(filter->profile(0), 8.0 / 9, 1e-15);
  EXPECT_NEAR(filter->profile(1), 1.0 / 18, 1e-15);
  EXPECT_NEAR(make_filter("mitchell:b=0,c=0.5")->profile(1), 0, 1e-15);  // Catmull-Rom interpolates
}

TEST(PixelFilter, LanczosIsZeroAtOtherPixels) {
  const auto filter = make_filter("lanczos");
  for (const double x : {-3.0, -2.0, -1.0, 1.0, 2.0, 3.0}) EXPECT_NEAR(filter->profile(x), 0, 1e-15);
  EXPECT_LT(filter->profile(1.5), -0.1);
  EXPECT_NEAR(filter->profile(1e-7), filter->profile(0), 1e-12);
}

TEST(PixelFilter, DiscHasIntegralOneAndIsRound) {
  const auto filter = make_filter("gaussian:support=disc");
  ASSERT_TRUE(filter->disc());
  // In polar coordinates, by value() alone.
  const double radius = filter->radius();
  const double sum = midpoint_rule(
      0, radius, 20000, [&](double r) { return 2 * std::numbers::pi * r * filter->value(r * 0.6, r * 0.8); });
  EXPECT_NEAR(sum, 1, 1e-8);
  EXPECT_GT(filter->value(radius * 0.7, radius * 0.7), 0);
  EXPECT_EQ(filter->value(radius * 0.72, radius * 0.72), 0);
  EXPECT_NEAR(make_filter("gaussian:sigma=100,radius=2,support=disc")->value(1, 1), 1 / (4 * std::numbers::pi), 1e-4);
}

TEST(PixelFilter, WordsAreCanonicalAndReadBack) {
  EXPECT_EQ(make_filter("gaussian:radius=2")->words(), "gaussian:sigma=0.5,radius=2,support=square");
  EXPECT_EQ(make_filter("gaussian:radius=2.0,sigma=5e-1")->words(), "gaussian:sigma=0.5,radius=2,support=square");
  EXPECT_EQ(make_filter("box")->words(), "box");
  EXPECT_EQ(make_filter("lanczos")->words(), "lanczos:lobes=3");
  for (const auto& words : separable) {
    const auto canonical = make_filter(words)->words();
    EXPECT_EQ(make_filter(canonical)->words(), canonical);
    EXPECT_EQ(make_filter(canonical)->profile(0.3), make_filter(words)->profile(0.3)) << words;
  }
}

TEST(PixelFilter, TableListsWhatCanBeMade) {
  std::vector<std::string> names;
  for (const auto& row : filters()) {
    names.push_back(row.name);
    const auto words = make_filter(row.name)->words();
    std::string listed = row.name + (row.parameters.empty() ? "" : ":" + row.parameters);
    for (char& letter : listed) letter = letter == ' ' ? ',' : letter;
    EXPECT_EQ(words, listed);
    EXPECT_FALSE(row.summary.empty());
  }
  EXPECT_EQ(names, (std::vector<std::string>{"box", "triangle", "gaussian", "mitchell", "lanczos"}));
}

TEST(PixelFilter, EveryMistakeNamesKeyValueAndRemedy) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {"fox", {"fox", "box", "lanczos"}},
      {"", {"''", "box"}},
      {"gaussian:", {"gaussian", "KEY=VALUE"}},
      {"gaussian:sigma", {"sigma", "KEY=VALUE"}},
      {"gaussian:=1", {"=1", "KEY=VALUE"}},
      {"gaussian:sigma=1,", {"gaussian", "KEY=VALUE"}},
      {"gaussian:sigma=0", {"sigma", "0", "[0.01, 100]"}},
      {"gaussian:sigma=-1", {"sigma", "-1", "[0.01, 100]"}},
      {"gaussian:sigma=wide", {"sigma", "wide", "number"}},
      {"gaussian:sigma=nan", {"sigma", "nan", "number"}},
      {"gaussian:radius=8.5", {"radius", "8.5", "[0.01, 8]"}},
      {"gaussian:support=circle", {"support", "circle", "square", "disc"}},
      {"gaussian:sigme=1", {"sigme", "gaussian", "sigma"}},
      {"gaussian:sigma=1,sigma=2", {"sigma", "twice"}},
      {"triangle:radius=0", {"radius", "0", "[0.01, 8]"}},
      {"mitchell:b=2", {"b", "2", "[0, 1]"}},
      {"lanczos:lobes=2.5", {"lobes", "2.5", "whole"}},
      {"lanczos:lobes=9", {"lobes", "9", "[1, 8]"}},
      {"box:radius=1", {"radius", "box", "none"}},
  };
  for (const auto& [words, parts] : cases) {
    try {
      (void)make_filter(words);
      ADD_FAILURE() << words;
    } catch (const ConfigError& error) {
      const std::string message = error.what();
      for (const auto& part : parts) EXPECT_NE(message.find(part), std::string::npos) << message << " lacks " << part;
    }
  }
}

}  // namespace
}  // namespace abn
