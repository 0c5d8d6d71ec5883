#include "sampling/sph_blue_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <tuple>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn {
namespace {

static_assert(StrategyClass<SphBlueNoise>);

std::vector<Vec2f> all_samples(SphBlueNoise& sampler) {
  const Grid<PixelStats> pixels;
  const Feedback nothing{pixels};
  std::vector<Vec2f> samples;
  for (;;) {
    const SampleBatch batch = sampler.next(nothing);
    if (batch.empty()) break;
    EXPECT_LE(batch.position.size(), std::size_t{1} << 20);
    samples.insert(samples.end(), batch.position.begin(), batch.position.end());
  }
  EXPECT_TRUE(sampler.next(nothing).empty());
  return samples;
}

std::vector<Vec2f> sample(Extent plane, std::uint64_t budget, std::uint64_t seed, SphBlueNoise::Params params = {}) {
  SphBlueNoise sampler({.plane = plane, .budget = budget, .seed = seed}, params);
  return all_samples(sampler);
}

/// Distances between nearest neighbours on the torus, relative to that of the hexagonal lattice, r_max.
struct Spacing {
  double least = 0;
  double mean = 0;
};

Spacing nearest_neighbours(const std::vector<Vec2f>& points, Extent plane) {
  const double largest =
      std::sqrt(2 / std::sqrt(3.0) * static_cast<double>(plane.area()) / static_cast<double>(points.size()));
  Spacing spacing{1e9, 0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    float best = 1e30F;
    for (std::size_t j = 0; j < points.size(); ++j) {
      float dx = std::abs(points[i].x - points[j].x);
      float dy = std::abs(points[i].y - points[j].y);
      dx = std::min(dx, static_cast<float>(plane.width) - dx);
      dy = std::min(dy, static_cast<float>(plane.height) - dy);
      const float r2 = dx * dx + dy * dy;
      best = i != j && r2 < best ? r2 : best;
    }
    const double nearest = std::sqrt(double{best}) / largest;
    spacing.least = std::min(spacing.least, nearest);
    spacing.mean += nearest / static_cast<double>(points.size());
  }
  return spacing;
}

/// The largest power at the frequencies (k,0) and (0,k), k up to 2 sqrt N: where a square lattice shows. White is 1.
double largest_axis_power(const std::vector<Vec2f>& points, Extent plane) {
  const auto highest = static_cast<std::size_t>(2 * std::sqrt(static_cast<double>(points.size())));
  std::vector<std::complex<double>> x(highest + 1), y(highest + 1);
  for (const Vec2f p : points) {
    const auto turn_x = std::polar(1.0, 2 * std::numbers::pi * p.x / plane.width);
    const auto turn_y = std::polar(1.0, 2 * std::numbers::pi * p.y / plane.height);
    std::complex<double> at_x = 1, at_y = 1;
    for (std::size_t k = 1; k <= highest; ++k) {
      x[k] += at_x *= turn_x;
      y[k] += at_y *= turn_y;
    }
  }
  double largest = 0;
  for (std::size_t k = 1; k <= highest; ++k) largest = std::max({largest, std::norm(x[k]), std::norm(y[k])});
  return largest / static_cast<double>(points.size());
}

/// Area of {(x,y) in the unit square : a x + b y < c}: the polygon left after clipping.
double half_plane_area(double a, double b, double c) {
  const double corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  std::vector<std::pair<double, double>> polygon;
  for (int i = 0; i < 4; ++i) {
    const auto& [x0, y0] = corners[i];
    const auto& [x1, y1] = corners[(i + 1) % 4];
    const double f0 = a * x0 + b * y0 - c;
    const double f1 = a * x1 + b * y1 - c;
    if (f0 < 0) polygon.emplace_back(x0, y0);
    if ((f0 < 0) != (f1 < 0)) {
      const double t = f0 / (f0 - f1);
      polygon.emplace_back(x0 + t * (x1 - x0), y0 + t * (y1 - y0));
    }
  }
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto& [x0, y0] = polygon[i];
    const auto& [x1, y1] = polygon[(i + 1) % polygon.size()];
    twice += x0 * y1 - x1 * y0;
  }
  return std::abs(twice) / 2;
}

