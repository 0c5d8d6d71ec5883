#include "sampling/adaptive/sph_adaptive_thesis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <set>

#include "sampling/contract.h"
#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn {
namespace {

static_assert(StrategyClass<SphAdaptiveThesis>);

using Image = std::function<float(Vec2f)>;

/// All batches of a run on an image, fed back as the film of a renderer does.
struct Result {
  std::vector<std::vector<Vec2f>> passes;
  std::vector<Vec2f> all;
  std::map<std::string, double> diagnostics;
  std::vector<Vec2f> ghosts;
};

std::size_t pixel_of(Vec2f p, Extent plane) {
  return static_cast<std::size_t>(p.y) * plane.width + static_cast<std::size_t>(p.x);
}

Result run(const SamplingTask& task, const SphAdaptiveThesis::Params& params, const Image& image) {
  SphAdaptiveThesis sampler(task, params);
  Grid<PixelStats> pixels(task.plane);
  std::vector<float> values;
  Result result;
  for (;;) {
    const SampleBatch batch = sampler.next({pixels, values});
    if (batch.empty()) break;
    const std::vector<Vec2f> positions(batch.position.begin(), batch.position.end());
    values.clear();
    for (const Vec2f p : positions) {
      EXPECT_TRUE(p.x >= 0 && p.x < static_cast<float>(task.plane.width) && p.y >= 0 &&
                  p.y < static_cast<float>(task.plane.height))
          << p.x << " " << p.y;
      values.push_back(image(p));
      pixels[pixel_of(p, task.plane)].add(values.back());
    }
    result.passes.push_back(positions);
    result.all.insert(result.all.end(), positions.begin(), positions.end());
    EXPECT_LE(result.all.size(), task.budget);
    if (result.all.size() > task.budget) break;
  }
  EXPECT_EQ(result.all.size(), task.budget);
  for (const Diagnostic& d : sampler.diagnostics()) result.diagnostics[d.name] = d.value;
  result.ghosts.assign(sampler.ghosts().begin(), sampler.ghosts().end());
  return result;
}

constexpr Extent small{16, 12};
constexpr std::uint64_t six_spp = 6 * small.area();

/// Without ghosts: a ring around so small a plane costs more than the plane.
SphAdaptiveThesis::Params joined(SphAdaptiveThesis::Params params) {
  params.boundary = "periodic";
  return params;
}

SamplingTask task_of(std::uint64_t budget, Extent plane = small, std::uint64_t seed = 3) {
  return {.plane = plane, .budget = budget, .seed = seed};
}

float flat(Vec2f) { return 0.5F; }

/// 0.5 left of `border`, a fair coin right of it.
Image half_noisy(float border) {
  return [border](Vec2f p) {
    if (p.x < border) return 0.5F;
    const auto place = static_cast<std::uint64_t>(p.x * 65536) * 1000003 + static_cast<std::uint64_t>(p.y * 65536);
    return Rng(7, 1, place).uniform() < 0.5F ? 0.0F : 1.0F;
  };
}

/// Samples right of the middle for every one left of it.
double noisy_to_flat(const Result& result, Extent plane) {
  const auto middle = static_cast<float>(plane.width) / 2;
  const auto left = std::count_if(result.all.begin(), result.all.end(), [&](Vec2f p) { return p.x < middle; });
  return static_cast<double>(result.all.size() - static_cast<std::size_t>(left)) / static_cast<double>(left);
}

std::shared_ptr<const Grid<float>> half_guide(float variance) {
  auto guide = std::make_shared<Grid<float>>(small);
  for (std::uint32_t y = 0; y < small.height; ++y) {
    for (std::uint32_t x = small.width / 2; x < small.width; ++x) guide->at(x, y) = variance;
  }
  return guide;
}

TEST(SphAdaptiveThesis, KeepsTheContract) {
  const Strategy strategy = row<SphAdaptiveThesis>();
  for (const std::uint64_t budget : {1U, 2U, 50U, 400U}) {
    EXPECT_EQ(contract_breaches(strategy, task_of(budget, {12, 10})), std::vector<std::string>{}) << budget;
  }
  EXPECT_EQ(contract_breaches(strategy, task_of(30, {1, 1})), std::vector<std::string>{});
  EXPECT_EQ(contract_breaches(strategy, task_of(60, {1, 40})), std::vector<std::string>{});
  const ParameterWords all_switched = {{"exponent", "0.5"},   {"blur", "1"},         {"map_cells", "2"},
                                       {"redraw", "all"},     {"kernel", "cubic"},   {"boundary", "periodic"},
                                       {"freezing", "false"}, {"background", "true"}};
  EXPECT_EQ(contract_breaches(strategy, task_of(700, {12, 10}), all_switched), std::vector<std::string>{});
}

TEST(SphAdaptiveThesis, EvaluatesOneSamplePerPixelAndPass) {
  for (const std::string redraw : {"never", "surplus", "all"}) {
    const Result result = run(task_of(six_spp), joined({.redraw = redraw}), half_noisy(8));
    EXPECT_GE(result.passes.size(), 6U);
    for (const auto& pass : result.passes) {
      std::set<std::size_t> pixels;
      for (const Vec2f p : pass) EXPECT_TRUE(pixels.insert(pixel_of(p, small)).second);
    }
    EXPECT_EQ(result.passes.front().size(), small.area());  // six a pixel: none is empty at first
    EXPECT_EQ(result.diagnostics.at("emitted_at_once"), 0);
    EXPECT_EQ(result.diagnostics.at("passes"), static_cast<double>(result.passes.size()));
  }
}

/// Passes everything on to an engine and remembers where particles were when they were frozen and how far they strayed.
struct Witness {
  std::map<std::uint32_t, Vec2f> frozen_at;
  double strayed = 0;  // [px]
  std::size_t freezes = 0;
  sph::SolverFactory factory();
};

class WitnessedSolver final : public sph::Solver {
 public:
  WitnessedSolver(std::unique_ptr<sph::Solver> solver, Witness& witness)
      : solver_(std::move(solver)), seen_(&witness) {}
  void set_size_field(const Grid<float>& s) override { solver_->set_size_field(s); }
  void freeze(std::span<const std::uint32_t> ids) override {
    const auto now = solver_->positions();
    for (const std::uint32_t id : ids) seen_->frozen_at.emplace(id, now[id]);
    ++seen_->freezes;
    solver_->freeze(ids);
  }
  sph::RelaxReport relax(int steps, bool early) override {
    const auto report = solver_->relax(steps, early);
    const auto now = solver_->positions();
    for (const auto& entry : seen_->frozen_at) {
      const Vec2f moved = now[entry.first] - entry.second;
      seen_->strayed = std::max(seen_->strayed, std::hypot(double{moved.x}, double{moved.y}));
    }
    return report;
  }
  sph::Evaluation evaluate() override { return solver_->evaluate(); }
  std::span<const Vec2f> positions() override { return solver_->positions(); }
  std::span<const Vec2f> ghosts() override { return solver_->ghosts(); }
  const char* backend() const override { return "witness"; }

