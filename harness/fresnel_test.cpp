#include "harness/fresnel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace abn::harness {
namespace {

TEST(Fresnel, MatchesPublishedTable) {
  // Abramowitz and Stegun 1964, table 7.7 (seven decimals).
  EXPECT_NEAR(fresnel(0.5).cosine, 0.4923442, 1e-7);
  EXPECT_NEAR(fresnel(0.5).sine, 0.0647324, 1e-7);
  EXPECT_NEAR(fresnel(1.0).cosine, 0.7798934, 1e-7);
  EXPECT_NEAR(fresnel(1.0).sine, 0.4382591, 1e-7);
  EXPECT_NEAR(fresnel(2.0).cosine, 0.4882534, 1e-7);
  EXPECT_NEAR(fresnel(2.0).sine, 0.3434157, 1e-7);
  EXPECT_NEAR(fresnel(5.0).cosine, 0.5636312, 1e-7);
  EXPECT_NEAR(fresnel(5.0).sine, 0.4991914, 1e-7);
}

TEST(Fresnel, IsTheIntegralOfTheChirp) {
  // Simpson's rule over steps short against the chirp's period, on both sides of the change of method.
  double cosine = 0, sine = 0, from = 0;
  for (int step = 1; step <= 400; ++step) {
    const double until = 0.01 * step;
    constexpr int halves = 20;
    const double h = (until - from) / (2 * halves);
    for (int i = 0; i <= 2 * halves; ++i) {
      const double weight = (i == 0 || i == 2 * halves ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * h / 3;
      const double t = from + i * h;
      cosine += weight * std::cos(std::numbers::pi / 2 * t * t);
      sine += weight * std::sin(std::numbers::pi / 2 * t * t);
    }
    ASSERT_NEAR(fresnel(until).cosine, cosine, 2e-11) << until;
    ASSERT_NEAR(fresnel(until).sine, sine, 2e-11) << until;
    from = until;
  }
}

TEST(Fresnel, IsOddAndTendsToOneHalf) {
  EXPECT_EQ(fresnel(-1.5).cosine, -fresnel(1.5).cosine);
  EXPECT_EQ(fresnel(-40.0).sine, -fresnel(40.0).sine);
  EXPECT_EQ(fresnel(0.0).cosine, 0.0);
  // |C - 1/2| <= 1/(pi x) far out.
  EXPECT_NEAR(fresnel(90.0).cosine, 0.5, 1.0 / (std::numbers::pi * 90.0) + 1e-9);
  EXPECT_NEAR(fresnel(90.0).sine, 0.5, 1.0 / (std::numbers::pi * 90.0) + 1e-9);
}

}  // namespace
}  // namespace abn::harness
