#include "harness/integrand.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::harness {
namespace {

// Texel (x, y) holds its own index, channel c adds c/4: any wrong texel shows.
Image numbered(Extent size, std::uint32_t channels) {
  Image image(size, channels);
  for (std::size_t i = 0; i < image.texels.size(); ++i) {
    const std::size_t texel = i / channels;
    image.texels[i] = static_cast<float>(texel) + 0.25F * static_cast<float>(i % channels);
  }
  return image;
}

std::vector<float> evaluate(const Integrand& integrand, const std::vector<Vec2f>& position) {
  std::vector<float> values(position.size() * integrand.channels());
  integrand.evaluate(position, values);
  return values;
}

// floor(x * texels / pixels) in whole numbers only: x = mantissa * 2^exponent.
std::int64_t exact_texel(float x, std::uint32_t texels, std::uint32_t pixels) {
  int exponent = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &exponent), 24));
  exponent -= 24;
  __extension__ typedef __int128 Wide;
  Wide numerator = Wide{mantissa} * texels;
  Wide denominator = pixels;
  if (exponent >= 0) {
    numerator <<= exponent;
  } else if (exponent > -90) {
    denominator <<= -exponent;
  } else {
    return 0;
  }
  return static_cast<std::int64_t>(numerator / denominator);
}

TEST(ImageIntegrand, NearestTexelIsExactForAnyRatio) {
  struct Ratio {
    std::uint32_t texels, pixels;
  };
  for (const Ratio r :
       {Ratio{3000, 200}, Ratio{3000, 199}, Ratio{2999, 200}, Ratio{3001, 200}, Ratio{3001, 3000}, Ratio{7, 3000},
        Ratio{1, 200}, Ratio{3000, 1}, Ratio{1, 1}, Ratio{200, 3001}, Ratio{2, 49}, Ratio{2, 103}, Ratio{4, 197}}) {
    const Image image = numbered({r.texels, 1}, 1);
    const ImageIntegrand integrand(image, {r.pixels, 1});
    std::vector<Vec2f> position;
    const auto add = [&](float x) {
      for (const float p : {std::nextafter(x, 0.0F), x, std::nextafter(x, 1e9F)}) {
        if (p >= 0 && p < static_cast<float>(r.pixels)) position.push_back({p, 0.5F});
      }
    };
    // Around every pixel border and every texel border; then anywhere.
    for (std::uint32_t i = 0; i <= r.pixels; ++i) add(static_cast<float>(i));
    for (std::uint32_t i = 0; i <= r.texels; ++i) add(static_cast<float>(double{1} * i * r.pixels / r.texels));
    Rng rng(1, stream_id("integrand_test"));
    for (int i = 0; i < 2000; ++i) position.push_back(to_plane(rng.uniform2(), {r.pixels, 1}));
    const std::vector<float> values = evaluate(integrand, position);
    for (std::size_t i = 0; i < position.size(); ++i) {
      ASSERT_EQ(static_cast<std::int64_t>(values[i]), exact_texel(position[i].x, r.texels, r.pixels))
          << position[i].x << " of " << r.texels << " on " << r.pixels;
    }
  }
}

TEST(ImageIntegrand, TheLastPositionIsTheLastTexel) {
  for (const Extent size : {Extent{3000, 3000}, Extent{2999, 3001}, Extent{1, 3000}, Extent{3000, 1}, Extent{1, 1}}) {
    const Image image = numbered(size, 1);
    const ImageIntegrand integrand(image, {200, 200});
    const float end = just_below(200.0F);
    EXPECT_EQ(evaluate(integrand, {{end, end}})[0], image.texels.back());
    EXPECT_EQ(evaluate(integrand, {{0, end}})[0], image.texel(0, size.height - 1)[0]);
    EXPECT_EQ(evaluate(integrand, {{end, 0}})[0], image.texel(size.width - 1, 0)[0]);
  }
}

