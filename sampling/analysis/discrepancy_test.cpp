#include "sampling/analysis/discrepancy.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "sampling/draw_for_tests.h"
#include "sampling/error.h"
#include "sampling/jitter.h"
#include "sampling/random.h"
#include "sampling/rng.h"
#include "sampling/sobol_owen.h"

namespace abn::analysis {
namespace {

std::vector<Point> white_noise(std::size_t count, std::uint64_t seed) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(seed, stream_id("discrepancy test"), i);
    const double x = rng.next() * 0x1p-32;
    points.push_back({x, rng.next() * 0x1p-32});
  }
  return points;
}

/// Every box whose borders are coordinates or 1, open and closed, counted one by one.
double star_by_brute_force(Points points) {
  std::vector<double> xs{1};
  std::vector<double> ys{1};
  for (const Point& p : points) {
    xs.push_back(p.x);
    ys.push_back(p.y);
  }
  double worst = 0;
  for (const double x : xs) {
    for (const double y : ys) {
      double open = 0;
      double closed = 0;
      for (const Point& p : points) {
        open += p.x < x && p.y < y ? 1 : 0;
        closed += p.x <= x && p.y <= y ? 1 : 0;
      }
      const auto n = static_cast<double>(points.size());
      worst = std::max({worst, std::abs(open / n - x * y), std::abs(closed / n - x * y)});
    }
  }
  return worst;
}

/// The square of the L2 star discrepancy in one dimension.
double star_1d_squared(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  double single = 0;
  double pairs = 0;
  for (const double a : values) {
    single += 1 - a * a;
    for (const double b : values) pairs += 1 - std::max(a, b);
  }
  return 1.0 / 3 - single / n + pairs / (n * n);
}

TEST(StarDiscrepancy, OfOnePointByHand) {
  EXPECT_DOUBLE_EQ(star_discrepancy(std::vector<Point>{{0.5, 0.5}}), 0.75);  // closed at the point: 1 - 1/4
  EXPECT_DOUBLE_EQ(star_discrepancy(std::vector<Point>{{0.9, 0.8}}), 0.9);   // open: empty up to x = 0.9
  EXPECT_DOUBLE_EQ(star_discrepancy(std::vector<Point>{{0, 0}}), 1);
}

TEST(StarDiscrepancy, AgreesWithBruteForce) {
  for (const std::size_t count : {2U, 3U, 17U, 100U}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      auto points = white_noise(count, seed);
      EXPECT_NEAR(star_discrepancy(points), star_by_brute_force(points), 1e-13);
      for (Point& p : points) p = {std::floor(8 * p.x) / 8, std::floor(8 * p.y) / 8};  // many ties, and zeros
      EXPECT_NEAR(star_discrepancy(points), star_by_brute_force(points), 1e-13);
    }
  }
}

TEST(StarDiscrepancy, RefusesWhatItCannotDo) {
  EXPECT_THROW(star_discrepancy(Points{}), ConfigError);
  EXPECT_THROW(star_discrepancy(std::vector<Point>(max_star_discrepancy_points + 1, Point{0.5, 0.5})), ConfigError);
}

TEST(L2Discrepancies, OfOnePointByHand) {
  const L2Discrepancies d = l2_discrepancies(std::vector<Point>{{0.5, 0.5}});
  EXPECT_NEAR(d.star, std::sqrt(1.0 / 9 - 2 * 0.375 * 0.375 + 0.25), 1e-15);
  EXPECT_NEAR(d.centred, std::sqrt(169.0 / 144 - 2 + 1), 1e-15);
  EXPECT_NEAR(d.wraparound, std::sqrt(9.0 / 4 - 16.0 / 9), 1e-15);
  EXPECT_NEAR(d.generalised, std::sqrt(16.0 / 9 - 2 * 1.375 * 1.375 + 2.25), 1e-15);
  EXPECT_NEAR(d.unanchored, std::sqrt(1.0 / 144 + 1.0 / 32), 1e-15);
  EXPECT_NEAR(d.symmetric, std::sqrt(16.0 / 9 - 2 * 1.5 * 1.5 + 4), 1e-15);
}