 private:
  std::unique_ptr<sph::Solver> solver_;
  Witness* seen_;
};

sph::SolverFactory Witness::factory() {
  return
      [this](const sph::Setup& setup) { return std::make_unique<WitnessedSolver>(sph::make_cpu_solver(setup), *this); };
}

TEST(SphAdaptiveThesis, FrozenParticlesNeverMove) {
  for (const std::string redraw : {"never", "surplus", "all"}) {
    Witness witness;
    SamplingTask task = task_of(six_spp);
    task.solver = witness.factory();
    const Result result =
        run(task, redraw == "never" ? SphAdaptiveThesis::Params{.c_max = 3} : joined({.c_max = 3, .redraw = redraw}),
            half_noisy(8));
    EXPECT_EQ(witness.frozen_at.size(), six_spp);
    EXPECT_LE(witness.strayed, 1e-4) << "redraw " << redraw;  // rounding between pixels and spacings
    // What was evaluated is where the particle stayed.
    std::multiset<std::pair<float, float>> emitted;
    for (const Vec2f p : result.all) emitted.insert({p.x, p.y});
    std::size_t found = 0;
    for (const auto& entry : witness.frozen_at) found += emitted.contains({entry.second.x, entry.second.y}) ? 1 : 0;
    EXPECT_EQ(found, six_spp);
  }
}

TEST(SphAdaptiveThesis, WithoutFreezingNoParticleIsHeld) {
  Witness witness;
  SamplingTask task = task_of(six_spp);
  task.solver = witness.factory();
  const Result moving = run(task, joined({.freezing = false}), half_noisy(8));
  EXPECT_EQ(witness.freezes, 0U);
  EXPECT_NE(moving.all, run(task_of(six_spp), joined({}), half_noisy(8)).all);
}

TEST(SphAdaptiveThesis, AConstantImageEndsNearlyUniform) {
  for (const std::string redraw : {"never", "surplus", "all"}) {
    const Result result = run(task_of(six_spp), {.redraw = redraw, .start = "coarse_cells"}, flat);
    std::vector<int> block(12, 0);  // of 4x4 pixels: 96 samples each
    for (const Vec2f p : result.all) ++block[static_cast<std::size_t>(p.y) / 4 * 4 + static_cast<std::size_t>(p.x) / 4];
    double sum = 0;
    for (const int n : block) sum += (n - 96.0) * (n - 96.0) / 12;
    EXPECT_LT(sum / 96, 0.4) << "variance over mean of the counts; 1 for random samples";
    EXPECT_LE(result.diagnostics.at("largest_count"), 12);
    EXPECT_GT(result.ghosts.size(), 0U);
    for (const Vec2f p : result.ghosts) {
      EXPECT_TRUE(p.x < 0 || p.y < 0 || p.x >= 16 || p.y >= 12) << p.x << " " << p.y;
    }
  }
}

TEST(SphAdaptiveThesis, TheNoisyHalfGetsMoreSamples) {
  const auto ratio = [](const SphAdaptiveThesis::Params& params) {
    return noisy_to_flat(run(task_of(six_spp), joined(params), half_noisy(8)), small);
  };
  const double thesis = ratio({});
  EXPECT_GT(thesis, 1.1);
  // The target is about (2 / 1)^2, which pressure does not reach in time; particles that are drawn come nearer.
  EXPECT_LT(thesis, 2.5);
  EXPECT_GT(ratio({.redraw = "surplus"}), thesis + 0.2);
  EXPECT_GT(ratio({.redraw = "all"}), thesis + 0.3);
  EXPECT_GT(ratio({.c_max = 5}), thesis + 0.1);
  EXPECT_LT(ratio({.c_max = 1}), 1.1);
}

TEST(SphAdaptiveThesis, TheTrueVarianceIsReadFromTheGuide) {
  SamplingTask task = task_of(six_spp);
  EXPECT_THROW(SphAdaptiveThesis(task, {.variance = "true"}), ConfigError);
  try {
    SphAdaptiveThesis sampler(task, {.variance = "true"});
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("--guide true_variance"), std::string::npos) << error.what();
  }
  task.guide = half_guide(0.25F);
  const SphAdaptiveThesis::Params params = joined({.c_max = 3, .variance = "true", .redraw = "all"});
  EXPECT_GT(noisy_to_flat(run(task, params, flat), small), 4) << "the samples say flat, the guide does not";
  EXPECT_NEAR(noisy_to_flat(run(task, joined({.c_max = 3, .redraw = "all"}), flat), small), 1, 0.1);
}

