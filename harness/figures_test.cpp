// What the thesis says its figures show, asserted on our own runs of the shipped experiments with few seeds; the
// committed numbers of 20 seeds are in results/README.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "harness/spec.h"
#include "harness/statistics.h"

namespace abn::harness {
namespace {

/// Scores by scene, label and metric, in the order of the seeds.
using Scores = std::map<std::string, std::map<std::string, std::map<std::string, std::vector<double>>>>;

/// Runs the strategies of a shipped experiment that have one of `labels` (none = all).
Scores scores_of(const std::string& experiment, std::uint64_t seeds, const std::vector<std::string>& metric_names,
                 const std::vector<std::string>& labels = {}) {
  ExperimentSpec spec = load_experiment(find_experiment(experiment));
  spec.seeds = seeds;
  if (!labels.empty()) {
    std::erase_if(spec.strategies, [&](const auto& choice) {
      return std::find(labels.begin(), labels.end(), choice.label) == labels.end();
    });
    EXPECT_EQ(spec.strategies.size(), labels.size());
  }
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

// On the zone plate, most of which no 16 samples can resolve, both have the same RMSE; what differs is that the grid's
// error is a moiré pattern (one strong wave) and that it draws stairs along the apple's edges.
TEST(Figures, Fig32RegularSamplesAliasAndJitterTurnsItIntoNoise) {
  Scores scores = scores_of("fig_3_2", 3, {"rmse", "spectral_peak", "error_run_length"});
  auto& zone = scores["scene:zone_plate"];
  auto& apple = scores["scene:apple"];
  EXPECT_LT(mean(zone["jitter"]["rmse"]), 1.02 * mean(zone["regular"]["rmse"]));
  EXPECT_LT(mean(zone["jitter"]["spectral_peak"]), 0.5 * mean(zone["regular"]["spectral_peak"]));
  EXPECT_LT(mean(apple["jitter"]["error_run_length"]), 0.9 * mean(apple["regular"]["error_run_length"]));
}

TEST(Figures, Fig33BlueNoiseHasAtLeastTheStatedReduction) {
  Scores scores = scores_of("fig_3_3", 5, {"rmse"}, {"random", "sph_blue_noise"});
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
  Scores scores = scores_of("fig_4_2", 3, {"rmse"}, {"jitter 2x3", "sph_blue_noise"});
  auto& apple = scores["scene:apple"];
  EXPECT_NEAR(mean(apple["sph_blue_noise"]["rmse"]), 0.0245, 0.03 * 0.0245);
  EXPECT_NEAR(mean(apple["jitter 2x3"]["rmse"]) / mean(apple["sph_blue_noise"]["rmse"]), 1.08, 0.03 * 1.08);
}

}  // namespace
}  // namespace abn::harness
