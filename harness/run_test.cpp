#include "harness/run.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>

#include "harness/hard_cases.h"
#include "harness/metrics.h"
#include "harness/record.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

RunSpec spec_for(const std::string& strategy, const std::string& scene, Extent to, std::uint64_t samples) {
  RunSpec spec;
  spec.strategy = strategy;
  spec.subject.scene = scene;
  spec.subject.to = to;
  spec.samples = samples;
  return spec;
}

SubjectSpec subject_for(const std::string& scene, Extent to) {
  SubjectSpec spec;
  spec.scene = scene;
  spec.to = to;
  return spec;
}

double score(const RunResult& result, const std::string& name) {
  for (const auto& s : result.scores) {
    if (s.metric == name) return s.value;
  }
  ADD_FAILURE() << "no score " << name;
  return std::nan("");
}

TEST(Run, ConstantImageHasNoErrorWhateverTheStrategy) {
  const auto subject = load_subject(subject_for("scene:constant", {50, 50}));
  for (const auto& strategy : strategies()) {
    if (strategy.info.family == "outside") continue;
    const RunResult result =
        run(spec_for(strategy.info.name, "scene:constant", {50, 50}, 15000), *subject, {"rmse", "bias"});
    EXPECT_LE(score(result, "rmse"), 1e-6) << strategy.info.name;
    EXPECT_EQ(result.samples, 15000U) << strategy.info.name;
  }
}

TEST(Run, StratifiedBeatsRandomOnARamp) {
  const auto subject = load_subject(subject_for("scene:ramp", {100, 100}));
  const double random =
      score(run(spec_for("random_pixel", "scene:ramp", {100, 100}, 60000), *subject, {"rmse"}), "rmse");
  for (const char* name : {"jitter", "multijitter", "sobol_owen", "cmj", "nrooks", "pmj02", "zero_two"}) {
    EXPECT_LT(score(run(spec_for(name, "scene:ramp", {100, 100}, 60000), *subject, {"rmse"}), "rmse"), 0.6 * random)
        << name;
  }
}

// Independent samples have variance sigma^2/n: the root mean square over pixels is known from the texels alone.
TEST(Run, RandomPixelMatchesThePredictedErrorWithinTwoPercent) {
  const auto subject = load_subject(subject_for("scene:zone_plate", {200, 200}));
  const Image& source = subject->source;
  double variance_sum = 0;
  for (std::uint32_t y = 0; y < 200; ++y) {
    for (std::uint32_t x = 0; x < 200; ++x) {
      double sum = 0;
      double squares = 0;
      for (std::uint32_t j = 0; j < 15; ++j) {
        for (std::uint32_t i = 0; i < 15; ++i) {
          const double value = static_cast<double>(*source.texel(x * 15 + i, y * 15 + j));
          sum += value;
          squares += value * value;
        }
      }
      variance_sum += squares / 225 - (sum / 225) * (sum / 225);
    }
  }
  const double predicted = std::sqrt(variance_sum / 40000 / 6);
  double mean_square = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    RunSpec spec = spec_for("random_pixel", "scene:zone_plate", {200, 200}, 240000);
    spec.seed = seed;
    mean_square += std::pow(score(run(spec, *subject, {"rmse"}), "rmse"), 2) / 4;
  }
  EXPECT_NEAR(std::sqrt(mean_square) / predicted, 1.0, 0.02);
}

TEST(Run, ResultIsTheSameForOneAndTwoThreads) {
  const auto subject = load_subject(subject_for("scene:zone_plate", {60, 60}));
  const int threads = omp_get_max_threads();
  for (const char* name : {"jitter", "sobol_owen", "poisson_disk", "sph_blue_noise"}) {
    omp_set_num_threads(1);
    const RunResult one = run(spec_for(name, "scene:zone_plate", {60, 60}, 21600), *subject, {"rmse"});
    omp_set_num_threads(2);
    const RunResult two = run(spec_for(name, "scene:zone_plate", {60, 60}, 21600), *subject, {"rmse"});
    EXPECT_EQ(one.picture.texels, two.picture.texels) << name;
  }
  omp_set_num_threads(threads);
}