/// Root of the summed squared errors of 400 half-planes, the points shifted on the torus for each, relative to the
/// same of independent points: where long waves of the density show.
double half_plane_error(const std::vector<Vec2f>& points, Extent plane) {
  const double n = static_cast<double>(points.size());
  double error = 0;
  double white = 0;
  for (std::uint64_t t = 0; t < 400; ++t) {
    Rng rng(99, stream_id("half planes"), t);
    const Vec2f shift = rng.uniform2();
    const Vec2f through = rng.uniform2();
    const double angle = 2 * std::numbers::pi * rng.uniform();
    const double a = std::cos(angle);
    const double b = std::sin(angle);
    const double c = a * through.x + b * through.y;
    double inside = 0;
    for (const Vec2f p : points) {
      double x = double{p.x} / plane.width + double{shift.x};
      double y = double{p.y} / plane.height + double{shift.y};
      x -= x >= 1 ? 1 : 0;
      y -= y >= 1 ? 1 : 0;
      inside += a * x + b * y < c ? 1 : 0;
    }
    const double area = half_plane_area(a, b, c);
    error += (inside / n - area) * (inside / n - area);
    white += area * (1 - area) / n;
  }
  return std::sqrt(error / white);
}

TEST(SphBlueNoise, ReachesTheQualityOfTheDesign) {
  // numerics.md section 1, N = 4096 after 25 iterations: .772, .874, .125, 4 to 16.
  const Extent plane{64, 64};
  double least = 0, mean = 0, half_planes = 0, white_half_planes = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SphBlueNoise sampler({.plane = plane, .budget = 4096, .seed = seed}, {});
    const auto samples = all_samples(sampler);
    const Spacing spacing = nearest_neighbours(samples, plane);
    least += spacing.least / 5;
    mean += spacing.mean / 5;
    half_planes += half_plane_error(samples, plane) / 5;
    EXPECT_LE(largest_axis_power(samples, plane), 30) << "seed " << seed;
    for (const Diagnostic& d : sampler.diagnostics()) {
      if (d.name == "mean_displacement") {
        EXPECT_LT(d.value, 0.02);
      }
      EXPECT_FALSE(d.warning) << d.name;
    }
    white_half_planes += half_plane_error(sample(plane, 4096, seed, {.start = "white"}), plane) / 5;
  }
  RecordProperty("relative_radius", std::to_string(least));
  RecordProperty("mean_nearest_neighbour", std::to_string(mean));
  RecordProperty("half_plane_error", std::to_string(half_planes));
  EXPECT_GE(least, 0.70);
  EXPECT_GE(mean, 0.86);
  EXPECT_LE(half_planes, 0.16);
  EXPECT_GE(white_half_planes, 1.5 * half_planes) << "a white start keeps its long waves";
}

TEST(SphBlueNoise, MeasuresTellALatticeAndWhiteNoise) {
  // The bars above can fail: a fine jittered grid has power on the axes, white noise has relative half-plane error 1.
  const Extent plane{64, 64};
  std::vector<Vec2f> lattice, white;
  for (std::uint64_t i = 0; i < 4096; ++i) {
    Rng rng(5, 1, i);
    const Vec2f jitter = rng.uniform2() * 0.3F;
    lattice.push_back({static_cast<float>(i % 64) + jitter.x, static_cast<float>(i / 64) + jitter.y});
    white.push_back(to_plane(rng.uniform2(), plane));
  }
  EXPECT_GT(largest_axis_power(lattice, plane), 1000);
  EXPECT_NEAR(half_plane_error(white, plane), 1.0, 0.4);
  EXPECT_LT(nearest_neighbours(white, plane).mean, 0.5);
}

