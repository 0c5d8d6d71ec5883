#include "sampling/analysis/integration_error.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>

#include "sampling/draw_for_tests.h"
#include "sampling/error.h"
#include "sampling/jitter.h"
#include "sampling/random.h"
#include "sampling/rng.h"
#include "sampling/sobol_owen.h"

namespace abn::analysis {
namespace {

TEST(IntegrationError, HalfPlanesGiveTheValuesOfTheSphTests) {
  // The sets of sph_blue_noise_test.cpp, and what its own half_plane_error() measures of them.
  const Extent plane{64, 64};
  std::vector<Vec2f> lattice, white;
  for (std::uint64_t i = 0; i < 4096; ++i) {
    Rng rng(5, 1, i);
    const Vec2f jitter = rng.uniform2() * 0.3F;
    const std::uint64_t row = i / 64;
    lattice.push_back({static_cast<float>(i % 64) + jitter.x, static_cast<float>(row) + jitter.y});
    white.push_back(to_plane(rng.uniform2(), plane));
  }
  EXPECT_NEAR(integration_error(to_unit(lattice, plane)).half_planes, 0.49533295681584011, 1e-9);
  EXPECT_NEAR(integration_error(to_unit(white, plane)).half_planes, 1.0589951563886126, 1e-9);
}

TEST(IntegrationError, IsOneForWhiteNoise) {
  // The expectation of the square is 1 exactly; one set's square varies by about 0.3.
  IntegrationError mean;
  constexpr int sets = 60;
  for (std::uint64_t seed = 1; seed <= sets; ++seed) {
    const auto e = integration_error(to_unit(draw<Random>({1, 1}, 500, seed), {1, 1}));
    mean.half_planes += e.half_planes * e.half_planes / sets;
    mean.gaussians += e.gaussians * e.gaussians / sets;
    mean.discs += e.discs * e.discs / sets;
  }
  EXPECT_NEAR(mean.half_planes, 1, 0.15);
  EXPECT_NEAR(mean.gaussians, 1, 0.15);
  EXPECT_NEAR(mean.discs, 1, 0.15);
}

TEST(IntegrationError, IntegralsAreExact) {
  // A wrong integral would leave an error that grows with sqrt(N) relative to white noise; a lattice's shrinks or
  // stays.
  const auto lattice = [](int side) {
    std::vector<Point> points;
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) points.push_back({(x + 0.5) / side, (y + 0.5) / side});
    }
    return integration_error(points);
  };
  const IntegrationError coarse = lattice(16);
  const IntegrationError fine = lattice(128);
  EXPECT_LT(fine.half_planes, 1.3 * coarse.half_planes);
  EXPECT_LT(fine.gaussians, 1.3 * coarse.gaussians);
  EXPECT_LT(fine.discs, 0.5 * coarse.discs);
}

TEST(IntegrationError, SetsHaveTheirAnchors) {
  // N = 4096, 5 seeds, measured with other integrands of the same classes (half-planes, Gaussians, discs): white 1.07,
  // 1.10, 1.15 (+- .1); jitter .184, .091, .163 (+- .003); Owen .106, .024, .139 (+- .003).
  IntegrationError jitter, owen;
  constexpr int sets = 5;
  for (std::uint64_t seed = 1; seed <= sets; ++seed) {
    const auto j = integration_error(to_unit(draw<JitterPlane>({1, 1}, 4096, seed), {1, 1}));
    const auto o = integration_error(to_unit(draw<SobolOwen>({1, 1}, 4096, seed, {.domain = "plane"}), {1, 1}));
    jitter.half_planes += j.half_planes / sets;
    jitter.gaussians += j.gaussians / sets;
    jitter.discs += j.discs / sets;
    owen.half_planes += o.half_planes / sets;
    owen.gaussians += o.gaussians / sets;
    owen.discs += o.discs / sets;
  }
  const auto words = [](const IntegrationError& e) {
    return std::to_string(e.half_planes) + " " + std::to_string(e.gaussians) + " " + std::to_string(e.discs);
  };
  RecordProperty("jitter", words(jitter));
  RecordProperty("owen", words(owen));
  EXPECT_NEAR(jitter.half_planes, 0.184, 0.015);
  EXPECT_NEAR(jitter.gaussians, 0.091, 0.009);
  EXPECT_NEAR(jitter.discs, 0.163, 0.015);
  EXPECT_NEAR(owen.half_planes, 0.106, 0.01);
  EXPECT_NEAR(owen.gaussians, 0.024, 0.004);
  EXPECT_NEAR(owen.discs, 0.139, 0.012);
}

TEST(IntegrationError, DoesNotDependOnTheNumberOfThreads) {
  const auto points = to_unit(draw<Random>({1, 1}, 1000, 3), {1, 1});
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const IntegrationError one = integration_error(points);
  omp_set_num_threads(3);
  const IntegrationError three = integration_error(points);
  omp_set_num_threads(threads);
  EXPECT_EQ(one.half_planes, three.half_planes);
  EXPECT_EQ(one.gaussians, three.gaussians);
  EXPECT_EQ(one.discs, three.discs);
}

TEST(IntegrationError, RefusesAnEmptySet) { EXPECT_THROW(integration_error(Points{}), ConfigError); }

}  // namespace
}  // namespace abn::analysis
