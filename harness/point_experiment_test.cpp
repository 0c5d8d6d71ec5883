#include "harness/point_experiment.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "harness/point_gallery.h"
#include "sampling/error.h"
#include "sampling/test_folder.h"

namespace abn::harness {
namespace {

const std::string kValid = R"(kind = "points"
name = "small"
counts = [16, 64]
seeds = 3
images = true
metrics = ["relative_radius", "star_discrepancy"]
[[strategy]]
name = "jitter"
[[strategy]]
name = "sobol"
[[strategy]]
name = "halton"
label = "H"
[sweep]
H.scramble = ["owen", "none"]
H.domain = ["plane", "pixel"]
)";

class PointExperiment : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    const auto path = folder_.path() / "experiment.toml";
    std::ofstream(path) << text;
    return path;
  }
  std::string refusal(const std::string& from, const std::string& to) {
    std::string text = kValid;
    text.replace(text.find(from), from.size(), to);
    try {
      load_point_experiment(write(text));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }
  ExperimentOptions options(const std::string& name) {
    ExperimentOptions result;
    result.out = folder_.path() / name;
    result.quiet = true;
    return result;
  }
  TestFolder folder_;
};

TEST_F(PointExperiment, ExpandsInFixedOrderWithEveryCombination) {
  const PointExperimentSpec spec = load_point_experiment(write(kValid));
  const auto choices = spec.choices();
  ASSERT_EQ(choices.size(), 6U);
  EXPECT_EQ(choices[2].label, "H scramble=owen domain=plane");  // the order of the file, not of the alphabet
  EXPECT_EQ(choices[3].label, "H scramble=owen domain=pixel");
  EXPECT_EQ(choices[5].parameters.at("scramble"), "none");
  const auto runs = spec.expand();
  // sobol is the same for every seed.
  ASSERT_EQ(runs.size(), 2U * (5U * 3U + 1U));
  std::set<std::string> keys;
  for (const auto& run : runs) keys.insert(run_key(run));
  EXPECT_EQ(keys.size(), runs.size());
  EXPECT_EQ(experiment_kind(folder_.path() / "experiment.toml"), "points");
}

TEST_F(PointExperiment, EveryMistakeNamesItsLineOrKeyAndTheRemedy) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {refusal("counts = [16, 64]", ""), {"counts = [1024]"}},
      {refusal("counts = [16, 64]", "counts = [16, 16]"), {"counts", "twice"}},
      {refusal("counts = [16, 64]", "counts = [0]"), {":3:", "counts", ">= 1"}},
      {refusal("seeds = 3", "scenes = 3"), {":4:", "scenes", "known:", "density"}},
      {refusal("star_discrepancy", "rmse"), {"rmse", "relative_radius"}},
      {refusal("H.domain", "J.domain"), {"[sweep]", "J", "jitter"}},
      {refusal("H.domain", "H.nonsense"), {"nonsense", "known:", "scramble"}},
      {refusal("[\"plane\", \"pixel\"]", "3"), {"sweep", "[0.1, 0.3]"}},
      {refusal("\"pixel\"]", "\"plane\"]"), {"H.domain", "twice"}},
      {refusal("seeds = 3", "density = \"size:ramp:x\""), {"size field", "ratio"}},
      {refusal("seeds = 3", "density_floor = 3"), {"density_floor", "[0, 1]"}},
      {refusal("\"points\"", "\"images\""), {"kind"}},
  };
  for (const auto& [message, parts] : cases) {
    for (const auto& part : parts)
      EXPECT_NE(message.find(part), std::string::npos) << "'" << message << "' lacks '" << part << "'";
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST_F(PointExperiment, KeyDependsOnWhatChangesTheNumbersOnly) {
  PointRunSpec spec;
  spec.task.strategy = "nrooks";
  spec.task.count = 100;
  PointRunSpec same = spec;
  same.task.strategy = "lhs";  // an alias
  same.label = "something else";
  same.task.parameters["domain"] = "pixel";  // the default, spelled out
  EXPECT_EQ(run_key(same), run_key(spec));
  const auto changed = [&](auto change) {
    PointRunSpec other = spec;
    change(other);
    return run_key(other);
  };
  EXPECT_NE(changed([](PointRunSpec& s) { s.task.seed = 2; }), run_key(spec));
  EXPECT_NE(changed([](PointRunSpec& s) { s.task.count = 101; }), run_key(spec));
  EXPECT_NE(changed([](PointRunSpec& s) { s.density = "size:ramp"; }), run_key(spec));
  EXPECT_NE(changed([](PointRunSpec& s) { s.pixels = {10, 10}; }), run_key(spec));
}

TEST_F(PointExperiment, LeavesRowsTableAndPicturesAndGoesOnWhereItStopped) {
  PointExperimentSpec spec = load_point_experiment(write(kValid));
  spec.counts = {16};
  spec.seeds = 2;
  ExperimentOptions whole = options("whole");
  const ExperimentOutcome outcome = run_experiment(spec, whole);
  EXPECT_EQ(outcome.rows, 11U);
  EXPECT_EQ(outcome.overview, whole.out / "overview.png");
  for (const char* file : {"runs.csv", "table.md", "overview.png", "images/16_jitter_spectrum.png",
                           "map_16_H_relative_radius.png", "points/16_sobol_1.bin"}) {
    EXPECT_TRUE(std::filesystem::exists(whole.out / file)) << file;
  }
  EXPECT_NE(outcome.table.find("| jitter "), std::string::npos);

  // Two shards into one folder, the second of which finds all there is and draws the pictures.
  ExperimentOptions shard = options("shards");
  shard.shards = 2;
  run_experiment(spec, shard);
  EXPECT_FALSE(std::filesystem::exists(shard.out / "overview.png"));
  shard.shard = 1;
  shard.resume = true;
  const ExperimentOutcome second = run_experiment(spec, shard);
  EXPECT_EQ(second.rows, 11U);
  EXPECT_TRUE(std::filesystem::exists(shard.out / "overview.png"));
  EXPECT_EQ(run_experiment(spec, shard).skipped, 5U);
}

TEST_F(PointExperiment, DensityIsDrawnAsStipples) {
  std::string text = kValid;
  text.replace(text.find("seeds = 3"), 9, "density = [\"size:step:3\", \"size:ramp\"]");
  text = text.substr(0, text.find("[sweep]"));
  PointExperimentSpec spec = load_point_experiment(write(text));
  spec.counts = {64};
  const ExperimentOptions out = options("density");
  const ExperimentOutcome outcome = run_experiment(spec, out);
  EXPECT_EQ(outcome.rows, 6U);
  EXPECT_TRUE(std::filesystem::exists(out.out / "overview_size_step_3_64.png"));
  EXPECT_TRUE(std::filesystem::exists(out.out / "images/size_ramp_64_jitter_points.png"));
}

TEST_F(PointExperiment, LabelsThatShareAFileNameAreRefused) {
  std::string text = kValid;
  text.replace(text.find("label = \"H\""), 11, "label = \"jitter\"");
  text = text.substr(0, text.find("[sweep]"));
  EXPECT_THROW(load_point_experiment(write(text)), ConfigError);
  text.replace(text.find("label = \"jitter\""), 16,
               "label = \"s b\"\n[[strategy]]\nname = \"random\"\nlabel = \"s_b\"");
  EXPECT_THROW(run_experiment(load_point_experiment(write(text)), options("same")), ConfigError);
}

}  // namespace
}  // namespace abn::harness
