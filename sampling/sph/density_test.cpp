// The density of a relaxed plane beside a size field: the aim is s^-2 in every band of s.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "sampling/sph/draw.h"
#include "sampling/sph/problem.h"
#include "sampling/sph/size_field_cases.h"
#include "sampling/sph/solver.h"
#include "sampling/sph/test_planes.h"

namespace abn::sph {
namespace {

constexpr std::size_t band_count = 10;
using Bands = std::array<double, band_count>;

constexpr Extent plane{200, 200};

/// The prepared field of a plane, and its bands of equal population.
class FieldBands {
 public:
  enum class By { size, column };  // bands of s, or of u where s has few values
  /// excluded(u, v, largest s [share of the plane]): places that do not count.
  FieldBands(const Grid<float>& s, std::uint64_t n, std::function<bool(double, double, double)> excluded,
             By by = By::size)
      : excluded_(std::move(excluded)), by_(by) {
    const std::vector<Vec2f> positions(n, Vec2f{0, 0});
    auto setup = setup_of(plane, positions);
    setup.background = false;
    field_ = make_problem(setup, positions, &s).field;
    struct Place {
      double key, mass;
    };
    std::vector<Place> places;
    constexpr int steps = 1200;
    double total = 0;
    for (int j = 0; j < steps; ++j) {
      for (int i = 0; i < steps; ++i) {
        // Every row is shifted by another amount, so that bands of few columns are resolved too.
        const double shift = 0.6180339887498949 * j;
        const double u = (i + shift - std::floor(shift)) / steps;
        const double v = (j + 0.5) / steps;
        if (is_excluded(u, v)) continue;
        places.push_back({key(u, v), std::pow(size_at(u, v), -2)});
        total += places.back().mass;
      }
    }
    std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.key < b.key; });
    std::size_t band = 0;
    double sum = 0;
    for (const Place& place : places) {
      sum += place.mass;
      expected_[band] += place.mass / (steps * steps) * static_cast<double>(n);
      if (band + 1 < band_count && sum >= total * static_cast<double>(band + 1) / band_count) {
        upper_[band++] = place.key;
      }
    }
  }

  double size_at(double u, double v) const {
    return sample_field(field_.view<double>(), u * field_.length_x, v * field_.length_y).size;
  }
  std::vector<Vec2f> start(std::uint64_t n, std::uint64_t seed) const {
    std::vector<Vec2f> positions;
    const auto density = [&](double u, double v) { return std::pow(size_at(u, v), -2); };
    for (const UnitPosition p : draw_by_density(density, 1, n, seed)) {
      positions.push_back(to_plane({static_cast<float>(p.x), static_cast<float>(p.y)}, plane));
    }
    return positions;
  }
  /// Density relative to the aim in every band.
  Bands measure(std::span<const Vec2f> positions) const {
    Bands bands{};
    for (const Vec2f p : positions) {
      const double u = double{p.x} / plane.width;
      const double v = double{p.y} / plane.height;
      if (is_excluded(u, v)) continue;
      const double at = key(u, v);
      std::size_t band = 0;
      while (band + 1 < band_count && at > upper_[band]) ++band;
      bands[band] += 1 / expected_[band];
    }
    return bands;
  }

 private:
  bool is_excluded(double u, double v) const { return excluded_(u, v, field_.largest / field_.length_x); }
  double key(double u, double v) const { return by_ == By::size ? size_at(u, v) : u; }

  std::function<bool(double, double, double)> excluded_;
  By by_;
  SizeField field_;
  Bands expected_{};
  std::array<double, band_count> upper_{};
};

bool nowhere(double, double, double) { return false; }
/// Closer to one of the field's jumps than the larger spacing.
bool beside_a_jump(double u, double, double spacing) {
  return std::abs(u - 0.5) < spacing || u < spacing || u > 1 - spacing;
}

Bands relaxed_bands(const FieldBands& bands, const Grid<float>& s, std::uint64_t n, std::uint64_t seed, bool background,
                    int steps = 25) {
  const std::vector<Vec2f> positions = bands.start(n, seed);
  auto setup = setup_of(plane, positions);
  setup.background = background;
  setup.seed = seed;
  const auto solver = make_cpu_solver(setup);
  solver->set_size_field(s);
  solver->relax(steps, false);
  return bands.measure(solver->positions());
}

std::string text(const Bands& bands) {
  std::string line;
  for (const double band : bands) line += std::to_string(band).substr(0, 5) + " ";
  return line;
}

TEST(SphDensity, OfASmoothFieldIsWithinThreePercentInEveryBand) {
  const Grid<float> s = make_size_field("smooth:10", {200, 200});
  const FieldBands bands(s, 100000, nowhere);
  Bands mean{};
  constexpr int seeds = 5;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const Bands one = relaxed_bands(bands, s, 100000, seed, true);
    for (std::size_t k = 0; k < band_count; ++k) mean[k] += one[k] / seeds;
  }
  RecordProperty("smooth_10", text(mean));
  for (std::size_t k = 0; k < band_count; ++k) EXPECT_NEAR(mean[k], 1, 0.03) << "band " << k;
}

TEST(SphDensity, OfJumpsAndExtremesIsClose) {
  struct Case {
    const char *name, *word;
    std::function<bool(double, double, double)> excluded;
    double tolerance;  // measured, with margin
    FieldBands::By by;
  };
  const Case cases[] = {{"step:10 but beside the jump", "step:10", beside_a_jump, 0.02, FieldBands::By::column},
                        {"step:10", "step:10", nowhere, 0.03, FieldBands::By::column},
                        {"smooth:100", "smooth:100", nowhere, 0.02, FieldBands::By::size},
                        {"ramp:8", "ramp:8", nowhere, 0.02, FieldBands::By::size}};
  for (const Case& one : cases) {
    const Grid<float> s = make_size_field(one.word, {200, 200});
    const FieldBands bands(s, 100000, one.excluded, one.by);
    const Bands measured = relaxed_bands(bands, s, 100000, 1, true);
    RecordProperty(one.name, text(measured));
    RecordProperty(std::string("start of ") + one.name, text(bands.measure(bands.start(100000, 1))));
    for (std::size_t k = 0; k < band_count; ++k) {
      EXPECT_NEAR(measured[k], 1, one.tolerance) << one.name << " band " << k;
    }
  }
}

TEST(SphDensity, WithoutTheBackgroundForceMissesTheAim) {
  const Grid<float> s = make_size_field("smooth:10", {100, 100});
  const FieldBands bands(s, 20000, nowhere);
  const auto worst = [](const Bands& measured) {
    double error = 0;
    for (const double band : measured) error = std::max(error, std::abs(band - 1));
    return error;
  };
  const Bands with = relaxed_bands(bands, s, 20000, 1, true, 100);
  const Bands without = relaxed_bands(bands, s, 20000, 1, false, 100);
  RecordProperty("with", text(with));
  RecordProperty("without", text(without));
  EXPECT_LT(worst(with), 0.05);
  EXPECT_GT(worst(without), 0.10);
  EXPECT_GT(without.back(), 1.05);  // the plain force moves particles to the sparse end
}

}  // namespace
}  // namespace abn::sph
