#include "sampling/sph/size_field_cases.h"

#include <charconv>
#include <cmath>
#include <numbers>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn::sph {
namespace {

constexpr double pi = std::numbers::pi;

/// White noise in [0,1), one value per square of a 512 x 512 grid whatever the raster.
double square_noise(double u, double v, const char* stream) {
  const auto column = static_cast<std::uint64_t>(u * 512);
  const auto row = static_cast<std::uint64_t>(v * 512);
  return double{Rng(1, stream_id(stream), row * 512 + column).uniform()};
}

}  // namespace

const std::vector<SizeFieldCase>& size_field_cases() {
  static const std::vector<SizeFieldCase> table = {
      {"constant", "the same spacing everywhere", 1, [](double, double, double) { return 1.0; }},
      {"smooth", "one hill with exponential flanks", 10,
       [](double u, double v, double ratio) {
         const double hill = std::sin(pi * u) * std::sin(pi * v);
         return std::pow(ratio, hill * hill);
       }},
      {"ramp", "linear from left to right, and back to the start at the seam", 8,
       [](double u, double, double ratio) { return 1 + (ratio - 1) * u; }},
      {"step", "fine on the left half, coarse on the right", 8,
       [](double u, double, double ratio) { return u < 0.5 ? 1.0 : ratio; }},
      {"disc", "fine inside a disc", 5,
       [](double u, double v, double ratio) { return std::hypot(u - 0.5, v - 0.5) < 0.25 ? 1.0 : ratio; }},
      {"ring", "fine on a thin ring", 10,
       [](double u, double v, double ratio) {
         return std::abs(std::hypot(u - 0.5, v - 0.5) - 0.3) < 0.01 ? 1.0 : ratio;
       }},
      {"spikes", "fine in one square of 512 x 512 among a thousand", 100,
       [](double u, double v, double ratio) { return square_noise(u, v, "spikes") < 1e-3 ? 1.0 : ratio; }},
      {"random", "another spacing in every square of 512 x 512", 10,
       [](double u, double v, double ratio) { return std::pow(ratio, square_noise(u, v, "random sizes")); }},
  };
  return table;
}

Grid<float> make_size_field(std::string_view word, Extent cells) {
  const auto colon = word.find(':');
  const std::string_view name = word.substr(0, colon);
  std::string known;
  for (const SizeFieldCase& field : size_field_cases()) {
    if (field.name != name) {
      known.append(" ").append(field.name);
      continue;
    }
    double ratio = field.ratio;
    if (colon != std::string_view::npos) {
      const std::string_view digits = word.substr(colon + 1);
      const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), ratio);
      if (error != std::errc{} || rest != digits.data() + digits.size() || !(ratio >= 1 && ratio <= 1000)) {
        throw ConfigError("size field '" + std::string(word) + "': the ratio must be a number from 1 to 1000, as in '" +
                          field.name + ":10'");
      }
    }
    Grid<float> result(cells);
    for (std::uint32_t y = 0; y < cells.height; ++y) {
      for (std::uint32_t x = 0; x < cells.width; ++x) {
        result.at(x, y) = static_cast<float>(field.value((x + 0.5) / cells.width, (y + 0.5) / cells.height, ratio));
      }
    }
    return result;
  }
  throw ConfigError("unknown size field '" + std::string(word) + "'; known:" + known);
}

}  // namespace abn::sph
