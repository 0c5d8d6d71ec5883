#include "harness/voronoi_reconstruction.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <limits>

#include "harness/reconstruction_cases.h"

namespace abn::harness {
namespace {

void waves(Vec2f p, float* value) { value[0] = std::sin(2.1F * p.x + 0.3F) * std::cos(3.3F * p.y); }

// The mean over a fine grid of points in the pixel of the nearest sample's value.
double counted(const std::vector<Vec2f>& position, const TestFunction& function, std::uint32_t x, std::uint32_t y) {
  constexpr int n = 60;
  double sum = 0;
  for (int v = 0; v < n; ++v) {
    for (int u = 0; u < n; ++u) {
      const float px = static_cast<float>(x) + (static_cast<float>(u) + 0.5F) / n;
      const float py = static_cast<float>(y) + (static_cast<float>(v) + 0.5F) / n;
      float best = std::numeric_limits<float>::max();
      Vec2f nearest;
      for (const Vec2f p : position) {
        const float squared = (p.x - px) * (p.x - px) + (p.y - py) * (p.y - py);
        if (squared < best) {
          best = squared;
          nearest = p;
        }
      }
      float value = 0;
      function(nearest, &value);
      sum += double{value};
    }
  }
  return sum / (n * n);
}

TEST(VoronoiReconstruction, AgreesWithCountingNearestSamples) {
  const Extent plane{5, 4};
  for (const std::size_t count : {3U, 12U, 120U, 900U}) {
    const auto position = scattered(plane, count, count);
    const Developed developed = voronoi(film_of(plane, 1, position, waves));
    for (std::uint32_t p = 0; p < plane.area(); ++p) {
      EXPECT_NEAR(double{developed.image.texels[p]}, counted(position, waves, p % 5, p / 5), 0.02) << count << ' ' << p;
    }
  }
}

TEST(VoronoiReconstruction, HasHalfPlanesOfTwoSamples) {
  const auto upper = [](Vec2f p, float* value) { value[0] = p.y < 0.5F ? 1 : 0; };
  const Developed developed = voronoi(film_of({1, 1}, 1, {{0.5F, 0.25F}, {0.5F, 0.5F}}, upper));
  EXPECT_FLOAT_EQ(developed.image.texels[0], 0.375F);
}

TEST(VoronoiReconstruction, BeatsTheMeanOfScatteredSamples) {
  const Extent plane{20, 20};
  const Film film = film_of(plane, 1, scattered(plane, 6 * plane.area(), 4), waves);
  EXPECT_LT(error_of(voronoi(film).image, waves), 0.65 * error_of(film.develop().image, waves));
}

TEST(VoronoiReconstruction, IsExactForConstantsAndStandsHardSamples) {
  const Extent plane{8, 3};
  std::vector<std::vector<Vec2f>> sets(7);
  for (int k = 0; k < 300; ++k) sets[0].push_back({static_cast<float>(k % 7) + 0.5F, 1.25F});
  sets[1] = scattered({1, 1}, 5000, 5);
  sets[2] = {{3.5F, 1.5F}};
  sets[3] = jittered(plane, 7, 6, 6);
  sets[4] = std::vector<Vec2f>(5000, Vec2f{4.125F, 1.5F});
  for (int k = 0; k < 1500; ++k)
    sets[5].push_back({2.5F + 1e-4F * static_cast<float>(k % 50), 1.5F + 1e-5F * static_cast<float>(k)});
  for (int k = 0; k < 1536; ++k)
    sets[6].push_back({(static_cast<float>(k % 64) + 0.5F) / 8, (static_cast<float>(k / 64) + 0.5F) / 8});
  for (const auto& set : sets) {
    const Developed flat =
        voronoi(film_of(plane, 3, set, [](Vec2f, float* value) { value[0] = value[1] = value[2] = 1e4F; }));
    for (const float texel : flat.image.texels) EXPECT_EQ(texel, 1e4F);
    const Developed developed = voronoi(film_of(plane, 1, set, waves));
    for (const float texel : developed.image.texels) EXPECT_LE(std::abs(texel), 1.0001F);
  }
  EXPECT_EQ(voronoi(film_of(plane, 1, sets[2], waves)).empty_pixels, 23U);
}

// The areas of a regular lattice's cells are equal, whichever way they are found.
TEST(VoronoiReconstruction, IsTheMeanOnALattice) {
  const Extent plane{4, 4};
  std::vector<Vec2f> lattice;
  for (int k = 0; k < 1024; ++k)
    lattice.push_back({(static_cast<float>(k % 32) + 0.5F) / 8, (static_cast<float>(k / 32) + 0.5F) / 8});
  const Film film = film_of(plane, 1, lattice, waves);
  const Image cells = voronoi(film).image;
  const Image mean = film.develop().image;
  for (std::size_t p = 0; p < 16; ++p) EXPECT_NEAR(cells.texels[p], mean.texels[p], 1e-6F);
}

TEST(VoronoiReconstruction, IsTheSameForAnyNumberOfThreads) {
  const Extent plane{40, 30};
  const Film film = film_of(plane, 1, scattered(plane, 9000, 7), waves);
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const Developed one = voronoi(film);
  omp_set_num_threads(5);
  const Developed five = voronoi(film);
  omp_set_num_threads(before);
  EXPECT_EQ(one.image.texels, five.image.texels);
}

}  // namespace
}  // namespace abn::harness