TEST(SphAdaptiveThesis, RedrawnParticlesMeetTheTargetOfEveryPixel) {
  // Without relaxation, what is drawn is what is evaluated. Targets: 9 : 1, so 1.2 and 10.8 of 6 on the average.
  SamplingTask task = task_of(six_spp);
  auto guide = std::make_shared<Grid<float>>(small);
  for (std::size_t i = 0; i < small.area(); i += 2) (*guide)[i] = 0.25F;
  task.guide = guide;
  SphAdaptiveThesis::Params params{.c_max = 3, .variance = "true", .redraw = "all", .iterations = 0};
  params.first_iterations = 0;
  std::vector<int> count(small.area());
  for (const Vec2f p : run(task, joined(params), flat).all) ++count[pixel_of(p, small)];
  for (std::size_t i = 0; i < count.size(); ++i) EXPECT_NEAR(count[i], i % 2 == 0 ? 10.8 : 1.2, 1.81) << i;
}

TEST(SphAdaptiveThesis, NoSurplusNothingIsRedrawn) {
  // A constant image: all that is redrawn is what the white start has too many somewhere.
  const auto moved = [](const std::string& start) {
    SphAdaptiveThesis::Params params = joined({.redraw = "surplus", .iterations = 0, .start = start});
    const Result redrawn = run(task_of(six_spp), params, flat);
    params.redraw = "never";
    std::set<std::pair<float, float>> places;
    for (const Vec2f p : run(task_of(six_spp), params, flat).all) places.insert({p.x, p.y});
    return std::count_if(redrawn.all.begin(), redrawn.all.end(), [&](Vec2f p) { return !places.contains({p.x, p.y}); });
  };
  EXPECT_LT(moved("coarse_cells"), six_spp / 8);
}

TEST(SphAdaptiveThesis, TheExponentReplacesTheMapping) {
  SamplingTask task = task_of(six_spp);
  task.guide = half_guide(1e-4F);  // nothing to eq. 4.1, which divides by 0.25; all to a relative mapping
  const auto ratio = [&](double exponent) {
    return noisy_to_flat(run(task, joined({.exponent = exponent, .variance = "true", .redraw = "all"}), flat), small);
  };
  EXPECT_NEAR(ratio(0), 1, 0.1);
  const double root = ratio(0.5);  // target sqrt(2.04 / .04) = 7.1, smoothed at the border
  EXPECT_GT(root, 4);
  EXPECT_GT(root, ratio(0.25) + 1);
}

