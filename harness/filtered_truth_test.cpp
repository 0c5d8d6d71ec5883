#include "harness/filtered_truth.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::harness {
namespace {

const std::vector<std::string> separable = {
    "box",      "triangle", "gaussian",         "gaussian:sigma=0.2,radius=3", "gaussian:sigma=2,radius=0.3",
    "mitchell", "lanczos",  "mitchell:b=1,c=0", "triangle:radius=4",
};
const std::vector<std::string> discs = {
    "gaussian:support=disc",
    "gaussian:sigma=0.2,radius=1.2,support=disc",
    "gaussian:sigma=50,radius=0.7,support=disc",
    "gaussian:sigma=1,radius=0.2,support=disc",
};

/// Whole and other ratios, enlargements, single rows and columns, one texel.
struct Sizes {
  Extent from, to;
};
const std::vector<Sizes> sizes = {
    {{12, 8}, {4, 4}}, {{13, 11}, {4, 5}}, {{3, 2}, {7, 5}}, {{4, 4}, {4, 4}},
    {{1, 9}, {3, 2}},  {{9, 1}, {2, 3}},   {{1, 1}, {2, 2}}, {{17, 5}, {1, 1}},
};

Image noise(Extent size, std::uint32_t channels) {
  Image image(size, channels);
  Rng rng(1, stream_id("filtered_truth_test"), size.width);
  for (float& texel : image.texels) texel = rng.uniform();
  return image;
}

/// The sum of function over n midpoints of [a, b], times their distance.
double midpoint_rule(double a, double b, int n, const auto& function) {
  if (b <= a) return 0;
  double sum = 0;
  for (int i = 0; i < n; ++i) sum += function(a + (b - a) * (i + 0.5) / n);
  return sum * (b - a) / n;
}

/// Midpoint rule extrapolated to order 4.
double quadrature(double a, double b, int n, const auto& function) {
  return (4 * midpoint_rule(a, b, 2 * n, function) - midpoint_rule(a, b, n, function)) / 3;
}

const float* clamped(const Image& image, int x, int y) {
  return image.texel(static_cast<std::uint32_t>(std::clamp(x, 0, static_cast<int>(image.size.width) - 1)),
                     static_cast<std::uint32_t>(std::clamp(y, 0, static_cast<int>(image.size.height) - 1)));
}

/// The integral of g between texel borders, by quadrature of the profile between its kinks.
double axis_weight(const PixelFilter& filter, double from, double to) {
  double sum = 0;
  double a = std::max(from, -filter.radius());
  for (const double kink : {-1.0, 0.0, 1.0, filter.radius()}) {
    const double b = std::min({kink, to, filter.radius()});
    if (b <= a) continue;
    sum += quadrature(a, b, 60, [&](double x) { return filter.profile(x); });
    a = b;
  }
  return sum;
}

/// Texels of an axis that a pixel's filter may touch, those beyond the border included.
struct Span {
  int begin, end;
  double size;  // of a texel [px]
  double left(int texel, int pixel) const { return texel * size - pixel - 0.5; }
};

Span span(std::uint32_t texels, std::uint32_t pixels, int pixel, double radius) {
  const double size = static_cast<double>(pixels) / texels;
  return {static_cast<int>(std::floor((pixel + 0.5 - radius) / size)),
          static_cast<int>(std::ceil((pixel + 0.5 + radius) / size)), size};
}

/// Every texel's area integral for every pixel: no telescoping, no windows.
double direct(const Image& image, Extent to, const PixelFilter& filter, int ox, int oy, std::uint32_t c) {
  const Span across = span(image.size.width, to.width, ox, filter.radius());
  const Span down = span(image.size.height, to.height, oy, filter.radius());
  std::vector<double> weights;
  for (int x = across.begin; x < across.end; ++x) {
    weights.push_back(axis_weight(filter, across.left(x, ox), across.left(x + 1, ox)));
  }
  double sum = 0;
  for (int y = down.begin; y < down.end; ++y) {
    const double weight = axis_weight(filter, down.left(y, oy), down.left(y + 1, oy));
    for (int x = across.begin; x < across.end; ++x) {
      sum += weight * weights[static_cast<std::size_t>(x - across.begin)] * double{clamped(image, x, y)[c]};
    }
  }
  return sum;
}

/// The integral of value() over one texel within the disc: nested quadrature, split where the circle meets an edge, in
/// the angle y = R sin(a), which takes the root out of the chord.
double disc_weight(const PixelFilter& filter, double x0, double x1, double y0, double y1) {
  const double radius = filter.radius();
  std::vector<double> cuts = {std::clamp(y0, -radius, radius), std::clamp(y1, -radius, radius)};
  for (const double x : {x0, x1}) {
    if (std::abs(x) >= radius) continue;
    const double y = std::sqrt(radius * radius - x * x);
    for (const double cut : {-y, y}) {
      if (cut > y0 && cut < y1) cuts.push_back(cut);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  const auto panels = [](double length) { return static_cast<int>(6 + 40 * std::max(0.0, length)); };
  double sum = 0;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double from = std::asin(cuts[i] / radius);
    const double to = std::asin(cuts[i + 1] / radius);
    sum += quadrature(from, to, panels(to - from), [&](double angle) {
      const double y = radius * std::sin(angle);
      const double chord = radius * std::cos(angle);
      const double left = std::max(x0, -chord);
      const double right = std::min(x1, chord);
      // A hair inside the circle, where value() is not 0 by rounding.
      return chord * quadrature(left, right, panels(right - left),
                                [&](double x) { return filter.value(x * (1 - 1e-12), y * (1 - 1e-12)); });
    });
  }
  return sum;
}

double direct_disc(const Image& image, Extent to, const PixelFilter& filter, int ox, int oy, std::uint32_t c) {
  const Span across = span(image.size.width, to.width, ox, filter.radius());
  const Span down = span(image.size.height, to.height, oy, filter.radius());
  double sum = 0;
  for (int y = down.begin; y < down.end; ++y) {
    for (int x = across.begin; x < across.end; ++x) {
      sum += disc_weight(filter, across.left(x, ox), across.left(x + 1, ox), down.left(y, oy), down.left(y + 1, oy)) *
             double{clamped(image, x, y)[c]};
    }
  }
  return sum;
}

TEST(FilteredTruth, BoxIsTheExactTruth) {
  for (const auto interpolation : {Interpolation::nearest, Interpolation::bilinear}) {
    for (const auto& [from, to] : sizes) {
      const Image image = noise(from, 3);
      const Image filtered = filtered_truth(image, to, *make_filter("box"), interpolation).image;
      const Image exact = exact_truth(image, to, interpolation).image;
      ASSERT_EQ(filtered.texels.size(), exact.texels.size());
      for (std::size_t i = 0; i < exact.texels.size(); ++i) EXPECT_NEAR(filtered.texels[i], exact.texels[i], 1e-7);
    }
  }
}

TEST(FilteredTruth, IsTheSumOverAllTexels) {
  for (const auto& words : separable) {
    const auto filter = make_filter(words);
    for (const auto& [from, to] : sizes) {
      const Image image = noise(from, 3);
      const GroundTruth truth = filtered_truth(image, to, *filter);
      EXPECT_EQ(truth.method, "exact");
      EXPECT_TRUE(truth.standard_error.texels.empty());
      for (std::uint32_t y = 0; y < to.height; ++y) {
        for (std::uint32_t x = 0; x < to.width; ++x) {
          const std::uint32_t c = (x + y) % 3;
          EXPECT_NEAR(truth.image.texel(x, y)[c],
                      direct(image, to, *filter, static_cast<int>(x), static_cast<int>(y), c), 5e-7)
              << words << " " << from.width << "x" << from.height << " at " << x << " " << y;
        }
      }
    }
  }
}

TEST(FilteredTruth, DiscIsTheSumOverAllTexels) {
  for (const auto& words : discs) {
    const auto filter = make_filter(words);
    for (const auto& [from, to] : sizes) {
      const Image image = noise(from, 3);
      const Image truth = filtered_truth(image, to, *filter).image;
      for (std::uint32_t y = 0; y < to.height; ++y) {
        for (std::uint32_t x = 0; x < to.width; ++x) {
          const std::uint32_t c = (x + y) % 3;
          EXPECT_NEAR(truth.texel(x, y)[c],
                      direct_disc(image, to, *filter, static_cast<int>(x), static_cast<int>(y), c), 1e-6)
              << words << " " << from.width << "x" << from.height << " at " << x << " " << y;
        }
      }
    }
  }
}

TEST(FilteredTruth, WideDiscIsTheSquare) {
  const Image image = noise({31, 23}, 1);
  const Image square = filtered_truth(image, {5, 4}, *make_filter("gaussian:sigma=0.3,radius=3")).image;
  const Image disc = filtered_truth(image, {5, 4}, *make_filter("gaussian:sigma=0.3,radius=3,support=disc")).image;
  for (std::size_t i = 0; i < square.texels.size(); ++i) EXPECT_NEAR(square.texels[i], disc.texels[i], 1e-6);
}

// Uniform positions of the filter's square, weighted: needs nothing but value() and what the strategies sample.
TEST(FilteredTruth, IsWhatManyRandomSamplesApproach) {
  constexpr int samples = 4000;
  std::vector<std::string> all = separable;
  all.insert(all.end(), discs.begin(), discs.end());
  for (const auto interpolation : {Interpolation::nearest, Interpolation::bilinear}) {
    for (const auto& words : all) {
      const auto filter = make_filter(words);
      if (filter->disc() && interpolation == Interpolation::bilinear) continue;
      for (const Sizes& size : {Sizes{{13, 11}, {4, 3}}, Sizes{{3, 2}, {5, 4}}}) {
        const Image image = noise(size.from, 1);
        const Image truth = filtered_truth(image, size.to, *filter, interpolation).image;
        const ImageIntegrand integrand(image, size.to, interpolation);
        for (std::size_t pixel = 0; pixel < size.to.area(); ++pixel) {
          Rng rng(3, stream_id("filtered_truth_test samples"), pixel);
          const auto x = static_cast<float>(pixel % size.to.width) + 0.5F;
          const auto y = static_cast<float>(pixel / size.to.width) + 0.5F;
          std::vector<Vec2f> position(samples);
          std::vector<double> weight(samples);
          for (std::size_t i = 0; i < samples; ++i) {
            const auto radius = static_cast<float>(filter->radius());
            const float dx = radius * (2 * rng.uniform() - 1);
            const float dy = radius * (2 * rng.uniform() - 1);
            position[i] = {x + dx, y + dy};
            weight[i] = 4 * double{radius} * double{radius} * filter->value(double{dx}, double{dy});
          }
          std::vector<float> values(samples);
          integrand.evaluate(position, values);
          double sum = 0;
          double squares = 0;
          for (std::size_t i = 0; i < samples; ++i) {
            sum += weight[i] * double{values[i]};
            squares += std::pow(weight[i] * double{values[i]}, 2);
          }
          const double mean = sum / samples;
          const double error = std::sqrt(std::max(0.0, squares / samples - mean * mean) / samples);
          EXPECT_NEAR(truth.texels[pixel], mean, 4 * error + 1e-6) << words << " at " << pixel;
        }
      }
    }
  }
}

TEST(FilteredTruth, BilinearReproducesLinearImagesAwayFromTheBorder) {
  Image image({40, 30}, 1);
  for (std::uint32_t y = 0; y < 30; ++y) {
    for (std::uint32_t x = 0; x < 40; ++x) *image.texel(x, y) = static_cast<float>(x) + 2 * static_cast<float>(y);
  }
  const Extent to{13, 11};
  for (const auto& words : separable) {
    const auto filter = make_filter(words);
    const Image truth = filtered_truth(image, to, *filter, Interpolation::bilinear).image;
    for (std::uint32_t y = 5; y < 6; ++y) {
      for (std::uint32_t x = 5; x < 8; ++x) {
        const double expected = ((x + 0.5) * 40 / 13 - 0.5) + 2 * ((y + 0.5) * 30 / 11 - 0.5);
        EXPECT_NEAR(*truth.texel(x, y), expected, 4e-6) << words;
      }
    }
  }
}

// One axis alone: a bright column, so that a pixel is the integral of the hat times g.
TEST(FilteredTruth, BilinearWeightIsTheIntegralOfTheHat) {
  for (const auto& words : separable) {
    const auto filter = make_filter(words);
    for (const auto& [texels, pixels] : std::vector<std::pair<std::uint32_t, std::uint32_t>>{{11, 4}, {5, 5}, {3, 7}}) {
      const double spacing = static_cast<double>(pixels) / texels;
      for (std::uint32_t bright = 1; bright + 1 < texels; ++bright) {
        Image image({texels, 1}, 1);
        *image.texel(bright, 0) = 1;
        const Image truth = filtered_truth(image, {pixels, 1}, *filter, Interpolation::bilinear).image;
        for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
          const double centre = (bright + 0.5) * spacing - (pixel + 0.5);
          const auto part = [&](double from, double to) {
            double sum = 0;
            double a = std::max(from, -filter->radius());
            for (const double kink : {-1.0, 0.0, 1.0, filter->radius()}) {
              const double b = std::min({kink, to, filter->radius()});
              if (b <= a) continue;
              sum += quadrature(a, b, 200,
                                [&](double x) { return (1 - std::abs(x - centre) / spacing) * filter->profile(x); });
              a = b;
            }
            return sum;
          };
          EXPECT_NEAR(*truth.texel(pixel, 0), part(centre - spacing, centre) + part(centre, centre + spacing), 1e-7)
              << words << " " << texels << " " << pixels;
        }
      }
    }
  }
}

TEST(FilteredTruth, ConstantsStay) {
  std::vector<std::string> all = separable;
  all.insert(all.end(), discs.begin(), discs.end());
  for (const auto& words : all) {
    const auto filter = make_filter(words);
    for (const auto& [from, to] : sizes) {
      Image image(from, 1);
      std::fill(image.texels.begin(), image.texels.end(), 0.7F);
      for (const float value : filtered_truth(image, to, *filter).image.texels) EXPECT_EQ(value, 0.7F) << words;
      if (filter->disc()) continue;
      for (const float value : filtered_truth(image, to, *filter, Interpolation::bilinear).image.texels) {
        EXPECT_EQ(value, 0.7F) << words;
      }
    }
  }
}

TEST(FilteredTruth, IsTheSameForAnyNumberOfThreads) {
  const Image image = noise({700, 150}, 3);  // several tiles and bands
  const int threads = omp_get_max_threads();
  for (const std::string words : {"gaussian", "lanczos", "gaussian:support=disc"}) {
    const auto filter = make_filter(words);
    for (const auto interpolation : {Interpolation::nearest, Interpolation::bilinear}) {
      if (filter->disc() && interpolation == Interpolation::bilinear) continue;
      omp_set_num_threads(1);
      const Image one = filtered_truth(image, {100, 90}, *filter, interpolation).image;
      for (const int n : {2, 3, 5}) {
        omp_set_num_threads(n);
        EXPECT_EQ(filtered_truth(image, {100, 90}, *filter, interpolation).image.texels, one.texels) << words;
      }
    }
  }
  omp_set_num_threads(threads);
}

TEST(FilteredTruth, DiscOfTheBilinearIntegrandIsRefused) {
  try {
    (void)filtered_truth(noise({4, 4}, 1), {2, 2}, *make_filter("gaussian:support=disc"), Interpolation::bilinear);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("support=square"), std::string::npos);
  }
}

}  // namespace
}  // namespace abn::harness