TEST(L2Discrepancies, AgreeWithSciPy) {
  // scipy.stats.qmc.discrepancy of SciPy 1.10.1, methods L2-star, CD, WD; the roots of the last two.
  const std::vector<Point> two{{0.2, 0.3}, {0.7, 0.6}};
  const L2Discrepancies of_two = l2_discrepancies(two);
  EXPECT_NEAR(of_two.star, 0.20275875100994048, 1e-14);
  EXPECT_NEAR(of_two.centred, 0.26760252448568395, 1e-14);
  EXPECT_NEAR(of_two.wraparound, 0.3917553091181053, 1e-14);
  const std::vector<Point> seven{{.1, .7}, {.25, .05}, {.4, .9}, {.55, .3}, {.8, .6}, {.95, .15}, {.6, .85}};
  const L2Discrepancies of_seven = l2_discrepancies(seven);
  EXPECT_NEAR(of_seven.star, 0.079864450782974772, 1e-14);
  EXPECT_NEAR(of_seven.centred, 0.10719410150201865, 1e-14);
  EXPECT_NEAR(of_seven.wraparound, 0.15675773514676936, 1e-14);
}

TEST(L2Discrepancies, MeetTheirDefinitions) {
  // Integrals over a midpoint grid of boxes; the integrands jump, hence the wide tolerance.
  const auto points = white_noise(9, 2);
  const L2Discrepancies d = l2_discrepancies(points);
  constexpr int cells = 200;
  double star = 0;
  double even = 0;  // both coordinates below the corner, or both above
  for (int i = 0; i < cells * cells; ++i) {
    const int row = i / cells;
    const double x = (i % cells + 0.5) / cells;
    const double y = (row + 0.5) / cells;
    double in_box = 0;
    double in_even = 0;
    for (const Point& p : points) {
      in_box += p.x < x && p.y < y ? 1 : 0;
      in_even += (p.x < x) == (p.y < y) ? 1 : 0;
    }
    const double box = in_box / 9 - x * y;
    const double union_of_boxes = in_even / 9 - x * y - (1 - x) * (1 - y);
    star += box * box / (cells * cells);
    even += union_of_boxes * union_of_boxes / (cells * cells);
  }
  std::vector<double> xs, ys;
  for (const Point& p : points) {
    xs.push_back(p.x);
    ys.push_back(p.y);
  }
  const double projections = star_1d_squared(xs) + star_1d_squared(ys);
  EXPECT_NEAR(d.star, std::sqrt(star), 0.003);
  EXPECT_NEAR(d.generalised * d.generalised, d.star * d.star + projections, 1e-14);
  EXPECT_NEAR(d.symmetric, std::sqrt(4 * (projections + even)), 0.006);

  constexpr int steps = 24;
  double unanchored = 0;
  for (int i = 0; i < steps * steps; ++i) {
    for (int j = 0; j < steps * steps; ++j) {
      const int end_x = i / steps;
      const int end_y = j / steps;
      const double x0 = (i % steps + 0.25) / steps;  // starts and ends interleave: none is empty or counted twice
      const double x1 = (end_x + 0.75) / steps;
      const double y0 = (j % steps + 0.25) / steps;
      const double y1 = (end_y + 0.75) / steps;
      if (x0 >= x1 || y0 >= y1) continue;
      double inside = 0;
      for (const Point& p : points) inside += p.x >= x0 && p.x < x1 && p.y >= y0 && p.y < y1 ? 1 : 0;
      const double difference = inside / 9 - (x1 - x0) * (y1 - y0);
      unanchored += difference * difference;
    }
  }
  EXPECT_NEAR(d.unanchored, std::sqrt(unanchored) / (steps * steps), 0.004);
}

