#include "harness/edge_reconstruction.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "harness/reconstruction_cases.h"
#include "sampling/kriging/step_rules.h"

namespace abn::harness {
namespace {

// A step of height .7 across a line at 21 degrees, off the pixel grid, on a slope.
void slanted_step(Vec2f p, float* value) {
  value[0] = (0.3584F * p.x + 0.9336F * p.y > 14.37F ? 0.9F : 0.2F) + 0.003F * p.x;
}

TEST(EdgeReconstruction, HalfPlaneShareIsWhatCountingFinds) {
  Rng rng(1, stream_id("edge_reconstruction_test"));
  for (int k = 0; k < 200; ++k) {
    const float angle = 6.3F * rng.uniform();
    const float c = k < 4 ? static_cast<float>(k % 2) : std::cos(angle);
    const float s = k < 4 ? 1 - c : std::sin(angle);
    const float offset = 3 * rng.uniform() - 1.5F;
    int inside = 0;
    constexpr int n = 200;
    for (int v = 0; v < n; ++v) {
      for (int u = 0; u < n; ++u)
        inside +=
            static_cast<int>(c * (static_cast<float>(u) + 0.5F) + s * (static_cast<float>(v) + 0.5F) < offset * n);
    }
    EXPECT_NEAR(step_rules::half_plane_share(c, s, offset), static_cast<double>(inside) / (n * n), 0.006)
        << c << ' ' << s;
  }
}

TEST(EdgeReconstruction, IntegratesAStraightStepFarBetterThanKriging) {
  const Extent plane{24, 24};
  // The more samples, the narrower the gap in which the line must lie: its error falls faster than kriging's.
  for (const std::uint32_t side : {3U, 5U}) {
    double with = 0;
    double without = 0;
    for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
      const Film film = film_of(plane, 1, jittered(plane, side, side - 1, seed), slanted_step);
      with += error_of(edge(film).image, slanted_step);
      without += error_of(kriging(film).image, slanted_step);
    }
    EXPECT_LT(with, (side == 3 ? 0.75 : 0.55) * without);
  }
}

TEST(EdgeReconstruction, FindsTheStepAndWhatItIs) {
  const Extent plane{24, 24};
  const SampleBins bins(film_of(plane, 1, jittered(plane, 3, 2, 4), slanted_step));
  const Grid<PixelStep> steps = find_steps(bins);
  double squares = 0;
  double estimated = 0;
  int found = 0;
  for (std::uint32_t y = 0; y < plane.height; ++y) {
    for (std::uint32_t x = 0; x < plane.width; ++x) {
      const float share =
          1 - step_rules::half_plane_share(0.3584F, 0.9336F,
                                           14.37F - 0.3584F * static_cast<float>(x) - 0.9336F * static_cast<float>(y));
      const PixelStep& step = steps.at(x, y);
      // Pixels that the line only grazes may look flat.
      EXPECT_TRUE(step.found || share < 0.15F || share > 0.85F) << x << ' ' << y;
      if (share == 0 || share == 1 || !step.found) continue;
      ++found;
      EXPECT_NEAR(step.jump[0], 0.7F, 0.02F);
      EXPECT_GT(step.threshold, 0.3F);
      EXPECT_LT(step.threshold, 0.9F);
      squares += (double{step.share} - double{share}) * (double{step.share} - double{share});
      estimated += double{step.share_error} * double{step.share_error};
    }
  }
  ASSERT_GT(found, 15);
  EXPECT_LT(std::sqrt(squares / found), 0.05);
  // The spread over the separating lines is the error to be expected.
  EXPECT_NEAR(std::sqrt(estimated / squares), 1, 0.4);
}

TEST(EdgeReconstruction, IsKrigingWhereThereIsNoStep) {
  const Extent plane{20, 15};
  const auto waves = [](Vec2f p, float* value) { value[0] = std::sin(1.9F * p.x) * std::cos(2.3F * p.y); };
  const Film film = film_of(plane, 1, jittered(plane, 3, 2, 5), waves);
  const Grid<PixelStep> steps = find_steps(SampleBins(film));
  EXPECT_LT(std::count_if(steps.cells().begin(), steps.cells().end(), [](const PixelStep& s) { return s.found; }), 3);
  const auto noise = [](Vec2f p, float* value) {
    value[0] = std::fmod(std::abs(std::sin(1234.5F * p.x + 71.7F * p.y)) * 1000, 1.0F);
  };
  const Film noisy = film_of(plane, 1, jittered(plane, 3, 2, 6), noise);
  EXPECT_EQ(edge(noisy).image.texels, kriging(noisy).image.texels);
}

TEST(EdgeReconstruction, CannotSeparateWhatNoLineSeparates) {
  const Extent plane{12, 12};
  const auto dots = [](Vec2f p, float* value) {
    value[0] = std::hypot(p.x - std::floor(p.x) - 0.5F, p.y - std::floor(p.y) - 0.5F) < 0.3F ? 1 : 0;
  };
  const Grid<PixelStep> steps = find_steps(SampleBins(film_of(plane, 1, jittered(plane, 6, 6, 7), dots)));
  EXPECT_FALSE(std::any_of(steps.cells().begin(), steps.cells().end(), [](const PixelStep& s) { return s.found; }));
}

TEST(EdgeReconstruction, TreatsChannelsByTheirOwnJump) {
  const Extent plane{16, 16};
  const auto position = jittered(plane, 3, 2, 8);
  const auto colour = [](Vec2f p, float* value) {
    float step = 0;
    slanted_step(p, &step);
    value[0] = step;
    value[1] = 2 * step;
    value[2] = 1 - step;
  };
  const Image three = edge(film_of(plane, 3, position, colour)).image;
  const Image one = edge(film_of(plane, 1, position, slanted_step)).image;
  for (std::size_t p = 0; p < plane.area(); ++p) {
    EXPECT_NEAR(three.texels[3 * p], one.texels[p], 1e-5F);
    EXPECT_NEAR(three.texels[3 * p + 1], 2 * one.texels[p], 2e-5F);
    EXPECT_NEAR(three.texels[3 * p + 2], 1 - one.texels[p], 1e-5F);
  }
}

TEST(EdgeReconstruction, IsExactForConstantsAndStandsHardSamples) {
  const Extent plane{8, 3};
  const Film flat = film_of(plane, 1, jittered(plane, 3, 3, 9), [](Vec2f, float* value) { value[0] = 0.3F; });
  for (const float texel : edge(flat).image.texels) EXPECT_EQ(texel, 0.3F);
  std::vector<std::vector<Vec2f>> sets(4);
  for (int k = 0; k < 300; ++k) sets[0].push_back({static_cast<float>(k % 7) + 0.5F, 1.25F});
  sets[1] = scattered({2, 1}, 5000, 10);
  sets[2] = {{3.5F, 1.5F}};
  sets[3] = jittered(plane, 7, 6, 11);
  for (const auto& set : sets) {
    const Developed developed =
        edge(film_of(plane, 1, set, [](Vec2f p, float* value) { value[0] = p.x + p.y < 2.3F ? 1e4F : 0.5F; }));
    EXPECT_TRUE(all_finite(developed));
    for (const float texel : developed.image.texels) EXPECT_NEAR(texel, 5e3F, 8e3F);
  }
}

TEST(EdgeReconstruction, IsTheSameForAnyNumberOfThreads) {
  const Extent plane{40, 30};
  const Film film = film_of(plane, 1, scattered(plane, 9000, 12), slanted_step);
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const Developed one = edge(film);
  omp_set_num_threads(5);
  const Developed five = edge(film);
  omp_set_num_threads(before);
  EXPECT_EQ(one.image.texels, five.image.texels);
}

}  // namespace
}  // namespace abn::harness
