#include "harness/sample_sharing.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "harness/filtered_truth.h"
#include "sampling/rng.h"

namespace abn::harness {
namespace {

const std::vector<std::string> all_filters = {"box",      "triangle", "gaussian",        "gaussian:support=disc",
                                              "mitchell", "lanczos",  "lanczos:lobes=8", "triangle:radius=0.3"};

struct Samples {
  std::vector<Vec2f> position;
  std::vector<float> weight, value;  // value [3 * size]
};

/// Uniformly random, a few with weight 0; values of any size.
Samples random_samples(Extent plane, std::size_t count) {
  Rng rng(5, stream_id("sample_sharing_test"), count);
  Samples samples;
  for (std::size_t i = 0; i < count; ++i) {
    samples.position.push_back(to_plane(rng.uniform2(), plane));
    samples.weight.push_back(i % 7 == 3 ? 0.0F : 0.5F + rng.uniform());
    for (int c = 0; c < 3; ++c) samples.value.push_back(rng.uniform());
  }
  return samples;
}

Film film_of(Extent plane, const Samples& samples) {
  Film film(plane, 3, true);
  film.add({.position = samples.position, .weight = samples.weight}, samples.value);
  return film;
}

/// A coordinate and what it stands for beyond the two borders, with weights.
std::vector<std::pair<double, double>> images(float at, double length, double stretch) {
  const double x = double{at};
  return {{x, 1}, {-x * stretch, stretch}, {length + (length - x) * stretch, stretch}};
}

TEST(SampleSharing, IsTheSumOverAllSamples) {
  const Extent plane{13, 37};  // more than one band
  const Samples samples = random_samples(plane, 3000);
  const Film film = film_of(plane, samples);
  const auto used = std::count_if(samples.weight.begin(), samples.weight.end(), [](float w) { return w > 0; });
  const double stretch = std::cbrt(static_cast<double>(used) / static_cast<double>(plane.area()));
  for (const auto& words : all_filters) {
    const auto filter = make_filter(words);
    const Developed developed = share_samples(film, *filter);
    EXPECT_EQ(developed.samples, 3000U);
    for (std::uint32_t y = 0; y < plane.height; ++y) {
      for (std::uint32_t x = 0; x < plane.width; ++x) {
        std::array<double, 3> sum{};
        double total = 0;
        double magnitude = 0;
        for (std::size_t i = 0; i < samples.position.size(); ++i) {
          if (samples.weight[i] == 0) continue;
          for (const auto& [u, stretch_u] : images(samples.position[i].x, plane.width, stretch)) {
            if (std::abs(u - (x + 0.5)) > filter->radius()) continue;
            for (const auto& [v, stretch_v] : images(samples.position[i].y, plane.height, stretch)) {
              const double f = stretch_u * stretch_v * filter->value(u - (x + 0.5), v - (y + 0.5));
              const double wf = double{samples.weight[i]} * f;
              total += wf;
              magnitude += std::abs(wf);
              for (std::size_t c = 0; c < 3; ++c) sum[c] += wf * double{samples.value[3 * i + c]};
            }
          }
        }
        if (!(total > 0.1 * magnitude)) continue;  // filled from its neighbours
        for (std::size_t c = 0; c < 3; ++c) {
          EXPECT_NEAR(developed.image.texel(x, y)[c], sum[c] / total, 1e-6 * (1 + std::abs(sum[c] / total)))
              << words << " at " << x << " " << y;
        }
      }
    }
  }
}

TEST(SampleSharing, OfTheBoxIsThePlainMean) {
  const Extent plane{9, 40};
  const Film film = film_of(plane, random_samples(plane, 4000));
  const Developed shared = share_samples(film, *make_filter("box"));
  const Developed mean = film.develop();
  EXPECT_EQ(shared.empty_pixels, mean.empty_pixels);
  EXPECT_EQ(shared.max_samples_per_pixel, mean.max_samples_per_pixel);
  for (std::size_t i = 0; i < mean.image.texels.size(); ++i) {
    EXPECT_NEAR(shared.image.texels[i], mean.image.texels[i], 1e-7);
  }
}

// Pixels are half open: a sample on their border belongs to the right one only.
TEST(SampleSharing, BoxGivesASampleOnABorderToOnePixel) {
  Film film({2, 1}, 1, true);
  film.add({.position = std::vector<Vec2f>{{0.5F, 0.5F}, {1.0F, 0.0F}}}, std::vector<float>{1, 3});
  EXPECT_EQ(share_samples(film, *make_filter("box")).image.texels, (std::vector<float>{1, 3}));
}

TEST(SampleSharing, ConstantsStay) {
  const Extent plane{20, 20};
  for (const std::size_t count : {std::size_t{40}, std::size_t{400}, std::size_t{8000}}) {
    Samples samples = random_samples(plane, count);
    std::fill(samples.value.begin(), samples.value.end(), 0.7F);
    const Film film = film_of(plane, samples);
    for (const auto& words : all_filters) {
      for (const float value : share_samples(film, *make_filter(words)).image.texels) {
        EXPECT_FLOAT_EQ(value, 0.7F) << words << " " << count;
      }
    }
  }
}

// Two texels per pixel, so that it matters what a border pixel takes for the outside: filters that are cut
// off there stay at the error of few samples.
TEST(SampleSharing, ApproachesTheFilteredTruthWithMoreSamples) {
  const Extent plane{12, 12};
  Image image({24, 24}, 1);
  Rng texels(1, stream_id("sample_sharing_test texels"));
  for (float& texel : image.texels) texel = texels.uniform();
  const ImageIntegrand integrand(image, plane);
  for (const std::string words : {"triangle", "gaussian", "gaussian:support=disc", "mitchell", "lanczos"}) {
    const auto filter = make_filter(words);
    const Image truth = filtered_truth(image, plane, *filter).image;
    double coarse = 0;
    for (const int side : {4, 16}) {  // strata per side of a pixel
      Rng rng(2, stream_id("sample_sharing_test"), static_cast<std::uint64_t>(side));
      std::vector<Vec2f> position;
      for (int y = 0; y < 12 * side; ++y) {
        for (int x = 0; x < 12 * side; ++x) {
          const Vec2f in_stratum = rng.uniform2();
          position.push_back({(static_cast<float>(x) + in_stratum.x) / static_cast<float>(side),
                              (static_cast<float>(y) + in_stratum.y) / static_cast<float>(side)});
        }
      }
      std::vector<float> values(position.size());
      integrand.evaluate(position, values);
      Film film(plane, 1, true);
      film.add({.position = position}, values);
      const Image shared = share_samples(film, *filter).image;
      double squares = 0;
      int count = 0;
      for (std::uint32_t y = 0; y < 12; ++y) {
        for (std::uint32_t x = 0; x < 12; ++x) {
          squares += std::pow(double{*shared.texel(x, y)} - double{*truth.texel(x, y)}, 2);
          ++count;
        }
      }
      const double error = std::sqrt(squares / count);
      if (side == 4) {
        coarse = error;
      } else {
        EXPECT_LT(error, 0.009) << words;
        EXPECT_LT(error, coarse / 2.5) << words;  // 16 times as many samples; spp^-1/2 on the border
      }
    }
  }
}

TEST(SampleSharing, FillsAndCountsWhatNoSampleDetermines) {
  Film film({9, 9}, 1, true);
  film.add({.position = std::vector<Vec2f>{{4.5F, 4.5F}}}, std::vector<float>{2});
  const Developed narrow = share_samples(film, *make_filter("triangle"));
  EXPECT_EQ(narrow.empty_pixels, 80U);  // the neighbours lie on the tent's rim
  // Where the product of profiles is negative, and where it is 0, nothing is known; elsewhere the sample is.
  const Developed lobes = share_samples(film, *make_filter("mitchell"));
  EXPECT_EQ(lobes.empty_pixels, 81U - 9U);
  Film off_centre({9, 9}, 1, true);
  off_centre.add({.position = std::vector<Vec2f>{{4.75F, 4.75F}}}, std::vector<float>{2});
  const Developed shifted = share_samples(off_centre, *make_filter("mitchell"));
  // Profile at -1.75 and 1.25 negative, at -.75 and .25 positive: 4 + 4 products are positive.
  EXPECT_EQ(shifted.empty_pixels, 81U - 8U);
  for (const Developed* developed : {&narrow, &lobes, &shifted}) {
    for (const float value : developed->image.texels) EXPECT_EQ(value, 2.0F);
  }
}

TEST(SampleSharing, SamplesWithoutWeightAreLeftOut) {
  Film film({2, 2}, 1, true);
  film.add(
      {.position = std::vector<Vec2f>{{0.5F, 0.5F}, {1.5F, 1.5F}, {0.6F, 0.5F}}, .weight = std::vector<float>{1, 0, 0}},
      std::vector<float>{1, std::numeric_limits<float>::quiet_NaN(), 9});
  const Developed developed = share_samples(film, *make_filter("gaussian"));
  EXPECT_EQ(developed.samples, 3U);
  for (const float value : developed.image.texels) EXPECT_EQ(value, 1.0F);
}

TEST(SampleSharing, ByDensityUndoesACrowd) {
  // A ramp with nine times as many samples in every pixel's right half: the plain weights lean to the right.
  const Extent plane{8, 8};
  const auto filter = make_filter("gaussian:radius=1");
  Film film(plane, 1, true);
  std::vector<Vec2f> position;
  std::vector<float> value;
  for (std::uint64_t k = 0; k < 64 * 500; ++k) {
    const Vec2f unit = Rng(3, stream_id("sample_sharing_test"), k).uniform2();
    const float x = unit.x < 0.1F ? unit.x * 5 : 0.5F + (unit.x - 0.1F) / 1.8F;
    position.push_back({static_cast<float>(k % 8) + x, static_cast<float>(k / 8 % 8) + unit.y});
    value.push_back(x);
  }
  film.add({.position = position}, value);
  const double plain = double{share_samples(film, *filter).image.texels[27]};
  const double by_density = double{share_samples(film, *filter, true).image.texels[27]};
  EXPECT_GT(plain, 0.62);
  EXPECT_NEAR(by_density, 0.5, 0.04);
}

TEST(SampleSharing, WithoutSamplesIsBlackAndEmpty) {
  const Film film({3, 2}, 3, true);
  const Developed developed = share_samples(film, *make_filter("lanczos"));
  EXPECT_EQ(developed.empty_pixels, 6U);
  for (const float value : developed.image.texels) EXPECT_EQ(value, 0.0F);
}

TEST(SampleSharing, IsTheSameForAnyNumberOfThreads) {
  const Extent plane{50, 130};
  const Film film = film_of(plane, random_samples(plane, 30000));
  const int threads = omp_get_max_threads();
  for (const std::string words : {"gaussian", "lanczos", "gaussian:support=disc"}) {
    const auto filter = make_filter(words);
    omp_set_num_threads(1);
    const Image one = share_samples(film, *filter).image;
    for (const int n : {2, 3, 7}) {
      omp_set_num_threads(n);
      EXPECT_EQ(share_samples(film, *filter).image.texels, one.texels) << words;
    }
  }
  omp_set_num_threads(threads);
}

}  // namespace
}  // namespace abn::harness
