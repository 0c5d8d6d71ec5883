#include "sampling/sph_blue_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <tuple>

#include "sampling/error.h"
#include "sampling/points_io.h"
#include "sampling/relaxation_test.h"
#include "sampling/rng.h"
#include "sampling/test_folder.h"

namespace abn {
namespace {

static_assert(StrategyClass<SphBlueNoise>);

std::vector<Vec2f> all_samples(SphBlueNoise& sampler) {
  const Grid<PixelStats> pixels;
  const Feedback nothing{pixels};
  std::vector<Vec2f> samples;
  for (;;) {
    const SampleBatch batch = sampler.next(nothing);
    if (batch.empty()) break;
    EXPECT_LE(batch.position.size(), std::size_t{1} << 20);
    samples.insert(samples.end(), batch.position.begin(), batch.position.end());
  }
  EXPECT_TRUE(sampler.next(nothing).empty());
  return samples;
}

std::vector<Vec2f> sample(Extent plane, std::uint64_t budget, std::uint64_t seed, SphBlueNoise::Params params = {}) {
  SphBlueNoise sampler({.plane = plane, .budget = budget, .seed = seed}, params);
  return all_samples(sampler);
}

TEST(SphBlueNoise, ReachesTheQualityOfTheDesign) {
  // numerics.md section 1, N = 4096 after 25 iterations: .772, .874, .125, 4 to 16.
  const Extent plane{64, 64};
  double least = 0, mean = 0, half_planes = 0, white_half_planes = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SphBlueNoise sampler({.plane = plane, .budget = 4096, .seed = seed}, {});
    const auto samples = all_samples(sampler);
    const Spacing spacing = nearest_neighbours(samples, plane);
    least += spacing.least / 5;
    mean += spacing.mean / 5;
    half_planes += half_plane_error(samples, plane) / 5;
    EXPECT_LE(largest_axis_power(samples, plane), 30) << "seed " << seed;
    for (const Diagnostic& d : sampler.diagnostics()) {
      if (d.name == "mean_displacement") {
        EXPECT_LT(d.value, 0.02);
      }
      EXPECT_FALSE(d.warning) << d.name;
    }
    white_half_planes += half_plane_error(sample(plane, 4096, seed, {.start = "white"}), plane) / 5;
  }
  RecordProperty("relative_radius", std::to_string(least));
  RecordProperty("mean_nearest_neighbour", std::to_string(mean));
  RecordProperty("half_plane_error", std::to_string(half_planes));
  EXPECT_GE(least, 0.70);
  EXPECT_GE(mean, 0.87);
  EXPECT_LE(half_planes, 0.14);
  EXPECT_GE(white_half_planes, 1.5 * half_planes) << "a white start keeps its long waves";
}

TEST(SphBlueNoise, MeasuresTellALatticeAndWhiteNoise) {
  // The bars above can fail: a fine jittered grid has power on the axes, white noise has relative half-plane error 1.
  const Extent plane{64, 64};
  std::vector<Vec2f> lattice, white;
  for (std::uint64_t i = 0; i < 4096; ++i) {
    Rng rng(5, 1, i);
    const Vec2f jitter = rng.uniform2() * 0.3F;
    lattice.push_back({static_cast<float>(i % 64) + jitter.x, static_cast<float>(i / 64) + jitter.y});
    white.push_back(to_plane(rng.uniform2(), plane));
  }
  EXPECT_GT(largest_axis_power(lattice, plane), 1000);
  EXPECT_NEAR(half_plane_error(white, plane), 1.0, 0.4);
  EXPECT_LT(nearest_neighbours(white, plane).mean, 0.5);
}

TEST(SphBlueNoise, EmitsExactlyTheBudgetInsideThePlaneInPixelOrder) {
  for (const auto& [width, height, budget] : {std::tuple{8U, 8U, 1U},
                                              {8U, 8U, 2U},
                                              {8U, 8U, 7U},
                                              {1U, 1U, 100U},
                                              {1U, 2000U, 500U},
                                              {2000U, 1U, 333U},
                                              {37U, 19U, 4001U},
                                              {1000U, 1000U, 50U}}) {
    const Extent plane{width, height};
    const auto samples = sample(plane, budget, 3);
    ASSERT_EQ(samples.size(), budget);
    std::uint64_t last = 0;
    for (const Vec2f p : samples) {
      ASSERT_TRUE(p.x >= 0 && p.x < static_cast<float>(width) && p.y >= 0 && p.y < static_cast<float>(height));
      const std::uint64_t pixel = static_cast<std::uint64_t>(p.y) * width + static_cast<std::uint64_t>(p.x);
      EXPECT_GE(pixel, last);
      last = pixel;
    }
  }
}

TEST(SphBlueNoise, IsReproducibleAndDependsOnTheSeed) {
  const Extent plane{20, 30};
  EXPECT_EQ(sample(plane, 600, 1), sample(plane, 600, 1));
  EXPECT_NE(sample(plane, 600, 1), sample(plane, 600, 2));
  EXPECT_NE(sample(plane, 600, 0), sample(plane, 600, ~std::uint64_t{0}));
}

TEST(SphBlueNoise, UsesTheSolverOfTheTaskAndNamesIt) {
  SamplingTask task{.plane = {16, 16}, .budget = 200};
  int made = 0;
  task.solver = [&](const sph::Setup& setup) {
    ++made;
    return sph::make_cpu_solver_double(setup);
  };
  SphBlueNoise sampler(task, {.tolerance = 0.02});
  EXPECT_TRUE(sampler.diagnostics().empty());
  all_samples(sampler);
  EXPECT_EQ(made, 1);
  const auto diagnostics = sampler.diagnostics();
  const auto find = [&](const char* name) {
    return *std::find_if(diagnostics.begin(), diagnostics.end(), [&](const Diagnostic& d) { return d.name == name; });
  };
  EXPECT_EQ(find("backend").text, "cpu double");
  EXPECT_EQ(find("converged").value, 1);
  EXPECT_LT(find("iterations").value, 25);  // a tolerance stops early
  EXPECT_LT(find("mean_displacement").value, 0.02);
}

TEST(SphBlueNoise, WarnsWhenTheRelaxationDoesNotSettle) {
  SphBlueNoise sampler({.plane = {16, 16}, .budget = 1000},
                       {.delta = 0.01, .iterations = 20, .step = 5, .adaptive_step = false});
  all_samples(sampler);
  int warnings = 0;
  for (const Diagnostic& d : sampler.diagnostics()) warnings += d.warning ? 1 : 0;
  EXPECT_GE(warnings, 1);
}

TEST(SphBlueNoise, RefusesImpossibleBudgets) {
  EXPECT_THROW(SphBlueNoise({.plane = {8, 8}, .budget = 0}, {}), ConfigError);
  EXPECT_THROW(SphBlueNoise({.plane = {8, 8}, .budget = std::uint64_t{1} << 32}, {}), ConfigError);
}

/// The diagnostic of that name; fails the test if there is none.
Diagnostic diagnostic_of(const SphBlueNoise& sampler, const std::string& name) {
  for (const Diagnostic& d : sampler.diagnostics()) {
    if (d.name == name) return d;
  }
  ADD_FAILURE() << "no diagnostic " << name;
  return {};
}

TEST(SphBlueNoise, ASmallStepIsTakenWhereTheFluidIsStiff) {
  for (const double delta : {0.01, 0.05, 1.0}) {
    SphBlueNoise sampler({.plane = {32, 32}, .budget = 1024}, {.delta = delta, .iterations = 60});
    all_samples(sampler);
    EXPECT_LT(diagnostic_of(sampler, "mean_displacement").value, 0.01) << delta;
    EXPECT_FALSE(diagnostic_of(sampler, "mean_displacement").warning) << delta;
  }
}

TEST(SphBlueNoise, EveryKernelStartAndCriterionWorks) {
  const Extent plane{32, 32};
  for (const std::string kernel : {"wendland", "poly6_spiky", "cubic"}) {
    const Spacing spacing = nearest_neighbours(sample(plane, 1024, 1, {.kernel = kernel}), plane);
    EXPECT_GT(spacing.least, 0.6) << kernel;
    EXPECT_GT(spacing.mean, 0.85) << kernel;
  }
  for (const std::string start : {"coarse_cells", "white", "sobol_owen", "jitter"}) {
    EXPECT_GT(nearest_neighbours(sample(plane, 1024, 1, {.start = start}), plane).mean, 0.85) << start;
  }
  SphBlueNoise mean({.plane = plane, .budget = 1024}, {.iterations = 400, .tolerance = 0.01});
  SphBlueNoise every({.plane = plane, .budget = 1024}, {.iterations = 400, .tolerance = 0.01, .criterion = "every"});
  all_samples(mean);
  all_samples(every);
  EXPECT_EQ(diagnostic_of(mean, "converged").value, 1);
  EXPECT_EQ(diagnostic_of(every, "converged").value, 1);
  EXPECT_LT(diagnostic_of(mean, "iterations").value, diagnostic_of(every, "iterations").value);
}

TEST(SphBlueNoise, StartsFromAFile) {
  const TestFolder folder;
  const auto path = (folder.path() / "start.utk").string();
  const Extent plane{16, 8};
  const auto first = sample(plane, 200, 5, {.iterations = 0});
  write_points(path, {.position = first}, plane, PointFormat::utk);
  EXPECT_EQ(sample(plane, 200, 1, {.start = "file:" + path, .iterations = 0}), first);
  EXPECT_NE(sample(plane, 200, 1, {.start = "file:" + path}), first);
  EXPECT_THROW(sample(plane, 201, 1, {.start = "file:" + path}), ConfigError);
  EXPECT_THROW(sample(plane, 200, 1, {.start = "file:" + path + ".missing"}), IoError);
  EXPECT_THROW(sample(plane, 200, 1, {.start = "lattice"}), ConfigError);
}

TEST(SphBlueNoise, GhostsSurroundThePlaneAndKeepTheSamplesInside) {
  SphBlueNoise sampler({.plane = {40, 20}, .budget = 800}, {.boundary = "ghost"});
  const auto samples = all_samples(sampler);
  EXPECT_EQ(samples.size(), 800U);
  EXPECT_EQ(diagnostic_of(sampler, "ghosts").value, static_cast<double>(sampler.ghosts().size()));
  EXPECT_GT(sampler.ghosts().size(), 300U);  // 120 spacings of wall, 3 deep
  for (const Vec2f p : sampler.ghosts()) {
    EXPECT_FALSE(p.x >= 0 && p.x < 40 && p.y >= 0 && p.y < 20);
    EXPECT_TRUE(p.x > -6 && p.x < 46 && p.y > -6 && p.y < 26);
  }
}

TEST(SphBlueNoise, FollowsADensity) {
  // Three times as many samples per area on the right half.
  auto density = std::make_shared<Grid<float>>(Extent{2, 1});
  density->at(0, 0) = 1;
  density->at(1, 0) = 3;
  SphBlueNoise sampler({.plane = {100, 50}, .budget = 20000, .density = density}, {});
  const auto samples = all_samples(sampler);
  ASSERT_EQ(samples.size(), 20000U);
  // The raster is bilinear between its two centres at x = 25 and 75, and periodic.
  double left = 0;
  double right = 0;
  for (const Vec2f p : samples) {
    left += std::abs(p.x - 25) < 2 ? 1 : 0;
    right += std::abs(p.x - 75) < 2 ? 1 : 0;
  }
  EXPECT_NEAR(right / left, 3, 0.25);
  auto bad = std::make_shared<Grid<float>>(Extent{2, 2});
  EXPECT_THROW(SphBlueNoise({.plane = {8, 8}, .budget = 8, .density = bad}, {}), ConfigError);
  bad->at(0, 0) = std::nanf("");
  EXPECT_THROW(SphBlueNoise({.plane = {8, 8}, .budget = 8, .density = bad}, {}), ConfigError);
  bad->at(0, 0) = -1;
  EXPECT_THROW(SphBlueNoise({.plane = {8, 8}, .budget = 8, .density = bad}, {}), ConfigError);
}

TEST(SphBlueNoise, ClassesComeOneAfterTheOtherEachOverTheWholePlane) {
  const Extent plane{30, 30};
  const auto samples = sample(plane, 901, 1, {.classes = 3});
  ASSERT_EQ(samples.size(), 901U);
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t begin = c == 0 ? 0 : 301 + (c - 1) * 300;
    const std::vector<Vec2f> members(samples.begin() + static_cast<std::ptrdiff_t>(begin),
                                     samples.begin() + static_cast<std::ptrdiff_t>(begin + 300));
    EXPECT_GT(nearest_neighbours(members, plane).mean, 0.75) << c;  // white has .46
  }
  EXPECT_THROW(SphBlueNoise({.plane = plane, .budget = 9}, {.boundary = "ghost", .classes = 2}), ConfigError);
}