TEST(SphBlueNoise, EmitsExactlyTheBudgetInsideThePlaneInPixelOrder) {
  for (const auto& [width, height, budget] : {std::tuple{8U, 8U, 1U},
                                              {8U, 8U, 2U},
                                              {8U, 8U, 7U},
                                              {1U, 1U, 100U},
                                              {1U, 2000U, 500U},
                                              {2000U, 1U, 333U},
                                              {37U, 19U, 4001U},
                                              {1000U, 1000U, 50U}}) {
    const Extent plane{width, height};
    const auto samples = sample(plane, budget, 3);
    ASSERT_EQ(samples.size(), budget);
    std::uint64_t last = 0;
    for (const Vec2f p : samples) {
      ASSERT_TRUE(p.x >= 0 && p.x < static_cast<float>(width) && p.y >= 0 && p.y < static_cast<float>(height));
      const std::uint64_t pixel = static_cast<std::uint64_t>(p.y) * width + static_cast<std::uint64_t>(p.x);
      EXPECT_GE(pixel, last);
      last = pixel;
    }
  }
}

TEST(SphBlueNoise, IsReproducibleAndDependsOnTheSeed) {
  const Extent plane{20, 30};
  EXPECT_EQ(sample(plane, 600, 1), sample(plane, 600, 1));
  EXPECT_NE(sample(plane, 600, 1), sample(plane, 600, 2));
  EXPECT_NE(sample(plane, 600, 0), sample(plane, 600, ~std::uint64_t{0}));
}

TEST(SphBlueNoise, UsesTheSolverOfTheTaskAndNamesIt) {
  SamplingTask task{.plane = {16, 16}, .budget = 200};
  int made = 0;
  task.solver = [&](const sph::Setup& setup) {
    ++made;
    return sph::make_cpu_solver_double(setup);
  };
  SphBlueNoise sampler(task, {.tolerance = 0.02});
  EXPECT_TRUE(sampler.diagnostics().empty());
  all_samples(sampler);
  EXPECT_EQ(made, 1);
  const auto diagnostics = sampler.diagnostics();
  const auto find = [&](const char* name) {
    return *std::find_if(diagnostics.begin(), diagnostics.end(), [&](const Diagnostic& d) { return d.name == name; });
  };
  EXPECT_EQ(find("backend").text, "cpu double");
  EXPECT_EQ(find("converged").value, 1);
  EXPECT_LT(find("iterations").value, 25);  // a tolerance stops early
  EXPECT_LT(find("mean_displacement").value, 0.02);
}

TEST(SphBlueNoise, WarnsWhenTheRelaxationDoesNotSettle) {
  SphBlueNoise sampler({.plane = {16, 16}, .budget = 1000}, {.delta = 0.01, .step = 5, .iterations = 20});
  all_samples(sampler);
  int warnings = 0;
  for (const Diagnostic& d : sampler.diagnostics()) warnings += d.warning ? 1 : 0;
  EXPECT_GE(warnings, 1);
}

TEST(SphBlueNoise, RefusesImpossibleBudgets) {
  EXPECT_THROW(SphBlueNoise({.plane = {8, 8}, .budget = 0}, {}), ConfigError);
  EXPECT_THROW(SphBlueNoise({.plane = {8, 8}, .budget = std::uint64_t{1} << 32}, {}), ConfigError);
}

TEST(CoarseCells, GiveEveryCellItsShareWithinOne) {
  const auto check = [](Extent plane, std::uint64_t count, std::uint32_t columns, std::uint32_t rows) {
    const auto positions = coarse_cell_positions(plane, count, 1);
    ASSERT_EQ(positions.size(), count);
    std::vector<std::uint64_t> counts(std::size_t{columns} * rows, 0);
    for (const Vec2f p : positions) {
      ASSERT_TRUE(p.x >= 0 && p.x < static_cast<float>(plane.width) && p.y >= 0 &&
                  p.y < static_cast<float>(plane.height));
      const auto column = static_cast<std::size_t>(double{p.x} * columns / plane.width);
      const auto row = static_cast<std::size_t>(double{p.y} * rows / plane.height);
      ++counts[row * columns + column];
    }
    const auto [least, most] = std::minmax_element(counts.begin(), counts.end());
    EXPECT_LE(*most - *least, 1U);
  };
  check({64, 64}, 4096, 16, 16);
  check({64, 64}, 4100, 16, 16);
  check({1, 2048}, 1024, 1, 64);
  check({256, 64}, 16 * 64, 16, 4);
  check({8, 8}, 1, 1, 1);
}

}  // namespace
}  // namespace abn