TEST(Run, JsonHasEveryKeyOfTheInterface) {
  const auto subject = load_subject(subject_for("scene:ramp", {20, 20}));
  std::vector<std::string> names;
  for (const auto& metric : metrics()) names.push_back(metric.name);
  const Json json = to_json(run(spec_for("jitter", "scene:ramp", {20, 20}, 2400), *subject, names));
  for (const char* key : {"strategy", "scene", "truth_standard_error", "width", "height", "seed", "samples", "spp",
                          "filter", "reconstruction", "backend", "threads", "params", "scores", "time", "passes",
                          "empty_pixels", "max_samples_per_pixel", "diagnostics"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  for (const char* key : {"rmse", "mae", "psnr", "bias", "relmse", "smape", "ssim", "flip"})
    EXPECT_TRUE(json["scores"].contains(key)) << key;
  for (const char* key : {"generate_s", "evaluate_s", "reconstruct_s", "total_s"})
    EXPECT_TRUE(json["time"].contains(key)) << key;
  EXPECT_EQ(json["samples"], 2400);
  EXPECT_EQ(json["spp"], 6.0);
}

TEST(Run, WrongWordsAreRefusedWithTheirRemedy) {
  RunSpec spec = spec_for("jitter", "scene:ramp", {20, 20}, 400);
  EXPECT_NO_THROW(validate(spec));
  const auto refuses = [&](auto change) {
    RunSpec other = spec;
    change(other);
    EXPECT_THROW(validate(other), ConfigError);
  };
  refuses([](RunSpec& s) { s.strategy = "jiter"; });
  refuses([](RunSpec& s) { s.samples = 0; });
  refuses([](RunSpec& s) { s.samples = UINT64_MAX; });
  refuses([](RunSpec& s) { s.reconstruction = "none"; });
  refuses([](RunSpec& s) { s.subject.filter = "fox"; });
  refuses([](RunSpec& s) { s.subject.truth = "exactly"; });
  refuses([](RunSpec& s) { s.subject.integrand = "analytic"; });
  refuses([](RunSpec& s) { s.subject.on_nonfinite = "ignore"; });
  refuses([](RunSpec& s) { s.backend = "gpu"; });
  refuses([](RunSpec& s) { s.parameters["x"] = "1"; });
  RunSpec cuda = spec;
  cuda.backend = "cuda";
  EXPECT_THROW(validate(cuda), DeviceError);
}

TEST(Run, CorrectsTheMeanOfAnAdaptivePicture) {
  const auto subject = load_subject(subject_for("scene:lines_47", {100, 100}));
  RunSpec spec = spec_for("sph_adaptive", "scene:lines_47", {100, 100}, 60000);
  const RunResult corrected = run(spec, *subject, {"bias"});
  spec.parameters["calibrate"] = "false";
  const RunResult plain = run(spec, *subject, {"bias"});
  EXPECT_LT(plain.scores[0].value, -0.005);
  EXPECT_LT(std::abs(corrected.scores[0].value), 0.003);
}

TEST(Run, AnalyticAppleIsMeasuredAgainstItsMonteCarloTruth) {
  SubjectSpec subject_spec = subject_for("scene:apple_analytic", {16, 16});
  subject_spec.integrand = "analytic";
  EXPECT_THROW(load_subject(subject_spec), ConfigError) << "an exact truth needs texels";
  subject_spec.truth = "monte_carlo:256";
  const auto subject = load_subject(subject_spec);
  RunSpec spec = spec_for("jitter", "scene:apple_analytic", {16, 16}, 4096);
  spec.subject = subject_spec;
  EXPECT_LT(score(run(spec, *subject, {"rmse"}), "rmse"), 0.05);
}

}  // namespace
}  // namespace abn::harness
