#include "harness/test_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>
#include <vector>

#include "harness/letters.h"
#include "sampling/rng.h"

namespace abn::harness {

namespace {

constexpr double sheet = 3000;  // [units] each side
constexpr std::uint64_t picture_seed = 99;

/// Uniform in [lo, hi).
double uniform(Rng& rng, double lo, double hi) { return lo + (hi - lo) * double{rng.uniform()}; }

/// The units of the sheet per texel, and the way back.
struct Sheet {
  Extent size;
  double x(std::uint32_t column) const { return (column + 0.5) * sheet / size.width; }
  double y(std::uint32_t row) const { return (row + 0.5) * sheet / size.height; }
};

/// The texels whose centres lie in [lo, hi) of an axis with `texels` texels.
struct Range {
  std::uint32_t begin, end;
};
Range texels_between(double lo, double hi, std::uint32_t texels) {
  const auto first_at_or_after = [texels](double units) {
    return static_cast<std::uint32_t>(std::clamp(std::ceil(units * texels / sheet - 0.5), 0.0, double{1} * texels));
  };
  return {first_at_or_after(lo), first_at_or_after(hi)};
}

/// An interval of one axis [units].
struct Interval {
  double lo, hi;
};

/// Sets every texel whose centre (x, y) has y in `rows`, x in across(y) and inside(x, y) to value(x, y); later shapes
/// cover earlier ones. `across` only saves work: it may be wider than the shape.
template <class Across, class Inside, class Value>
void paint(Image& image, Interval rows, const Across& across, const Inside& inside, const Value& value) {
  const Sheet at{image.size};
  const Range lines = texels_between(rows.lo, rows.hi, image.size.height);
  for (std::uint32_t j = lines.begin; j < lines.end; ++j) {
    const double y = at.y(j);
    const Interval reach = across(y);
    const Range columns = texels_between(reach.lo, reach.hi, image.size.width);
    for (std::uint32_t i = columns.begin; i < columns.end; ++i) {
      const double x = at.x(i);
      if (inside(x, y)) *image.texel(i, j) = static_cast<float>(value(x, y));
    }
  }
}

/// value(x, y) at every texel centre; rows go to any thread.
template <class Value>
Image fill(Extent size, const Value& value) {
  Image image(size, 1);
  const Sheet at{size};
#pragma omp parallel for schedule(static)
  for (std::uint32_t j = 0; j < size.height; ++j) {
    for (std::uint32_t i = 0; i < size.width; ++i) *image.texel(i, j) = static_cast<float>(value(at.x(i), at.y(j)));
  }
  return image;
}

Image plain(Extent size, double value) {
  return fill(size, [value](double, double) { return value; });
}

}  // namespace

Image render_zone(Extent size) {
  constexpr double half_cycles = 300;  // over the first width; 1.5 cycles per pixel at 200 pixels
  return fill(size, [](double x, double y) {
    const double u = x / sheet, v = y / sheet;
    return 0.5 + 0.5 * std::cos(half_cycles * std::numbers::pi * (u * u + v * v));
  });
}

Image render_lines(Extent size) {
  constexpr std::uint64_t lines = 260;
  Image image = plain(size, 0.1);
  for (std::uint64_t k = 0; k < lines; ++k) {
    Rng rng(picture_seed, stream_id("picture lines"), k);
    const double angle = uniform(rng, 0, std::numbers::pi), cx = uniform(rng, 0, sheet), cy = uniform(rng, 0, sheet);
    const double half_width = uniform(rng, 0.7, 2.3), half_length = uniform(rng, 200, 1400);
    const double value = uniform(rng, 0.4, 1.0);
    const double c = std::cos(angle), s = std::sin(angle);
    const double reach = half_length * s + half_width * std::abs(c);  // up and down; s >= 0
    paint(
        image, {cy - reach, cy + reach},
        [&](double y) -> Interval {
          // A row cuts the strip |(y - cy) c - (x - cx) s| < half_width in a short piece, unless both are level.
          const double half_piece = half_width / s, middle = cx + (y - cy) * c / s;
          const double left = std::max(cx - half_length - half_width, middle - half_piece);
          return {left - 1, std::min(cx + half_length + half_width, middle + half_piece) + 1};
        },
        [&](double x, double y) {
          return std::abs((y - cy) * c - (x - cx) * s) < half_width &&
                 std::abs((x - cx) * c + (y - cy) * s) < half_length;
        },
        [&](double, double) { return value; });
  }
  return image;
}

Image render_smooth(Extent size) {
  // Positions are fractions of the sheet; the walls meet the picture's diagonals.
  constexpr double wall = 0.18;
  const auto room = [](double u, double v) {
    if (u < wall && u < v && u < 1 - v) return 0.35 * (0.5 + u);                     // left wall
    if (u > 1 - wall && 1 - u < v && 1 - u < 1 - v) return 0.25 * (1.5 - u);         // right wall
    if (v < wall) return 0.60 - 0.50 * std::hypot(u - 0.5, v - 0.1);                 // ceiling
    if (v > 1 - wall) return 0.55 - 0.40 * std::hypot(u - 0.5, 1 - v);               // floor
    return 0.50 * std::exp(-1.2 * ((u - 0.5) * (u - 0.5) + (v - 0.2) * (v - 0.2)));  // back wall
  };
  const auto soft_shadow = [](double u, double v) {  // an ellipse on the floor with a penumbra
    const double outside = std::hypot((u - 0.36) / 1.4, v - 0.86) - 0.14;
    return 1 - 0.55 / (1 + std::exp(40 * outside));
  };
  struct Box {
    double left, top, right, bottom, lean, value;
  };
  constexpr std::array<Box, 2> boxes{
      {{0.2217, 0.4231, 0.4613, 0.8619, 0.06, 0.50}, {0.5423, 0.6037, 0.7811, 0.9029, -0.05, 0.62}}};
  return fill(size, [&](double x, double y) {
    const double u = x / sheet, v = y / sheet;
    if (std::abs(u - 0.5) < 0.1413 && v > 0.0517 && v < 0.1233) return 1.0;  // the lamp
    double value = room(u, v) * soft_shadow(u, v);
    for (const Box& box : boxes) {
      const double along = u + box.lean * (v - box.top);
      if (along > box.left && along < box.right && v > box.top && v < box.bottom) {
        value = box.value * (1 - 0.5 * (v - box.top) / (box.bottom - box.top));
      }
    }
    return std::max(value, 0.0);
  });
}

Image render_text(Extent size) {
  constexpr double margin = 31.3, smallest = 18, largest = 78;  // [units]
  constexpr std::string_view words =
      "A PICTURE IS A FUNCTION ON THE PLANE. EACH SAMPLE ASKS FOR ITS VALUE AT ONE POINT, AND THE MEAN OF THE ANSWERS "
      "STANDS FOR THE MEAN OF A PIXEL. WHERE THE POINTS LIE DECIDES WHAT THE ERROR LOOKS LIKE: REGULAR POINTS ALIAS, "
      "RANDOM POINTS CLUMP, BLUE NOISE KEEPS ITS DISTANCE. 0123456789 ";
  Image image = plain(size, 1.0);
  std::size_t next = 0;
  double top = margin;
  for (std::uint64_t line = 0; top < sheet - margin; ++line) {
    Rng rng(picture_seed, stream_id("picture text"), line);
    const double height = uniform(rng, smallest, largest);
    const double dot = height / letter_rows;  // side of one square of a letter
    for (double left = margin + uniform(rng, 0, height); left + height < sheet - margin;
         left += dot * (letter_columns + 1)) {
      const Letter& letter = letter_of(words[next]);
      next = (next + 1) % words.size();
      paint(
          image, {top, std::min(top + height, sheet)},
          [&](double) -> Interval {
            return {left, left + dot * letter_columns};
          },
          [&](double x, double y) {
            const auto column = std::min(static_cast<std::size_t>((x - left) / dot), letter_columns - 1);
            const auto row = std::min(static_cast<std::size_t>((y - top) / dot), letter_rows - 1);
            return letter[row][column] == '#';
          },
          [](double, double) { return 0.0; });
    }
    top += height * 4 / 3;
  }
  return image;
}

Image render_disks(Extent size) {
  constexpr std::uint64_t disks = 1400;
  constexpr double smallest = 3, spread = 260;  // [units] of the radius; most disks are small
  constexpr double steepest = 0.001;            // per unit
  Image image = plain(size, 0.5);
  for (std::uint64_t k = 0; k < disks; ++k) {
    Rng rng(picture_seed, stream_id("picture disks"), k);
    const double cx = uniform(rng, 0, sheet), cy = uniform(rng, 0, sheet), chosen = uniform(rng, 0, 1);
    const double radius = smallest + spread * chosen * chosen * chosen * chosen;
    const double value = uniform(rng, 0, 1);
    const double slope_x = uniform(rng, -steepest, steepest), slope_y = uniform(rng, -steepest, steepest);
    paint(
        image, {cy - radius, cy + radius},
        [&](double) -> Interval {
          return {cx - radius, cx + radius};
        },
        [&](double x, double y) { return (x - cx) * (x - cx) + (y - cy) * (y - cy) < radius * radius; },
        [&](double x, double y) { return std::clamp(value + slope_x * (x - cx) + slope_y * (y - cy), 0.0, 1.0); });
  }
  return image;
}

Image render_fbm(Extent size) {
  constexpr int octaves = 9;
  constexpr std::uint32_t coarsest = 4;  // cells per side
  constexpr double gain = 0.62, contrast = 0.4;
  const auto ease = [](double t) { return t * t * (3 - 2 * t); };
  std::vector<double> sum(size.area(), 0.0);
  double amplitude = 1;
  for (int octave = 0; octave < octaves; ++octave, amplitude *= gain) {
    const std::uint32_t cells = coarsest << octave, nodes = cells + 1;
    std::vector<double> lattice(std::size_t{nodes} * nodes);
    for (std::size_t i = 0; i < lattice.size(); ++i) {
      Rng rng(picture_seed, stream_id("picture fbm") + static_cast<std::uint32_t>(octave), i);
      lattice[i] = uniform(rng, -0.5, 0.5);
    }
#pragma omp parallel for schedule(static)
    for (std::uint32_t j = 0; j < size.height; ++j) {
      const double y = (j + 0.5) / size.height * cells;
      const auto row = static_cast<std::size_t>(y);
      const double fy = ease(y - static_cast<double>(row));
      for (std::uint32_t i = 0; i < size.width; ++i) {
        const double x = (i + 0.5) / size.width * cells;
        const auto column = static_cast<std::size_t>(x);
        const double fx = ease(x - static_cast<double>(column));
        const double* upper = lattice.data() + row * nodes + column;
        const double* lower = upper + nodes;
        sum[std::size_t{j} * size.width + i] +=
            amplitude * ((1 - fy) * ((1 - fx) * upper[0] + fx * upper[1]) + fy * ((1 - fx) * lower[0] + fx * lower[1]));
      }
    }
  }
  Image image(size, 1);
  for (std::size_t i = 0; i < sum.size(); ++i) {
    image.texels[i] = static_cast<float>(std::clamp(0.5 + contrast * sum[i], 0.0, 1.0));
  }
  return image;
}

Image render_stipple(Extent size) {
  constexpr double radius = 420;  // [units]
  Image image = plain(size, 0.01);
  const auto everywhere = [](double) -> Interval { return {0, sheet}; };
  paint(
      image, {0, sheet}, everywhere, [](double, double) { return true; },
      [](double x, double) { return 0.01 + 0.99 * x / sheet; });
  const auto disc = [&](double cx, double cy, double value) {
    paint(
        image, {cy - radius, cy + radius}, everywhere,
        [&](double x, double y) { return (x - cx) * (x - cx) + (y - cy) * (y - cy) < radius * radius; },
        [&](double, double) { return value; });
  };
  disc(800, 1500, 1);
  disc(2200, 1500, 0.05);
  return image;
}

}  // namespace abn::harness
