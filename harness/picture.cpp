#include "harness/picture.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "harness/color.h"

namespace abn::harness {
namespace {

std::uint8_t to_byte(float encoded) {
  // Written so that NaN is 0.
  return encoded > 0 ? static_cast<std::uint8_t>(std::lround(std::min(encoded, 1.0F) * 255.0F)) : std::uint8_t{0};
}

// Linear Rec. 709 of an OKLCh colour, hue in radians (Ottosson 2020, "A perceptual color space for image processing").
std::array<double, 3> oklch_to_linear(double lightness, double chroma, double hue) {
  const double a = chroma * std::cos(hue);
  const double b = chroma * std::sin(hue);
  const auto cube = [](double value) { return value * value * value; };
  const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

bool displayable(const std::array<double, 3>& colour) {
  return std::ranges::all_of(colour, [](double value) { return value >= 0 && value <= 1; });
}

// The most colourful displayable colour of that lightness and hue, up to `chroma`.
std::array<double, 3> colourful(double lightness, double chroma, double hue) {
  if (displayable(oklch_to_linear(lightness, chroma, hue))) return oklch_to_linear(lightness, chroma, hue);
  double low = 0;
  for (int step = 0; step < 24; ++step) {
    const double middle = 0.5 * (low + chroma);
    (displayable(oklch_to_linear(lightness, middle, hue)) ? low : chroma) = middle;
  }
  return oklch_to_linear(lightness, low, hue);
}

// Hue and chroma run through OKLCh; OK lightness is solved for so that CIE L* is linear in t.
Rgb8 map_colour(double t) {
  const double hue = (285.0 + 180.0 * t) * std::numbers::pi / 180.0;
  const double chroma = 0.01 + 0.175 * std::sin(std::numbers::pi * std::pow(t, 0.8));
  const double lightness = 1.0 + 95.0 * t;                                                   // L*
  const double y = lightness > 8 ? std::pow((lightness + 16) / 116, 3) : lightness / 903.3;  // relative luminance
  double low = 0;
  double high = 1;
  for (int step = 0; step < 24; ++step) {
    const double middle = 0.5 * (low + high);
    const std::array<double, 3> colour = colourful(middle, chroma, hue);
    (0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2] < y ? low : high) = middle;
  }
  const std::array<double, 3> linear = colourful(low, chroma, hue);
  Rgb8 colour{};
  for (std::size_t c = 0; c < 3; ++c) colour[c] = to_byte(linear_to_srgb(static_cast<float>(linear[c])));
  return colour;
}

}  // namespace

Picture::Picture(std::uint32_t w, std::uint32_t h, Rgb8 colour) : width(w), height(h), rgb(std::size_t{w} * h * 3) {
  for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = colour[i % 3];
}

Picture to_picture(const Image& image, ToneMapping tone_mapping) {
  Picture picture(image.size.width, image.size.height);
  for (std::size_t i = 0; i < picture.rgb.size(); ++i) {
    float value = image.texels[image.channels == 1 ? i / 3 : i / 3 * image.channels + i % 3];
    // Infinite light is white: inf/(1+inf) would be NaN.
    if (tone_mapping == ToneMapping::reinhard && value > 0) value = std::isinf(value) ? 1.0F : value / (1.0F + value);
    picture.rgb[i] = to_byte(linear_to_srgb(std::max(0.0F, std::min(value, 1.0F))));
  }
  return picture;
}

Picture enlarge(const Picture& picture, std::uint32_t factor) {
  assert(factor >= 1);
  Picture large(picture.width * factor, picture.height * factor);
  for (std::uint32_t y = 0; y < large.height; ++y) {
    for (std::uint32_t x = 0; x < large.width; ++x) {
      std::copy_n(picture.pixel(x / factor, y / factor), 3, large.pixel(x, y));
    }
  }
  return large;
}

Rgb8 false_colour(float t) {
  static const std::vector<Rgb8> table = [] {
    std::vector<Rgb8> colours;
    for (int i = 0; i < 256; ++i) colours.push_back(map_colour(i / 255.0));
    return colours;
  }();
  if (std::isnan(t)) return {0, 255, 0};
  return table[static_cast<std::size_t>(std::lround(std::clamp(t, 0.0F, 1.0F) * 255.0F))];
}

}  // namespace abn::harness