TEST(L2Discrepancies, WraparoundDoesNotChangeWithAShift) {
  auto points = white_noise(300, 3);
  const L2Discrepancies before = l2_discrepancies(points);
  for (Point& p : points) p = {std::fmod(p.x + 0.37, 1.0), std::fmod(p.y + 0.81, 1.0)};
  const L2Discrepancies after = l2_discrepancies(points);
  EXPECT_NEAR(after.wraparound, before.wraparound, 1e-12);
  EXPECT_GT(std::abs(after.star - before.star), 1e-5);
}

TEST(L2Discrepancies, ReflectionChangesOnlyTheAnchored) {
  auto points = white_noise(301, 4);
  const L2Discrepancies before = l2_discrepancies(points);
  for (Point& p : points) p.x = 1 - p.x;
  const L2Discrepancies after = l2_discrepancies(points);
  EXPECT_NEAR(after.centred, before.centred, 1e-12);
  EXPECT_NEAR(after.wraparound, before.wraparound, 1e-12);
  EXPECT_NEAR(after.unanchored, before.unanchored, 1e-12);
  EXPECT_NEAR(after.symmetric, before.symmetric, 1e-12);
  EXPECT_GT(std::abs(after.star - before.star), 1e-5);
}

TEST(Discrepancy, SetsHaveTheirAnchors) {
  // Means of 5 seeds at N = 4096, measured with other code, L2 star and star: Owen .000195, .00111; jitter .00080,
  // .0052; white .0054, .019.
  double star[3] = {};
  double l2[3] = {};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const std::vector<Point> sets[3] = {
        to_unit(draw<SobolOwen>({1, 1}, 4096, seed, {.domain = "plane"}), {1, 1}),
        to_unit(draw<JitterPlane>({1, 1}, 4096, seed), {1, 1}),
        to_unit(draw<Random>({1, 1}, 4096, seed), {1, 1}),
    };
    for (int k = 0; k < 3; ++k) {
      star[k] += star_discrepancy(sets[k]) / 3;
      l2[k] += l2_discrepancies(sets[k]).star / 3;
    }
  }
  for (int k = 0; k < 3; ++k) {
    RecordProperty("star_" + std::to_string(k), std::to_string(star[k]));
    RecordProperty("l2_star_" + std::to_string(k), std::to_string(l2[k]));
  }
  EXPECT_NEAR(star[0], 0.00111, 0.0001);
  EXPECT_NEAR(l2[0], 0.000195, 0.000015);
  EXPECT_NEAR(star[1], 0.0052, 0.0007);
  EXPECT_NEAR(l2[1], 0.00080, 0.0001);
  EXPECT_NEAR(star[2], 0.019, 0.006);
  EXPECT_NEAR(l2[2], 0.0054, 0.0018);
}

TEST(L2Discrepancies, WhiteNoiseHasItsExpectation) {
  // E[L2 star^2] = (1/4 - 1/9) / N exactly.
  double squares = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const double d = l2_discrepancies(white_noise(256, seed)).star;
    squares += d * d / 200;
  }
  EXPECT_NEAR(squares * 256 / (1.0 / 4 - 1.0 / 9), 1, 0.2);  // the relative standard error is about 0.05
}

TEST(Discrepancy, DoesNotDependOnTheNumberOfThreads) {
  const auto points = white_noise(3000, 8);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const L2Discrepancies one = l2_discrepancies(points);
  const double star_one = star_discrepancy(points);
  omp_set_num_threads(3);
  const L2Discrepancies three = l2_discrepancies(points);
  const double star_three = star_discrepancy(points);
  omp_set_num_threads(threads);
  EXPECT_EQ(star_one, star_three);
  EXPECT_EQ(one.star, three.star);
  EXPECT_EQ(one.centred, three.centred);
  EXPECT_EQ(one.wraparound, three.wraparound);
  EXPECT_EQ(one.generalised, three.generalised);
  EXPECT_EQ(one.unanchored, three.unanchored);
  EXPECT_EQ(one.symmetric, three.symmetric);
}

TEST(L2Discrepancies, RefuseAnEmptySet) { EXPECT_THROW(l2_discrepancies(Points{}), ConfigError); }

}  // namespace
}  // namespace abn::analysis
