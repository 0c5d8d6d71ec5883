// What the thesis says its figures show, asserted on our own runs of the shipped experiments with few seeds; the
// committed numbers of 20 seeds are in results/README.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "harness/density.h"
#include "harness/point_experiment.h"
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

/// Measures by density, count, label and metric, in the order of the seeds.
using PointScores =
    std::map<std::string, std::map<std::uint64_t, std::map<std::string, std::map<std::string, std::vector<double>>>>>;

/// Runs those strategies of a shipped experiment on point sets that have one of `labels` (none = all).
PointScores point_scores_of(const std::string& experiment, std::uint64_t seeds,
                            const std::vector<std::string>& labels = {}) {
  PointExperimentSpec spec = load_point_experiment(find_experiment(experiment));
  spec.seeds = seeds;
  if (!labels.empty()) {
    std::erase_if(spec.strategies, [&](const auto& choice) {
      return std::find(labels.begin(), labels.end(), choice.label) == labels.end();
    });
    EXPECT_EQ(spec.strategies.size(), labels.size());
  }
  PointScores scores;
  for (const PointRunSpec& run_spec : spec.expand()) {
    const auto density =
        run_spec.density.empty() ? nullptr : load_density(run_spec.density, {.floor = run_spec.density_floor}).density;
    const PointRunResult result = run(run_spec, density, spec.metrics);
    for (const auto& entry : result.measures.values)
      scores[run_spec.density][run_spec.task.count][run_spec.label][entry.first].push_back(entry.second);
  }
  return scores;
}

double mean(const std::vector<double>& values) { return summarize(values).mean; }

TEST(Figures, Fig22StipplesFollowTheLuminance) {
  PointScores scores = point_scores_of("fig_2_2", 1, {"sph_blue_noise"});
  for (const char* density : {"scene:stipple", "scene:apple"}) {
    auto& stipples = scores[density][20000]["sph_blue_noise"];
    EXPECT_GE(mean(stipples["density_correlation"]), 0.98) << density;
  }
}

TEST(Figures, Fig23SearchInCellsOfTheWrongSizePoolsParticles) {
  PointScores scores = point_scores_of("fig_2_3", 1);
  auto& sets = scores["size:ramp:8"][1500];
  EXPECT_LT(mean(sets["3x3 smallest cells"]["mean_nearest"]), 0.97 * mean(sets["all neighbours"]["mean_nearest"]));
  EXPECT_LT(mean(sets["3x3 smallest cells"]["relative_radius"]), mean(sets["all neighbours"]["relative_radius"]));
}

TEST(Figures, Fig34SpectraHaveTheirAnchors) {
  PointScores scores = point_scores_of("fig_3_4", 10, {"random", "jitter", "poisson_disk", "sph_blue_noise"});
  auto& sets = scores[""][1024];
  const auto value = [&](const char* label, const char* metric) { return mean(sets[label][metric]); };
  EXPECT_EQ(value("random", "effective_nyquist"), 0);
  EXPECT_NEAR(value("random", "low_power"), 1, 0.1);
  EXPECT_NEAR(value("jitter", "effective_nyquist"), 0.21, 0.05);
  EXPECT_NEAR(value("poisson_disk", "effective_nyquist"), 0.56, 0.06);
  EXPECT_NEAR(value("poisson_disk", "oscillation"), 1.4, 0.15);
  EXPECT_NEAR(value("poisson_disk", "relative_radius"), 0.71, 0.05);
  EXPECT_GT(value("sph_blue_noise", "effective_nyquist"), 0.25 + value("poisson_disk", "effective_nyquist"));
  EXPECT_GE(value("sph_blue_noise", "effective_nyquist"), 0.86);
  EXPECT_LE(value("sph_blue_noise", "low_power"), 5e-4);
  EXPECT_LE(value("sph_blue_noise", "largest_axis_power"), 30);
  EXPECT_GE(value("sph_blue_noise", "relative_radius"), 0.70);
  EXPECT_LT(value("sph_blue_noise", "half_plane_error"), 0.7 * value("poisson_disk", "half_plane_error"));
}

TEST(Figures, Fig36PairsOfSobolDimensionsLeaveHalfOfTheCellsEmpty) {
  PointScores scores = point_scores_of("fig_3_6", 1);
  const auto empty = [&](std::uint64_t count, const char* label) {
    return mean(scores[""][count][label]["empty_cells"]);
  };
  EXPECT_EQ(empty(64, "dimensions 10, 11"), 32);
  EXPECT_EQ(empty(1024, "dimensions 18, 19"), 512);
  EXPECT_EQ(empty(256, "dimensions 11, 12"), 128);
  EXPECT_EQ(empty(256, "dimensions 10, 11"), 0);  // the same pair with other counts is fine
  EXPECT_EQ(empty(1024, "dimensions 10, 11"), 0);
  for (const std::uint64_t count : {64U, 256U, 1024U}) EXPECT_EQ(empty(count, "dimensions 0, 1"), 0) << count;
}

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
  Scores scores = scores_of("fig_4_2", 3, {"rmse"}, {"jitter 2x3", "blue noise"});
  auto& apple = scores["scene:apple"];
  EXPECT_NEAR(mean(apple["blue noise"]["rmse"]), 0.0245, 0.03 * 0.0245);
  EXPECT_NEAR(mean(apple["jitter 2x3"]["rmse"]) / mean(apple["blue noise"]["rmse"]), 1.08, 0.03 * 1.08);
}

}  // namespace
}  // namespace abn::harness