TEST(SphBlueNoise, TheThesisCellsAreASlowSwitchOfTheTwin) {
  SphBlueNoise sampler({.plane = {8, 8}, .budget = 100}, {.search = "thesis_cells"});
  all_samples(sampler);
  EXPECT_EQ(diagnostic_of(sampler, "backend").text, "twin, thesis cells");
  EXPECT_THROW(SphBlueNoise({.plane = {8, 8}, .budget = 20001}, {.search = "thesis_cells"}), ConfigError);
}

TEST(CoarseCells, GiveEveryCellItsShareWithinOne) {
  const auto check = [](Extent plane, std::uint64_t count, std::uint32_t columns, std::uint32_t rows) {
    const auto positions = coarse_cell_positions(plane, count, 1);
    ASSERT_EQ(positions.size(), count);
    std::vector<std::uint64_t> counts(std::size_t{columns} * rows, 0);
    for (const Vec2f p : positions) {
      ASSERT_TRUE(p.x >= 0 && p.x < static_cast<float>(plane.width) && p.y >= 0 &&
                  p.y < static_cast<float>(plane.height));
      const auto column = static_cast<std::size_t>(double{p.x} * columns / plane.width);
      const auto row = static_cast<std::size_t>(double{p.y} * rows / plane.height);
      ++counts[row * columns + column];
    }
    const auto [least, most] = std::minmax_element(counts.begin(), counts.end());
    EXPECT_LE(*most - *least, 1U);
  };
  check({64, 64}, 4096, 16, 16);
  check({64, 64}, 4100, 16, 16);
  check({1, 2048}, 1024, 1, 64);
  check({256, 64}, 16 * 64, 16, 4);
  check({8, 8}, 1, 1, 1);
}

}  // namespace
}  // namespace abn
