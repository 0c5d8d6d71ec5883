#include "harness/reconstruction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "harness/reconstruction_cases.h"
#include "harness/standard_error.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

TEST(Reconstruction, TableHasTheRowsInOrder) {
  std::vector<std::string> names;
  for (const Reconstruction& row : reconstructions()) {
    names.push_back(row.name);
    EXPECT_FALSE(row.summary.empty());
    EXPECT_EQ(&find_reconstruction(row.name), &row);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"mean", "density", "voronoi", "kriging", "edge", "kriging_tonemapped"}));
  EXPECT_THROW(find_reconstruction("median"), ConfigError);
}

// What every row promises, on every kind of sample set.
TEST(Reconstruction, RowsKeepConstantsAndHaveNoHoles) {
  for (const Extent plane : {Extent{9, 6}, Extent{1, 17}, Extent{17, 1}}) {
    std::vector<std::vector<Vec2f>> sets{{{0.5F, 0.5F}},
                                         scattered(plane, 10, 1),
                                         jittered(plane, 3, 2, 2),
                                         scattered(plane, 45 * plane.area(), 3),
                                         std::vector<Vec2f>(60, Vec2f{0.25F, 0.75F})};
    for (const Reconstruction& row : reconstructions()) {
      for (const std::uint32_t channels : {1U, 3U}) {
        for (const auto& set : sets) {
          const Film film = film_of(plane, channels, set, [&](Vec2f, float* value) {
            for (std::uint32_t c = 0; c < channels; ++c) value[c] = 0.25F * static_cast<float>(c + 1);
          });
          const Developed developed = row.develop(film);
          ASSERT_EQ(developed.image.texels.size(), plane.area() * channels);
          EXPECT_TRUE(all_finite(developed)) << row.name;
          for (std::size_t i = 0; i < developed.image.texels.size(); ++i) {
            EXPECT_NEAR(developed.image.texels[i], 0.25F * static_cast<float>(i % channels + 1), 1e-6F) << row.name;
          }
          std::set<std::size_t> used;
          for (const Vec2f p : set)
            used.insert(static_cast<std::size_t>(p.y) * plane.width + static_cast<std::size_t>(p.x));
          EXPECT_EQ(developed.empty_pixels, plane.area() - used.size()) << row.name;
          EXPECT_EQ(developed.samples, set.size());
        }
      }
    }
  }
}

TEST(StandardError, IsHonestForIndependentSamples) {
  const Extent plane{40, 40};
  const TestFunction waves = [](Vec2f p, float* value) {
    value[0] = std::sin(2 * p.x) + (p.y > 20.3F ? 2.0F : 0.5F) * p.y;
  };
  const Film film = film_of(plane, 1, scattered(plane, 8 * plane.area(), 4), waves);
  const Developed developed = find_reconstruction("mean").develop(film);
  double estimated = 0;
  for (const float error : developed.standard_error.cells()) estimated += double{error} * double{error};
  EXPECT_NEAR(std::sqrt(estimated / 1600) / error_of(developed.image, waves), 1, 0.1);
}

TEST(StandardError, UnknownPixelsTakeTheirNeighbours) {
  Grid<PixelStats> pixels({3, 1});
  for (const float value : {1.0F, 3.0F}) pixels[0].add(value);
  pixels[1].add(5);
  EXPECT_FLOAT_EQ(independent_standard_error(pixels)[1], 1);
  EXPECT_FLOAT_EQ(independent_standard_error(pixels)[2], 1);
  EXPECT_EQ(independent_standard_error(Grid<PixelStats>({3, 1}, pixels[1])).size().area(), 0U);
}

}  // namespace
}  // namespace abn::harness
