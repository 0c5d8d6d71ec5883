#include "harness/density_reconstruction.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/reconstruction_cases.h"

namespace abn::harness {
namespace {

void ramp(Vec2f p, float* value) { value[0] = p.x - std::floor(p.x); }

// Independent samples with density 1 + .9 sin(2 pi x) along x.
std::vector<Vec2f> wavy_samples(Extent plane, std::size_t count, std::uint64_t seed) {
  std::vector<Vec2f> position;
  Rng rng(seed, stream_id("density_reconstruction_test"));
  while (position.size() < count) {
    const Vec2f unit = rng.uniform2();
    const Vec2f at = to_plane(unit, plane);
    if (1.9F * rng.uniform() < 1 + 0.9F * std::sin(2 * std::numbers::pi_v<float> * at.x)) position.push_back(at);
  }
  return position;
}

TEST(DensityReconstruction, DensitiesAreThoseOfBruteForce) {
  const Extent plane{5, 4};
  const SampleBins bins(film_of(plane, 1, scattered(plane, 160, 1), ramp));
  const std::vector<float> densities = sample_densities(bins);
  for (std::size_t i = 0; i < bins.size(); ++i) {
    std::vector<double> distance;
    for (std::size_t j = 0; j < bins.size(); ++j) {
      const double x = double{bins.x()[j]};
      const double y = double{bins.y()[j]};
      for (const double u : {x, -x, 10 - x}) {
        for (const double v : {y, -y, 8 - y})
          distance.push_back(std::hypot(u - double{bins.x()[i]}, v - double{bins.y()[i]}));
      }
    }
    std::sort(distance.begin(), distance.end());
    const double support = distance[12];
    double sum = 0;
    for (int k = 0; k < 12; ++k)
      sum += std::pow(1 - distance[static_cast<std::size_t>(k)] / support, 4) *
             (1 + 4 * distance[static_cast<std::size_t>(k)] / support);
    EXPECT_NEAR(double{densities[i]} / (7 / std::numbers::pi * sum / (support * support)), 1, 1e-4) << i;
  }
}

TEST(DensityReconstruction, IsNearlyTheMeanForUniformSamples) {
  const Extent plane{30, 30};
  const auto position = jittered(plane, 4, 4, 2);
  const SampleBins bins(film_of(plane, 1, position, ramp));
  const std::vector<float> densities = sample_densities(bins);
  double mean = 0;
  double border = 0;
  std::size_t at_border = 0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    mean += double{densities[i]};
    if (bins.x()[i] > 0.5F) continue;
    border += double{densities[i]};
    ++at_border;
  }
  mean /= static_cast<double>(bins.size());
  EXPECT_NEAR(mean, 16, 5);  // a sample counts itself: 20 % too much, which the ratio of sums does not see
  EXPECT_NEAR(border / static_cast<double>(at_border) / mean, 1, 0.08);
  const Film film = film_of(plane, 1, position, ramp);
  const Image weighted = density_weighted(film).image;
  const Image plain = film.develop().image;
  double squares = 0;
  for (std::size_t p = 0; p < plane.area(); ++p)
    squares += std::pow(double{weighted.texels[p]} - double{plain.texels[p]}, 2);
  EXPECT_LT(std::sqrt(squares / 900), 0.04);  // the samples' own deviation is .29
}

TEST(DensityReconstruction, TakesTheBiasOutOfTheMean) {
  const Extent plane{8, 8};
  const Film film = film_of(plane, 1, wavy_samples(plane, 150 * plane.area(), 3), ramp);
  const auto bias = [](const Image& image) {
    double sum = 0;
    for (const float texel : image.texels) sum += double{texel} - 0.5;
    return sum / static_cast<double>(image.texels.size());
  };
  EXPECT_NEAR(bias(film.develop().image), -0.9 / (2 * std::numbers::pi), 0.02);
  EXPECT_LT(std::abs(bias(density_weighted(film).image)), 0.045);
}

TEST(DensityReconstruction, IsExactForConstantsAndStandsHardSamples) {
  const Extent plane{8, 3};
  std::vector<std::vector<Vec2f>> sets(5);
  for (int k = 0; k < 300; ++k) sets[0].push_back({static_cast<float>(k % 7) + 0.5F, 1.25F});
  sets[1] = scattered({1, 1}, 5000, 4);
  sets[2] = {{3.5F, 1.5F}};
  sets[3] = jittered(plane, 7, 6, 5);
  sets[4] = {{0.0F, 0.0F}, {7.9F, 2.9F}};
  for (const auto& set : sets) {
    const Developed developed = density_weighted(film_of(plane, 1, set, [](Vec2f, float* value) { value[0] = 1e4F; }));
    for (const float texel : developed.image.texels) EXPECT_EQ(texel, 1e4F);
  }
  EXPECT_EQ(density_weighted(film_of(plane, 1, sets[2], ramp)).empty_pixels, 23U);
  const Film thin = film_of({1, 30}, 1, jittered({1, 30}, 3, 3, 6), ramp);
  EXPECT_TRUE(all_finite(density_weighted(thin)));
}

TEST(DensityReconstruction, IsTheSameForAnyNumberOfThreads) {
  const Extent plane{40, 30};
  const Film film = film_of(plane, 1, scattered(plane, 9000, 7), ramp);
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const Developed one = density_weighted(film);
  omp_set_num_threads(5);
  const Developed five = density_weighted(film);
  omp_set_num_threads(before);
  EXPECT_EQ(one.image.texels, five.image.texels);
}

}  // namespace
}  // namespace abn::harness
