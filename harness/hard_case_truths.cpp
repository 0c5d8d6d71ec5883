// The exact pixel means of hard_cases.cpp, in closed form and in double, for any size of the result.
//
// Most of the pictures are sums of products f(x) g(y), so the mean over the rectangle that a pixel covers is a sum of
// products of one-dimensional means, and each of those is a difference of the integral from 0.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "harness/fresnel.h"
#include "harness/hard_case_constants.h"
#include "harness/hard_cases.h"

namespace abn::harness {

namespace {

using namespace hard_case;

using Integral = std::function<double(double)>;  // of a function of one coordinate, over [0, t], t in texels

/// weight * f(x) * g(y), by the integrals of f and g.
struct Product {
  double weight;
  Integral along_x, along_y;
};

double one(double t) { return t; }

/// The means of a function over the `cells` equal parts of [0, texels].
std::vector<double> means(const Integral& integral, std::uint32_t texels, std::uint32_t cells) {
  const double length = static_cast<double>(texels) / cells;
  std::vector<double> result(cells);
  double before = integral(0.0);
  for (std::uint32_t i = 0; i < cells; ++i) {
    const double after = integral(i + 1 == cells ? texels : (i + 1) * static_cast<double>(texels) / cells);
    result[i] = (after - before) / length;
    before = after;
  }
  return result;
}

Image mean_of(Extent size, Extent to, std::span<const Product> products) {
  std::vector<std::pair<std::vector<double>, std::vector<double>>> factors;
  for (const Product& product : products) {
    factors.emplace_back(means(product.along_x, size.width, to.width), means(product.along_y, size.height, to.height));
  }
  Image image(to, 1);
  for (std::uint32_t y = 0; y < to.height; ++y) {
    for (std::uint32_t x = 0; x < to.width; ++x) {
      double value = 0;
      for (std::size_t k = 0; k < products.size(); ++k) {
        value += products[k].weight * factors[k].first[x] * factors[k].second[y];
      }
      *image.texel(x, y) = static_cast<float>(value);
    }
  }
  return image;
}

Image mean_of(Extent size, Extent to, std::initializer_list<Product> products) {
  return mean_of(size, to, std::span(products.begin(), products.size()));
}

/// The integral of a function that is 1 from `start` on.
Integral step_from(double start) {
  return [start](double t) { return std::max(0.0, t - start); };
}

/// The integral of a function that is 1 on texel `index` alone.
Integral single_texel(std::uint32_t index) {
  return [index](double t) { return std::clamp(t - index, 0.0, 1.0); };
}

/// The integral of +1, -1, +1, ... texel by texel: a triangle wave.
double alternating(double t) {
  const double in_period = t - 2.0 * std::floor(t / 2.0);
  return std::min(in_period, 2.0 - in_period);
}

/// The integral of a piecewise-constant function with the given texels.
Integral of_texels(std::span<const double> texels) {
  std::vector<double> sums(texels.size() + 1, 0.0);
  for (std::size_t i = 0; i < texels.size(); ++i) sums[i + 1] = sums[i] + texels[i];
  return [sums = std::move(sums)](double t) {
    const auto whole = std::min(static_cast<std::size_t>(t), sums.size() - 2);
    return sums[whole] + (t - static_cast<double>(whole)) * (sums[whole + 1] - sums[whole]);
  };
}

/// cos and sin of pi (x - centre)^2 / longer at the texel centres of one axis.
struct Chirp {
  std::vector<double> cosine, sine;
  Chirp(std::uint32_t texels, double longer) : cosine(texels), sine(texels) {
    for (std::uint32_t i = 0; i < texels; ++i) {
      const double distance = i + 0.5 - 0.5 * texels;
      cosine[i] = std::cos(std::numbers::pi * distance * distance / longer);
      sine[i] = std::sin(std::numbers::pi * distance * distance / longer);
    }
  }
};

struct Point {
  double x, y;
};
using Polygon = std::vector<Point>;

/// The part of a convex polygon where nx x + ny y >= 0 (Sutherland and Hodgman 1974).
Polygon clip(const Polygon& polygon, double nx, double ny) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    const double da = nx * a.x + ny * a.y, db = nx * b.x + ny * b.y;
    if (da >= 0) kept.push_back(a);
    if ((da >= 0) != (db >= 0)) {
      const double t = da / (da - db);
      kept.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
    }
  }
  return kept;
}

double area(const Polygon& polygon) {
  double doubled = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Point o = polygon[0], a = polygon[i], b = polygon[i + 1];
    doubled += (a.x - o.x) * (b.y - o.y) - (b.x - o.x) * (a.y - o.y);
  }
  return std::abs(doubled) / 2;
}

