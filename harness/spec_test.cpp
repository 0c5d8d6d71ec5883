#include "harness/spec.h"

#include <gtest/gtest.h>

#include <fstream>

#include "harness/point_spec.h"
#include "sampling/error.h"
#include "sampling/test_folder.h"

namespace abn::harness {
namespace {

class SpecFile : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    const auto path = folder_.path() / "experiment.toml";
    std::ofstream(path) << text;
    return path;
  }
  /// The message of the ConfigError that loading `text` throws, "" if it throws none.
  std::string refusal(const std::string& text) {
    try {
      load_experiment(write(text));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }
  TestFolder folder_;
};

const std::string kValid = R"(
name = "small"
scenes = ["scene:ramp", "scene:zone_plate"]
to = "20x10"
spp = [1, 4]
seeds = 3
[[strategy]]
name = "jitter"
[[strategy]]
name = "halton"
label = "plain Halton"
set = { scramble = "none" }
)";

TEST_F(SpecFile, ExpandsInFixedOrder) {
  const ExperimentSpec spec = load_experiment(write(kValid));
  const auto runs = spec.expand();
  ASSERT_EQ(runs.size(), 2U * 2U * 2U * 3U);
  EXPECT_EQ(runs[0].subject.scene, "scene:ramp");
  EXPECT_EQ(runs[0].samples, 200U);
  EXPECT_EQ(runs[2].seed, 3U);
  EXPECT_EQ(runs[3].label, "plain Halton");
  EXPECT_EQ(runs[3].parameters.at("scramble"), "none");
  EXPECT_EQ(runs[6].samples, 800U);
  EXPECT_EQ(runs[12].subject.scene, "scene:zone_plate");
  EXPECT_EQ(spec.baseline, "");
  EXPECT_GE(spec.metrics.size(), 9U);
}

TEST_F(SpecFile, FiltersAreExpandedWithinAScene) {
  std::string text = kValid;
  EXPECT_EQ(load_experiment(write(text)).filters, std::vector<std::string>{"box"});
  const auto place = text.find("seeds = 3");
  text.insert(place, "filter = \"lanczos\"\n");
  EXPECT_EQ(load_experiment(write(text)).expand().at(0).subject.filter, "lanczos");
  text.replace(place, 18, "filter = [\"box\", \"gaussian:radius=2\"]");
  const ExperimentSpec spec = load_experiment(write(text));
  const auto runs = spec.expand();
  ASSERT_EQ(runs.size(), 2U * 2U * 2U * 2U * 3U);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    EXPECT_EQ(runs[i].subject.filter, i / 12 % 2 == 0 ? "box" : "gaussian:radius=2");
    EXPECT_EQ(runs[i].subject.scene, i / 24 == 0 ? "scene:ramp" : "scene:zone_plate");
  }
}

TEST_F(SpecFile, EveryMistakeNamesItsLineOrKeyAndTheRemedy) {
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = kValid;
    text.replace(text.find(from), from.size(), to);
    return refusal(text);
  };
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {replaced("seeds = 3", "sedes = 3"), {":6:", "sedes", "known:", "seeds"}},
      {replaced("seeds = 3", "seeds = 0"), {":6:", "seeds", ">= 1"}},
      {replaced("seeds = 3", "seeds = 2.5"), {"seeds", "whole"}},
      {replaced("\"jitter\"", "\"jiter\""), {"jiter", "known:", "jitter"}},
      {replaced("scramble =", "scrumble ="), {"scrumble", "known:", "scramble"}},
      {replaced("\"none\"", "\"maybe\""), {"maybe", "owen"}},
      {replaced("\"20x10\"", "\"20 by 10\""), {"20 by 10", "200x200"}},
      {replaced("\"20x10\"", "\"0x10\""), {"0x10"}},
      {replaced("scene:ramp", "scene:rump"), {"rump", "ramp"}},
      {replaced("spp = [1, 4]", "spp = [1, 4]\nsamples = [3]"), {"either spp", "not both"}},
      {replaced("spp = [1, 4]", ""), {"either spp"}},
      {replaced("spp = [1, 4]", "spp = [0.3333]"), {"not whole", "samples"}},
      {replaced("spp = [1, 4]", "spp = [-1]"), {"spp", "> 0"}},
      {replaced("spp = [1, 4]", "spp = [1, 4]\nmetrics = [\"rmsee\"]"), {"rmsee", "rmse"}},
      {replaced("spp = [1, 4]", "spp = [1, 4]\nbaseline = \"x\""), {"baseline", "jitter"}},
      {replaced("spp = [1, 4]", "spp = [1, 4]\ntruth = \"monte_carlo:1\""), {"monte_carlo:1", ">= 2"}},
      {replaced("spp = [1, 4]", "spp = [1, 4]\nfilter = \"fox\""), {"fox", "known:", "lanczos"}},
      {replaced("spp = [1, 4]", "spp = [1, 4]\nfilter = [\"gaussian:sigma=0\"]"), {"sigma", "'0'", "[0.01, 100]"}},
      {replaced("spp = [1, 4]", "spp = [1, 4]\nfilter = [\"gaussian\", \"gaussian:sigma=0.5\"]"),
       {"filter", "gaussian", "twice"}},
      {replaced("spp = [1, 4]", "spp = [1, 4]\nfilter = []"), {"filter", "list"}},
      {replaced("spp = [1, 4]", "spp = [1, 4]\nintegrand = \"cubic\""), {"cubic", "bilinear"}},
      {replaced("label = \"plain Halton\"", "label = \"jitter\""), {"two strategies", "jitter"}},
      {replaced("name = \"small\"", "name = \"a/b\""), {"name", "/"}},
      {replaced("name = \"small\"", "name = small"), {":2:", "TOML"}},
  };
  for (const auto& [message, parts] : cases) {
    for (const auto& part : parts)
      EXPECT_NE(message.find(part), std::string::npos) << "'" << message << "' lacks '" << part << "'";
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST_F(SpecFile, BudgetThatAStrategyCannotMeetIsRefusedBeforeAnythingRuns) {
  std::string text = kValid;
  text.replace(text.find("\"jitter\""), 8, "\"regular\"");
  text.replace(text.find("spp = [1, 4]"), 12, "samples = [211]");  // a prime: no grid
  EXPECT_NE(refusal(text).find("211"), std::string::npos);
}

TEST_F(SpecFile, MissingFileIsAnInputError) {
  EXPECT_THROW(load_experiment(folder_.path() / "none.toml"), IoError);
  EXPECT_THROW(find_experiment("no_such_experiment"), IoError);
  EXPECT_THROW(find_experiment("folder/none.toml"), IoError);
  EXPECT_TRUE(std::filesystem::exists(find_experiment("main")));
}

TEST_F(SpecFile, OverridesReachEveryEntryOfTheStrategy) {
  ExperimentSpec spec = load_experiment(write(kValid));
  apply_override(spec, "halton.scramble=digit");
  EXPECT_EQ(spec.strategies[1].parameters.at("scramble"), "digit");
  apply_override(spec, "plain Halton.scramble=owen");
  EXPECT_EQ(spec.strategies[1].parameters.at("scramble"), "owen");
  EXPECT_THROW(apply_override(spec, "sobol.dim_x=1"), ConfigError);
  EXPECT_THROW(apply_override(spec, "halton"), ConfigError);
  EXPECT_THROW(apply_override(spec, "halton=1"), ConfigError);
}

TEST(Spec, EveryShippedExperimentIsValid) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(find_experiment("main").parent_path())) {
    if (entry.path().extension() != ".toml") continue;
    if (experiment_kind(entry.path()) == "points") {
      EXPECT_NO_THROW(load_point_experiment(entry.path())) << entry.path();
    } else {
      EXPECT_NO_THROW(load_experiment(entry.path())) << entry.path();
    }
    ++files;
  }
  EXPECT_GE(files, 7);
}