TEST(ImageIntegrand, BeyondTheBorderTheBorderTexelsContinue) {
  const Image image = numbered({6, 6}, 3);
  constexpr float inf = std::numeric_limits<float>::infinity();
  for (const auto interpolation : {Interpolation::nearest, Interpolation::bilinear}) {
    const ImageIntegrand integrand(image, {3, 3}, interpolation);
    EXPECT_EQ(evaluate(integrand, {{-5, -1e30F}})[1], image.texel(0, 0)[1]);
    EXPECT_EQ(evaluate(integrand, {{3, 3}})[2], image.texel(5, 5)[2]);
    EXPECT_EQ(evaluate(integrand, {{inf, -inf}})[0], image.texel(5, 0)[0]);
    // Not a number is a bug of the caller, but never an index outside the image.
    const float value = evaluate(integrand, {{std::nanf(""), 0.0F}})[0];
    EXPECT_EQ(value, image.texel(0, 0)[0]);
  }
}

TEST(ImageIntegrand, ChannelsStayTogetherInBatchesOfAnySize) {
  for (const std::uint32_t channels : {1U, 3U}) {
    const Image image = numbered({31, 17}, channels);
    const ImageIntegrand integrand(image, {31, 17});
    for (const std::size_t count : {0U, 1U, 23U, 24U, 25U, 1000U, 40000U}) {
      std::vector<Vec2f> position(count);
      Rng rng(2, stream_id("integrand_test"), count);
      for (auto& p : position) p = to_plane(rng.uniform2(), {31, 17});
      const std::vector<float> values = evaluate(integrand, position);
      for (std::size_t i = 0; i < count; ++i) {
        const float* texel =
            image.texel(static_cast<std::uint32_t>(position[i].x), static_cast<std::uint32_t>(position[i].y));
        for (std::uint32_t c = 0; c < channels; ++c) ASSERT_EQ(values[i * channels + c], texel[c]);
      }
    }
  }
}

TEST(ImageIntegrand, BilinearReproducesALinearImage) {
  Image image({20, 10}, 3);
  for (std::uint32_t y = 0; y < 10; ++y) {
    for (std::uint32_t x = 0; x < 20; ++x) {
      for (std::uint32_t c = 0; c < 3; ++c) {
        image.texel(x, y)[c] = 2.0F + 0.5F * static_cast<float>(x) - 0.25F * static_cast<float>(y * c);
      }
    }
  }
  const ImageIntegrand integrand(image, {7, 5}, Interpolation::bilinear);
  Rng rng(3, stream_id("integrand_test"));
  for (int i = 0; i < 1000; ++i) {
    const Vec2f p = to_plane(rng.uniform2(), {7, 5});
    const double u = std::clamp(double{p.x} * 20 / 7 - 0.5, 0.0, 19.0);
    const double v = std::clamp(double{p.y} * 2 - 0.5, 0.0, 9.0);
    const std::vector<float> values = evaluate(integrand, {p});
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(values[static_cast<std::size_t>(c)], 2 + 0.5 * u - 0.25 * v * c, 1e-5);
  }
}

TEST(ImageIntegrand, BilinearReproducesAConstantExactly) {
  Image image({5, 4}, 1);
  for (float& texel : image.texels) texel = 0.1F;
  const ImageIntegrand integrand(image, {3, 3}, Interpolation::bilinear);
  Rng rng(4, stream_id("integrand_test"));
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(evaluate(integrand, {to_plane(rng.uniform2(), {3, 3})})[0], 0.1F);
}

TEST(ImageIntegrand, ThreadsDoNotMatter) {
  const Image image = numbered({300, 300}, 3);
  std::vector<Vec2f> position(100'000);
  Rng rng(5, stream_id("integrand_test"));
  for (auto& p : position) p = to_plane(rng.uniform2(), {20, 20});
  const int threads = omp_get_max_threads();
  for (const auto interpolation : {Interpolation::nearest, Interpolation::bilinear}) {
    const ImageIntegrand integrand(image, {20, 20}, interpolation);
    omp_set_num_threads(1);
    const auto one = evaluate(integrand, position);
    omp_set_num_threads(3);
    EXPECT_EQ(evaluate(integrand, position), one);
    omp_set_num_threads(threads);
  }
}

TEST(Interpolation, NamesAreChecked) {
  EXPECT_EQ(parse_interpolation("bilinear"), Interpolation::bilinear);
  EXPECT_THROW(parse_interpolation("cubic"), ConfigError);
}

}  // namespace
}  // namespace abn::harness