/// The mean over every pixel of a picture that is 1 on a part of the plane and 0 elsewhere; `bright_area` measures
/// that part of a pixel, given in texels from the image's centre.
template <class BrightArea>
Image covered_part(Extent size, Extent to, const BrightArea& bright_area) {
  const double width = static_cast<double>(size.width) / to.width,
               height = static_cast<double>(size.height) / to.height;
  Image image(to, 1);
#pragma omp parallel for schedule(static)
  for (std::uint32_t y = 0; y < to.height; ++y) {
    for (std::uint32_t x = 0; x < to.width; ++x) {
      const double left = x * width - 0.5 * size.width, top = y * height - 0.5 * size.height;
      const Polygon pixel{{left, top}, {left + width, top}, {left + width, top + height}, {left, top + height}};
      *image.texel(x, y) = static_cast<float>(bright_area(pixel) / (width * height));
    }
  }
  return image;
}

}  // namespace

Image constant_truth(Extent size, Extent to) { return mean_of(size, to, {{background, one, one}}); }

Image black_truth(Extent, Extent to) { return Image(to, 1); }

Image zone_plate_texel_truth(Extent size, Extent to) {
  const double longer = std::max(size.width, size.height);
  const Chirp x(size.width, longer), y(size.height, longer);
  return mean_of(
      size, to,
      {{0.5, one, one}, {0.5, of_texels(x.cosine), of_texels(y.cosine)}, {-0.5, of_texels(x.sine), of_texels(y.sine)}});
}

Image zone_plate_continuous_truth(Extent size, Extent to) {
  // With t = x sqrt(2/N) the phase pi x^2 / N is the pi t^2 / 2 of the Fresnel integrals.
  const double scale = std::sqrt(2.0 / std::max(size.width, size.height));
  const auto cosine = [scale](std::uint32_t texels) -> Integral {
    return [=](double t) { return fresnel((t - 0.5 * texels) * scale).cosine / scale; };
  };
  const auto sine = [scale](std::uint32_t texels) -> Integral {
    return [=](double t) { return fresnel((t - 0.5 * texels) * scale).sine / scale; };
  };
  return mean_of(
      size, to,
      {{0.5, one, one}, {0.5, cosine(size.width), cosine(size.height)}, {-0.5, sine(size.width), sine(size.height)}});
}

Image siemens_star_continuous_truth(Extent size, Extent to) {
  std::array<Point, star_sectors> edge{};  // unit vectors; sector k lies between edges k and k + 1
  for (int k = 0; k < star_sectors; ++k) {
    const double angle = star_rotation + k * star_sector;
    edge[static_cast<std::size_t>(k)] = {std::cos(angle), std::sin(angle)};
  }
  return covered_part(size, to, [&](const Polygon& pixel) {
    double bright = 0;
    for (std::size_t k = 0; k < edge.size(); k += 2) {
      const Point from = edge[k], until = edge[k + 1];
      bright += area(clip(clip(pixel, -from.y, from.x), until.y, -until.x));
    }
    return bright;
  });
}

Image slanted_edge_continuous_truth(Extent size, Extent to) {
  return covered_part(
      size, to, [](const Polygon& pixel) { return area(clip(pixel, std::cos(edge_slant), std::sin(edge_slant))); });
}

Image step_1500_truth(Extent size, Extent to) {
  return mean_of(size, to, {{1.0, step_from(step_column(size, 0)), one}});
}

Image step_1507_truth(Extent size, Extent to) {
  return mean_of(size, to, {{1.0, step_from(step_column(size, late_step)), one}});
}

Image checkerboard_1texel_truth(Extent size, Extent to) {
  return mean_of(size, to, {{0.5, one, one}, {0.5, alternating, alternating}});
}

Image lines_47_truth(Extent size, Extent to) {
  const Integral lines = [](double t) {
    const double periods = std::floor(t / line_pitch);
    return periods + std::min(1.0, t - periods * line_pitch);
  };
  return mean_of(size, to, {{1.0, lines, one}});
}

Image firefly_truth(Extent size, Extent to) {
  return mean_of(size, to,
                 {{background, one, one},
                  {firefly_value - background, single_texel(size.width / 2), single_texel(size.height / 2)}});
}

Image dynamic_range_truth(Extent size, Extent to) {
  // Texel i is a q^i, so the first n texels sum to a (q^n - 1) / (q - 1).
  const double log_ratio = decades * std::numbers::ln10 / size.width;
  const double first = std::pow(10.0, first_decade) * std::exp(0.5 * log_ratio);
  const Integral integral = [=](double t) {
    const double whole = std::floor(t);
    return first * (std::expm1(whole * log_ratio) / std::expm1(log_ratio) + (t - whole) * std::exp(whole * log_ratio));
  };
  return mean_of(size, to, {{1.0, integral, one}});
}

Image ramp_truth(Extent size, Extent to) {
  const Integral integral = [width = size.width](double t) {
    const double whole = std::floor(t);
    return (0.5 * whole * whole + (t - whole) * (whole + 0.5)) / width;
  };
  return mean_of(size, to, {{1.0, integral, one}});
}

}  // namespace abn::harness