TEST(RunKey, DependsOnEverythingThatChangesTheResultAndOnNothingElse) {
  RunSpec spec;
  spec.strategy = "nrooks";
  spec.subject.scene = "scene:ramp";
  spec.samples = 100;
  const std::string key = run_key(spec);
  RunSpec same = spec;
  same.strategy = "lhs";  // an alias
  same.label = "something else";
  same.parameters["domain"] = "pixel";  // the default, spelled out
  EXPECT_EQ(run_key(same), key);
  const auto changed = [&](auto change) {
    RunSpec other = spec;
    change(other);
    return run_key(other);
  };
  EXPECT_NE(changed([](RunSpec& s) { s.seed = 2; }), key);
  EXPECT_NE(changed([](RunSpec& s) { s.samples = 101; }), key);
  EXPECT_NE(changed([](RunSpec& s) { s.parameters["domain"] = "plane"; }), key);
  EXPECT_NE(changed([](RunSpec& s) { s.subject.truth = "monte_carlo:10"; }), key);
  EXPECT_NE(changed([](RunSpec& s) { s.subject.to = {199, 200}; }), key);
  EXPECT_NE(changed([](RunSpec& s) { s.subject.integrand = "bilinear"; }), key);
}

TEST_F(SpecFile, CloseLooksAndTargetsReachTheRuns) {
  std::string text = kValid;
  text.replace(text.find("seeds"), 0,
               "images = true\nsample_pictures = true\ncrops = [\"centre\"]\nzoom = 5\nguide = \"edges.png\"\n");
  const ExperimentSpec spec = load_experiment(write(text));
  EXPECT_EQ(spec.crops, std::vector<std::string>{"centre"});
  EXPECT_EQ(spec.zoom, 5U);
  EXPECT_TRUE(spec.sample_pictures);
  EXPECT_EQ(spec.expand().front().subject.guide, (folder_.path() / "edges.png").string());
  text.replace(text.find("edges.png"), 9, "true_variance");
  EXPECT_EQ(load_experiment(write(text)).expand().front().subject.guide, "true_variance");
}

TEST_F(SpecFile, CropsAreRegionsOfItsScenes) {
  const auto with = [&](const std::string& line) {
    std::string text = kValid;
    return refusal(text.replace(text.find("seeds"), 0, line + "\n"));
  };
  EXPECT_EQ(with("crops = \"fine_rings\""), "");
  EXPECT_NE(with("crops = \"stalk\"").find("known: centre fine_rings"), std::string::npos) << with("crops = \"stalk\"");
  EXPECT_NE(with("crops = [\"centre\", \"centre\"]").find("lists centre twice"), std::string::npos);
  EXPECT_NE(with("zoom = 101").find("'zoom' is 101"), std::string::npos);
  EXPECT_NE(with("sample_pictures = true").find("add images = true"), std::string::npos);
  EXPECT_NE(with("target_error = 0.1").find("--target-error with jitter"), std::string::npos);
}

}  // namespace
}  // namespace abn::harness