TEST(SphAdaptiveThesis, BlurSpreadsWhatOnePixelSaw) {
  SamplingTask task = task_of(six_spp);
  auto guide = std::make_shared<Grid<float>>(small);
  guide->at(8, 6) = 4;  // sixteen times the largest of eq. 4.1
  task.guide = guide;
  const auto near = [&](int blur) {
    const Result result = run(task, joined({.c_max = 3, .variance = "true", .blur = blur, .redraw = "all"}), flat);
    return std::count_if(result.all.begin(), result.all.end(),
                         [](Vec2f p) { return std::hypot(p.x - 8.5F, p.y - 6.5F) < 2.5F; });
  };
  EXPECT_GT(static_cast<double>(near(2)), 1.3 * static_cast<double>(near(0)));
}

TEST(SphAdaptiveThesis, AFinerMapFollowsTheNearestSamples) {
  // All pixels of the middle column see the edge, those beside it do not: a per-pixel map stops there.
  const Image edge = [](Vec2f p) { return p.x < 8.5F ? 0.0F : 1.0F; };
  const auto in_middle_column = [](const Result& result) {
    return std::count_if(result.all.begin(), result.all.end(), [](Vec2f p) { return p.x >= 8 && p.x < 9; });
  };
  const SphAdaptiveThesis::Params per_pixel = joined({.c_max = 3, .redraw = "all"});
  const SphAdaptiveThesis::Params finer = joined({.c_max = 3, .map_cells = 2, .redraw = "all"});
  EXPECT_GT(in_middle_column(run(task_of(six_spp), per_pixel, edge)), 90);  // 72 if uniform
  EXPECT_GT(in_middle_column(run(task_of(six_spp), finer, edge)), 90);
}

TEST(SphAdaptiveThesis, WildFeedbackReachesNoPosition) {
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> wild = {std::nanf(""), inf, -inf, 3e38F, -3e38F, 0.0F, 1e19F};
  for (const int map_cells : {1, 2}) {
    for (const double exponent : {0.0, 0.5, 4.0}) {
      std::size_t at = 0;
      const Image image = [&](Vec2f) { return wild[at++ % wild.size()]; };
      run(task_of(300, {8, 6}), joined({.exponent = exponent, .map_cells = map_cells, .redraw = "all"}), image);
      run(task_of(150, {8, 6}), {.exponent = exponent, .map_cells = map_cells, .iterations = 3}, image);
    }
  }
  auto guide = std::make_shared<Grid<float>>(Extent{5, 3});
  for (std::size_t i = 0; i < 15; ++i) (*guide)[i] = wild[i % wild.size()];
  SamplingTask task = task_of(600, {12, 10});
  task.guide = guide;
  run(task, joined({.exponent = 0.5, .variance = "true", .redraw = "all"}), flat);
}

TEST(SphAdaptiveThesis, AllVarianceInOnePixel) {
  const Image firefly = [](Vec2f p) {
    return p.x >= 5 && p.x < 6 && p.y >= 5 && p.y < 6 && p.x - 5.0F < 0.5F ? 1e4F : 0.5F;
  };
  const Result result = run(task_of(600, {12, 10}), joined({.c_min = 0.125, .c_max = 1, .redraw = "all"}), firefly);
  EXPECT_LE(result.diagnostics.at("largest_count"), 200) << "eq. 4.1 is bounded";
  for (const double exponent : {0.5, 4.0}) {
    const Result relative = run(task_of(600, {12, 10}), joined({.exponent = exponent, .redraw = "all"}), firefly);
    EXPECT_LE(relative.diagnostics.at("largest_count"), 300);
  }
}

TEST(SphAdaptiveThesis, ManySamplesInOnePixelEndTogether) {
  const Result result = run(task_of(500, {2, 1}), joined({.iterations = 2, .most_passes = 20}), flat);
  EXPECT_EQ(result.passes.size(), 20U);
  EXPECT_EQ(result.diagnostics.at("emitted_at_once"), 500 - 40);
}

TEST(SphAdaptiveThesis, WithoutFeedbackOfThePlaneNothingVaries) {
  SphAdaptiveThesis sampler(task_of(300, {10, 5}), {});
  const Grid<PixelStats> none;
  std::size_t count = 0;
  for (SampleBatch batch = sampler.next({none}); !batch.empty(); batch = sampler.next({none})) {
    count += batch.position.size();
  }
  EXPECT_EQ(count, 300U);
}

}  // namespace
}  // namespace abn
