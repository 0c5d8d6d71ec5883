// What the thesis says its figures show, asserted on our own runs of the shipped experiments with few seeds; the
// committed numbers of 20 seeds are in results/README.md.
#include <gtest/gtest.h>

#include <map>

#include "harness/spec.h"
#include "harness/statistics.h"

namespace abn::harness {
namespace {

/// Scores by scene, label and metric, in the order of the seeds.
using Scores = std::map<std::string, std::map<std::string, std::map<std::string, std::vector<double>>>>;

Scores scores_of(const std::string& experiment, std::uint64_t seeds, const std::vector<std::string>& metric_names) {
  ExperimentSpec spec = load_experiment(find_experiment(experiment));
  spec.seeds = seeds;
  Scores scores;
  std::unique_ptr<Subject> subject;
  for (const RunSpec& run_spec : spec.expand()) {
    if (!subject || subject->spec != run_spec.subject) subject = load_subject(run_spec.subject);
    const RunResult result = run(run_spec, *subject, metric_names);
    for (const auto& score : result.scores)
      scores[run_spec.subject.scene][run_spec.label][score.metric].push_back(score.value);
  }
  return scores;
}

double mean(const std::vector<double>& values) { return summarize(values).mean; }

TEST(Figures, Fig32RegularSamplesAliasAndJitterTurnsItIntoNoise) {
  Scores scores = scores_of("fig_3_2", 3, {"rmse", "spectral_peak", "error_run_length"});
  auto& zone = scores["scene:zone_plate"];
  EXPECT_LT(mean(zone["jitter"]["rmse"]), mean(zone["regular"]["rmse"]));
  for (const char* scene : {"scene:zone_plate", "scene:apple"}) {
    EXPECT_LT(mean(scores[scene]["jitter"]["error_run_length"]),
              0.9 * mean(scores[scene]["regular"]["error_run_length"]))
        << scene;
    EXPECT_LT(mean(scores[scene]["jitter"]["spectral_peak"]), mean(scores[scene]["regular"]["spectral_peak"])) << scene;
  }
}

TEST(Figures, Fig33BlueNoiseHasAtLeastTheStatedReduction) {
  Scores scores = scores_of("fig_3_3", 5, {"rmse"});
  auto& apple = scores["scene:apple"];
  const PairedComparison comparison = compare_paired(apple["sph_blue_noise"]["rmse"], apple["random"]["rmse"]);
  EXPECT_LT(comparison.interval.high, 1 - 0.177);  // "a reduction of roughly 17.7 %"
}

TEST(Figures, Fig35UnscrambledSobolLeavesAPatternBlueNoiseDoesNot) {
  Scores scores = scores_of("fig_3_5", 3, {"spectral_peak"});
  for (const char* scene : {"scene:zone_plate", "scene:apple"}) {
    EXPECT_LT(mean(scores[scene]["sph_blue_noise"]["spectral_peak"]), mean(scores[scene]["sobol"]["spectral_peak"]))
        << scene;
  }
}

TEST(Figures, Fig42BlueNoiseBeatsJitterOnTheAppleByTheCheckValue) {
  Scores scores = scores_of("fig_4_2", 3, {"rmse"});
  auto& apple = scores["scene:apple"];
  EXPECT_NEAR(mean(apple["sph_blue_noise"]["rmse"]), 0.0245, 0.03 * 0.0245);
  EXPECT_NEAR(mean(apple["jitter 2x3"]["rmse"]) / mean(apple["sph_blue_noise"]["rmse"]), 1.08, 0.03 * 1.08);
}

}  // namespace
}  // namespace abn::harness
