#include "sampling/sph/size_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "sampling/error.h"
#include "sampling/rng.h"
#include "sampling/sph/raster_border.h"
#include "sampling/sph/reach.h"
#include "sampling/sph/size_field_cases.h"
#include "sampling/sph/test_planes.h"

namespace abn::sph {
namespace {

FieldOptions options_for(double length_x, double length_y, bool walls) {
  FieldOptions options;
  options.length_x = length_x;
  options.length_y = length_y;
  options.count = length_x * length_y;
  options.walls = walls;
  return options;
}

/// All cases at their own ratio, and two more.
std::vector<std::string> case_words() {
  std::vector<std::string> words = {"smooth:100", "step:100"};
  for (const SizeFieldCase& field : size_field_cases()) words.push_back(field.name);
  return words;
}

double size_at(const SizeField& field, double x, double y) {
  if (field.uniform) return 1;
  return sample_field(field.view<double>(), wrap(x, field.length_x), wrap(y, field.length_y)).size;
}

/// Mean of s^-2 over the plane by the midpoint rule, `steps` a side.
double mean_over_plane(const SizeField& field, const FieldOptions& options, int steps) {
  double sum = 0;
  for (int j = 0; j < steps; ++j) {
    for (int i = 0; i < steps; ++i) {
      const double s = size_at(field, (i + 0.5) / steps * options.length_x, (j + 0.5) / steps * options.length_y);
      sum += 1 / (s * s);
    }
  }
  return sum / steps / steps;
}

TEST(SphSizeField, LogarithmIsThatOfTheLibrary) {
  for (int k = -2000; k <= 2000; ++k) {
    const double x = std::exp(0.0137 * k);
    EXPECT_NEAR(logarithm(x), std::log(x), 4e-16 * std::max(1.0, std::abs(std::log(x)))) << x;
    const double t = k / 2001.0;
    const double expected = k == 0 ? 1 : std::atanh(t) / t;
    EXPECT_NEAR(inverse_logarithmic_mean(t), expected, t * t < series_below ? 1e-13 : 4e-15) << t;
  }
  EXPECT_TRUE(std::isfinite(inverse_logarithmic_mean(1)) && std::isfinite(inverse_logarithmic_mean(-1)));
}

TEST(SphSizeField, InverseSquareIntegratesToTheArea) {
  // Independent quadrature of the bilinear interpolant, over a smooth field and a jump of 1:100.
  for (const Grid<float>& s : {smooth_size_field({12, 9}, 10), jump_size_field({8, 8}, 100.0F)}) {
    const Grid<float> field = normalised_size_field(s, 1e9);
    const Extent size = field.size();
    double sum = 0;
    const int sub = 200;
    for (std::uint32_t j = 0; j < size.height * sub; ++j) {
      for (std::uint32_t i = 0; i < size.width * sub; ++i) {
        const double value =
            bilinear_periodic(field.cells().data(), size.width, size.height, (i + 0.5) / sub, (j + 0.5) / sub);
        sum += 1 / (value * value);
      }
    }
    EXPECT_NEAR(sum / (static_cast<double>(size.area()) * sub * sub), 1.0, 2e-4);
  }
}

TEST(SphSizeField, IsNormalisedAfterThePreparation) {
  for (const bool walls : {false, true}) {
    for (const std::string& word : case_words()) {
      FieldOptions options = options_for(50, 40, walls);
      options.background = false;
      const SizeField field = prepare_size_field(make_size_field(word, {64, 64}), options);
      EXPECT_EQ(field.uniform, word == "constant");
      // Where s is smallest, this quadrature's step is a good part of it.
      const double tolerance = word == "spikes" || word == "smooth:100" || word == "step:100" ? 0.01 : 2e-3;
      EXPECT_NEAR(mean_over_plane(field, options, 1280), 1.0, tolerance) << word << (walls ? " walls" : "");
    }
  }
}

TEST(SphSizeField, OnlyRatiosCountAndExtremesStayFinite) {
  Grid<float> s({4, 4}, 2.0F);
  s.at(1, 1) = 6.0F;
  Grid<float> scaled = s;
  for (float& value : scaled.cells()) value *= 0x1p100F;
  const auto a = normalised_size_field(s, 100);
  const auto b = normalised_size_field(scaled, 100);
  for (std::size_t i = 0; i < 16; ++i) EXPECT_FLOAT_EQ(a[i], b[i]);
  s.at(0, 0) = std::numeric_limits<float>::max();
  s.at(3, 3) = std::numeric_limits<float>::denorm_min();
  const Grid<float> extreme = normalised_size_field(s, 100);
  for (const float value : extreme.cells()) {
    EXPECT_GT(value, 0.0F);
    EXPECT_LE(value, 100.0F);
  }
  for (const FieldCell& cell : prepare_size_field(s, options_for(20, 20, true)).cells) {
    ASSERT_TRUE(cell.size > 0 && cell.reach >= cell.size && std::isfinite(cell.reach));
    ASSERT_TRUE(std::isfinite(cell.pull_x) && std::isfinite(cell.pull_y));
  }
}

TEST(SphSizeField, RefusesZeroNegativeNonFiniteAndEmpty) {
  const FieldOptions options = options_for(10, 10, false);
  for (const float bad : {0.0F, -1.0F, std::nanf(""), std::numeric_limits<float>::infinity()}) {
    Grid<float> s({3, 3}, 1.0F);
    s.at(2, 1) = bad;
    EXPECT_THROW(normalised_size_field(s, 10), ConfigError) << bad;
    EXPECT_THROW(prepare_size_field(s, options), ConfigError) << bad;
  }
  EXPECT_THROW(prepare_size_field(Grid<float>(), options), ConfigError);
  EXPECT_THROW(prepare_size_field(Grid<float>({0, 4}), options), ConfigError);
}

TEST(SphSizeField, GradientIsLimitedBetweenNeighbours) {
  for (const bool walls : {false, true}) {
    for (const double limit : {0.5, 1.0}) {
      for (const std::string& word : case_words()) {
        FieldOptions options = options_for(60, 45, walls);
        options.background = false;
        options.gradient_limit = limit;
        const SizeField field = prepare_size_field(make_size_field(word, {96, 96}), options);
        if (field.uniform) continue;
        const double cell_x = field.length_x / field.width;
        const double cell_y = field.length_y / field.height;
        // The ring's two halves may meet in a jump; on the torus the plane's sides meet without one.
        const auto in_plane = [](std::uint32_t cells, double margin, double cell) {
          return margin > 0 ? cells - static_cast<std::uint32_t>(std::lround(2 * margin / cell)) - 1 : cells;
        };
        double steepest = 0;
        for (std::uint32_t y = 0; y < in_plane(field.height, field.margin_y, cell_y); ++y) {
          for (std::uint32_t x = 0; x < in_plane(field.width, field.margin_x, cell_x); ++x) {
            const auto s = [&](std::uint32_t u, std::uint32_t v) {
              return double{field.cells[std::size_t{v % field.height} * field.width + u % field.width].size};
            };
            const double rise_x = (s(x + 1, y) - s(x, y)) / cell_x;
            const double rise_y = (s(x, y + 1) - s(x, y)) / cell_y;
            steepest = std::max({steepest, std::abs(rise_x), std::abs(rise_y)});
          }
        }
        // Normalising after the last round scales the gradient a little.
        EXPECT_LE(steepest, limit * 1.04) << word << (walls ? " walls" : "");
      }
    }
  }
}

TEST(SphSizeField, JumpIsBlendedOverAboutOneLargerSpacing) {
  for (const bool walls : {false, true}) {
    FieldOptions options = options_for(200, 40, walls);
    options.background = false;
    const SizeField field = prepare_size_field(make_size_field("step:8", {1024, 8}), options);
    const double large = size_at(field, 150, 20);
    const double small = size_at(field, 50, 20);
    EXPECT_NEAR(large / small, 8, 0.05);
    double first = 0;
    double last = 0;
    for (int k = 0; k < 8000; ++k) {
      const double x = 60 + 0.01 * k;
      const double s = size_at(field, x, 20);
      if (s < small * 1.01) first = x;
      if (s < large * 0.99) last = x;
    }
    EXPECT_GT(last - first, 0.5 * large);
    EXPECT_LT(last - first, 1.1 * large);
  }
}

TEST(SphSizeField, ReachBoundsEveryNeighbour) {
  for (const bool walls : {false, true}) {
    for (const std::string& word : case_words()) {
      FieldOptions options = options_for(22, 18, walls);
      options.background = false;
      const SizeField field = prepare_size_field(make_size_field(word, {48, 48}), options);
      if (field.uniform) continue;
      const FieldView<float> view = field.view<float>();
      struct Particle {
        double x, y;
        FieldSample<float> here;
      };
      std::vector<Particle> particles;
      for (std::uint64_t i = 0; i < 700; ++i) {  // anywhere, also where a particle is unlikely
        const Vec2f unit = Rng(7, stream_id("reach"), i).uniform2();
        const double x = double{unit.x} * field.length_x;
        const double y = double{unit.y} * field.length_y;
        const FieldSample<float> here =
            sample_field(view, wrap(static_cast<float>(x), static_cast<float>(field.length_x)),
                         wrap(static_cast<float>(y), static_cast<float>(field.length_y)));
        particles.push_back({x, y, here});
      }
      std::size_t pairs = 0;
      double tightest = 1e9;
      for (const Particle& a : particles) {
        ASSERT_GE(a.here.reach, a.here.size);
        for (const Particle& b : particles) {
          const double radius = options.support * 0.5 * (double{a.here.size} + double{b.here.size});
          double nearest = 1e9;  // of all images
          for (int v = -1; v <= 1; ++v) {
            for (int u = -1; u <= 1; ++u) {
              nearest = std::min(nearest, std::hypot(a.x - b.x + u * field.length_x, a.y - b.y + v * field.length_y));
            }
          }
          if (nearest >= radius) continue;
          ++pairs;
          tightest = std::min(tightest, double{a.here.reach} / double{b.here.size});
          ASSERT_GE(a.here.reach, b.here.size) << word << (walls ? " walls" : "");
        }
      }
      EXPECT_GT(pairs, particles.size()) << word;
      EXPECT_LT(tightest, 1.3) << "the bound is far too wide: " << word;
    }
  }
}

TEST(SphBackgroundForce, IsZeroForAConstantField) {
  const SizeField field = prepare_size_field(Grid<float>({5, 4}, 3.0F), options_for(20, 20, false));
  EXPECT_TRUE(field.uniform);
  const Pull pull = background_force(field, options_for(20, 20, false), 3, 4, 8, 16);
  EXPECT_EQ(pull.x, 0);
  EXPECT_EQ(pull.y, 0);
}

TEST(SphBackgroundForce, OfAGentleSlopeIsItsFirstOrder) {
  // To first order in grad s: B = grad s pi H^4 / 280 for every kernel, because their moments int g q^3 dq are 1/140.
  for (const Kernel kernel : {Kernel::wendland, Kernel::poly6_spiky, Kernel::cubic}) {
    for (const double support : {2.0, 2.5}) {
      FieldOptions options = options_for(100, 50, false);
      options.kernel = kernel;
      options.support = support;
      Grid<float> s({100, 50});
      for (std::uint32_t y = 0; y < 50; ++y) {
        for (std::uint32_t x = 0; x < 100; ++x) s.at(x, y) = static_cast<float>(1 + 0.02 * std::abs(x + 0.5 - 50.0));
      }
      const SizeField field = prepare_size_field(s, options);
      const double slope = (size_at(field, 80, 25) - size_at(field, 70, 25)) / 10;
      ASSERT_GT(slope, 0.005);
      const double expected = slope * std::numbers::pi * support * support * support * support / 280;
      const Pull right = background_force(field, options, 75.2, 25, 32, 64);
      const Pull left = background_force(field, options, 24.8, 25, 32, 64);
      EXPECT_NEAR(right.x, expected, 5e-3 * expected);
      EXPECT_NEAR(left.x, -expected, 5e-3 * expected);
      EXPECT_NEAR(right.y, 0, 1e-6);
      const FieldSample<double> table = sample_field(field.view<double>(), 75.2, 25.0);
      EXPECT_NEAR(table.pull_x, expected, 1e-3);
    }
  }
}

/// B(x) of size_field.h for the Wendland kernel as it is defined, by the midpoint rule over a square.
Pull by_definition(const SizeField& field, double support, double x, double y) {
  const double here = size_at(field, x, y);
  const double radius = support * 0.5 * (here + field.largest);
  constexpr int steps = 1000;
  const double step = 2 * radius / steps;
  Pull pull;
  for (int j = 0; j < steps; ++j) {
    for (int i = 0; i < steps; ++i) {
      const double dx = -radius + (i + 0.5) * step;
      const double dy = -radius + (j + 0.5) * step;
      const double there = size_at(field, x - dx, y - dy);
      const double factor = 2 / (here + there);
      const double q = std::sqrt(dx * dx + dy * dy) * factor / support;
      if (q >= 1) continue;
      const double weight = (1 - q) * (1 - q) * (1 - q) * factor / (there * there) * step * step;
      pull.x += weight * dx;
      pull.y += weight * dy;
    }
  }
  return pull;
}

TEST(SphBackgroundForce, EqualsItsDefinition) {
  for (const char* word : {"smooth", "ramp", "step"}) {
    const FieldOptions options = options_for(40, 30, false);
    FieldOptions without = options;
    without.background = false;
    const SizeField field = prepare_size_field(make_size_field(word, {64, 64}), without);
    for (std::uint64_t k = 0; k < 4; ++k) {
      const Vec2f unit = Rng(4, stream_id("background"), k).uniform2();
      const double x = double{unit.x} * 40;
      const double y = double{unit.y} * 30;
      const Pull expected = by_definition(field, options.support, x, y);
      const Pull pull = background_force(field, options, x, y, 64, 128);
      EXPECT_NEAR(pull.x, expected.x, 2e-4) << word;
      EXPECT_NEAR(pull.y, expected.y, 2e-4) << word;
    }
  }
}

TEST(SphBackgroundForce, TableIsCloseToAFineRule) {
  for (const std::string& word : case_words()) {
    const FieldOptions options = options_for(50, 40, false);
    const SizeField field = prepare_size_field(make_size_field(word, {96, 96}), options);
    if (field.uniform) continue;
    double worst = 0;
    double total = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < field.cells.size(); i += 37) {
      const double x = (static_cast<double>(i % field.width) + 0.5) / field.width * field.length_x;
      const double y = (static_cast<double>(i / field.width) + 0.5) / field.height * field.length_y;
      const Pull fine = background_force(field, options, x, y, 40, 80);
      const double error = std::hypot(fine.x - double{field.cells[i].pull_x}, fine.y - double{field.cells[i].pull_y});
      worst = std::max(worst, error);
      total += error;
      ++count;
    }
    const bool extreme = word.find(":100") != std::string::npos;
    EXPECT_LT(worst, word == "smooth" ? 5e-3 : extreme ? 0.15 : 0.07) << word;
    EXPECT_LT(total / static_cast<double>(count), extreme ? 0.03 : 5e-3) << word;
    RecordProperty("table_error_" + word,
                   std::to_string(worst) + " worst, mean " + std::to_string(total / static_cast<double>(count)));
  }
}

TEST(SphSizeFieldCases, AreAsNamedAndRefuseWrongWords) {
  for (const SizeFieldCase& field : size_field_cases()) {
    const Grid<float> s = make_size_field(field.name, {64, 64});
    const auto extremes = std::minmax_element(s.cells().begin(), s.cells().end());
    EXPECT_GE(*extremes.first, 1.0F) << field.name;
    EXPECT_LE(*extremes.second, static_cast<float>(field.ratio) * 1.0001F) << field.name;
    EXPECT_GE(*extremes.second / *extremes.first, static_cast<float>(field.ratio) * 0.8F) << field.name;
  }
  EXPECT_FLOAT_EQ(make_size_field("step:3.5", {2, 1}).at(1, 0), 3.5F);
  for (const char* bad : {"", "hill", "step:", "step:0.5", "step:1001", "step:nan", "step:3x", "step:inf"}) {
    EXPECT_THROW(make_size_field(bad, {4, 4}), ConfigError) << bad;
  }
}

/// Lowered until no value rises any more: what limit_gradient() sweeps for.
Grid<float> limited_by_repetition(Grid<float> s, double cell_x, double cell_y, double limit, bool periodic) {
  const auto step_x = static_cast<float>(limit * cell_x);
  const auto step_y = static_cast<float>(limit * cell_y);
  const auto diagonal = static_cast<float>(limit * std::hypot(cell_x, cell_y));
  for (bool changed = true; changed;) {
    changed = false;
    for (std::int64_t y = 0; y < s.size().height; ++y) {
      for (std::int64_t x = 0; x < s.size().width; ++x) {
        for (int v = -1; v <= 1; ++v) {
          for (int u = -1; u <= 1; ++u) {
            if (u == 0 && v == 0) continue;
            const float step = u != 0 && v != 0 ? diagonal : u != 0 ? step_x : step_y;
            float& here = s.at(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
            const float bound =
                s.at(beyond_border(x + u, s.size().width, periodic), beyond_border(y + v, s.size().height, periodic)) +
                step;
            changed = changed || bound < here;
            here = std::min(here, bound);
          }
        }
      }
    }
  }
  return s;
}

TEST(SphSizeField, GradientLimitIsThatOfRepetition) {
  for (const Extent size : {Extent{1, 1}, Extent{2, 1}, Extent{1, 5}, Extent{2, 3}, Extent{3, 2}, Extent{31, 17}}) {
    for (const bool periodic : {false, true}) {
      Grid<float> s(size);
      for (std::size_t i = 0; i < s.cells().size(); ++i) {
        s[i] = 0.2F + 5 * Rng(11, stream_id("rough field"), i).uniform();
      }
      const Grid<float> expected = limited_by_repetition(s, 0.5, 0.7, 1, periodic);
      const bool lowered = !std::equal(s.cells().begin(), s.cells().end(), expected.cells().begin());
      EXPECT_EQ(limit_gradient(s, 0.5, 0.7, 1, periodic), lowered);
      for (std::size_t i = 0; i < s.cells().size(); ++i) ASSERT_EQ(s[i], expected[i]) << size.width << " " << i;
    }
  }
}

TEST(SphSizeField, ReachBoundsEveryPairOfSquares) {
  Grid<float> s({61, 34});
  for (std::size_t i = 0; i < s.cells().size(); ++i) {
    const float u = Rng(12, stream_id("rough field"), i).uniform();
    s[i] = 0.1F + 3 * u * u * u * u;
  }
  s.at(60, 33) = 12;
  const double cell_x = 0.4;
  const double cell_y = 0.6;
  const double half_support = 1;
  const Grid<float> reach = reach_by_block(s, cell_x, cell_y, 2 * half_support);
  const auto most_in = [&](std::uint32_t x, std::uint32_t y) {  // square to the right of and below a cell's centre
    const std::uint32_t right = (x + 1) % 61;
    const std::uint32_t below = (y + 1) % 34;
    return std::max({s.at(x, y), s.at(right, y), s.at(x, below), s.at(right, below)});
  };
  const auto gap = [](std::uint32_t a, std::uint32_t b, std::uint32_t count) {
    const std::uint32_t distance = a > b ? a - b : b - a;
    return static_cast<double>(std::max(std::min(distance, count - distance), 1U) - 1);
  };
  for (std::uint32_t y = 0; y < 34; y += 3) {
    for (std::uint32_t x = 0; x < 61; x += 5) {
      float most = 0;
      for (std::uint32_t v = 0; v < 34; ++v) {
        for (std::uint32_t u = 0; u < 61; ++u) {
          const double distance = std::hypot(gap(x, u, 61) * cell_x, gap(y, v, 34) * cell_y);
          if (distance < half_support * (double{most_in(x, y)} + double{most_in(u, v)})) {
            most = std::max(most, most_in(u, v));
          }
        }
      }
      ASSERT_GE(reach.at(x / reach_block, y / reach_block), most) << x << " " << y;
      ASSERT_LE(reach.at(x / reach_block, y / reach_block), 12.0F);
    }
  }
}

}  // namespace
}  // namespace abn::sph
