// One contract, every row of the table, several budgets, planes and seeds; and proof that the check itself can fail.
#include "sampling/contract.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>

#include "sampling/rng.h"

namespace abn {
namespace {

struct Case {
  Extent plane;
  std::uint64_t budget;
  std::uint64_t seed;
};

const std::vector<Case> kCases = {
    {{20, 20}, 2400, 1}, {{20, 20}, 400, 7},  {{16, 16}, 4096, 3},  {{20, 20}, 2401, 1}, {{20, 20}, 39, 1},
    {{1, 1}, 1, 1},      {{1, 1}, 7, 2},      {{1, 60}, 240, 1},    {{60, 1}, 360, 0},   {{7, 5}, 35 * 10, UINT64_MAX},
    {{3, 3}, 2, 5},      {{33, 17}, 5000, 1}, {{2, 2}, 4 * 225, 1},
};

// What `file` and `command` need so that they can take part: points of the unit square on the fly.
ParameterWords words_for(const Strategy& strategy, const Case& c) {
  if (strategy.info.name == "file") {
    const auto path = std::filesystem::temp_directory_path() / ("abn_contract_" + std::to_string(c.budget) + ".txt");
    std::ofstream file(path);
    for (std::uint64_t i = 0; i < c.budget; ++i) {
      file << static_cast<double>(i) / static_cast<double>(c.budget) << ' '
           << static_cast<double>((i * 7) % c.budget) / static_cast<double>(c.budget) << '\n';
    }
    return {{"path", path.string()}};
  }
  if (strategy.info.name == "command") {
    return {{"command",
             "awk 'BEGIN { srand({seed} % 1000003 + 17); for (i = 0; i < {n}; ++i) printf \"%.9f %.9f\\n\", rand() * "
             "0.999999, rand() * 0.999999 }'"}};
  }
  return {};
}

TEST(Contract, HoldsForEveryStrategy) {
  for (const auto& strategy : strategies()) {
    int met = 0;
    for (const auto& c : kCases) {
      const ParameterWords words = words_for(strategy, c);
      try {
        for (const auto& breach :
             contract_breaches(strategy, {.plane = c.plane, .budget = c.budget, .seed = c.seed}, words)) {
          ADD_FAILURE() << strategy.info.name << " " << breach << " (plane " << c.plane.width << "x" << c.plane.height
                        << ", budget " << c.budget << ")";
        }
        ++met;
      } catch (const ConfigError& error) {
        // A budget the method cannot meet is refused, naming the nearest ones: allowed, but not as a way out of
        // everything.
        EXPECT_NE(std::string(error.what()).find(std::to_string(c.budget)), std::string::npos)
            << strategy.info.name << ": " << error.what();
      }
    }
    EXPECT_GE(met, strategy.info.name == "regular" ? 5 : static_cast<int>(kCases.size()))
        << strategy.info.name << " refused too many budgets";
  }
}

TEST(Contract, BudgetOfNoSamplesIsRefusedByEveryStrategy) {
  for (const auto& strategy : strategies()) {
    EXPECT_THROW(strategy.make({.plane = {4, 4}, .budget = 0, .seed = 1}, words_for(strategy, {{4, 4}, 4, 1})),
                 ConfigError)
        << strategy.info.name;
  }
}

TEST(Contract, EveryRowTellsWhatItIs) {
  for (const auto& strategy : strategies()) {
    const auto& info = strategy.info;
    for (const auto* text : {&info.name, &info.family, &info.summary, &info.cite, &info.advice, &info.reconstruction}) {
      EXPECT_FALSE(text->empty()) << info.name;
    }
    for (const auto& parameter : strategy.parameters)
      EXPECT_FALSE(parameter.help.empty()) << info.name << "." << parameter.name;
    EXPECT_THROW(static_cast<void>(strategy.resolve({{"no_such_key", "1"}})), ConfigError) << info.name;
  }
}

// A strategy with one fault of choice, to prove that the contract catches it.
enum class Fault {
  kNone,
  kOneTooFew,
  kOneTooMany,
  kOutside,
  kNotFinite,
  kSameForAnySeed,
  kThreadDependent,
  kReadsFeedback,
  kNeverEnds,
  kBadWeight
};

class Faulty : public Sampler {
 public:
  Faulty(const SamplingTask& task, Fault fault) : task_(task), fault_(fault) {}
  SampleBatch next(const Feedback& seen) override;

 private:
  SamplingTask task_;
  Fault fault_;
  bool done_ = false;
  PointSet set_;
};

Strategy faulty(Fault fault) {
  Strategy strategy;
  strategy.info = {.name = "faulty", .family = "test", .summary = "s", .cite = "c", .advice = "a"};
  strategy.make = [fault](const SamplingTask& task, const ParameterWords&) {
    return std::make_unique<Faulty>(task, fault);
  };
  return strategy;
}

SampleBatch Faulty::next(const Feedback& seen) {
  if (done_ && fault_ != Fault::kNeverEnds) return {};
  const std::uint64_t count =
      task_.budget - (fault_ == Fault::kOneTooFew ? 1U : 0U) + (fault_ == Fault::kOneTooMany ? 1U : 0U);
  Rng rng(fault_ == Fault::kSameForAnySeed ? 0 : task_.seed, stream_id("faulty"),
          fault_ == Fault::kThreadDependent ? static_cast<std::uint64_t>(omp_get_max_threads()) : 0U);
  set_.position.resize(count);
  for (auto& p : set_.position) p = to_plane(rng.uniform2(), task_.plane);
  if (fault_ == Fault::kOutside) set_.position[0].x = static_cast<float>(task_.plane.width);
  if (fault_ == Fault::kNotFinite) set_.position[0].y = std::numeric_limits<float>::quiet_NaN();
  if (fault_ == Fault::kReadsFeedback && done_ == false && seen.pixels[0].count > 0) set_.position[0] = {0, 0};
  if (fault_ == Fault::kBadWeight) set_.weight.assign(count, 0.0F);
  // Feedback is read on the second batch: split in two.
  if (fault_ == Fault::kReadsFeedback) {
    if (seen.pixels[0].count == 0) {
      set_.position.resize(task_.budget / 2);
      return set_.view();
    }
    set_.position.resize(task_.budget - task_.budget / 2);
    set_.position[0].x = seen.pixels[1].mean / 200.0F;
  }
  done_ = true;
  return set_.view();
}

TEST(Contract, AcceptsASoundStrategy) {
  EXPECT_TRUE(contract_breaches(faulty(Fault::kNone), {.plane = {4, 4}, .budget = 96, .seed = 1}).empty());
}

TEST(Contract, CatchesEveryKindOfFault) {
  const std::vector<std::pair<Fault, std::string>> faults = {{Fault::kOneTooFew, "95 samples instead of 96"},
                                                             {Fault::kOneTooMany, "97 samples instead of 96"},
                                                             {Fault::kOutside, "outside the plane"},
                                                             {Fault::kNotFinite, "not finite"},
                                                             {Fault::kSameForAnySeed, "another seed"},
                                                             {Fault::kThreadDependent, "2 threads"},
                                                             {Fault::kReadsFeedback, "looks at feedback"},
                                                             {Fault::kNeverEnds, "samples instead of 96"},
                                                             {Fault::kBadWeight, "constant image"}};
  for (const auto& [fault, sentence] : faults) {
    const auto breaches = contract_breaches(faulty(fault), {.plane = {4, 4}, .budget = 96, .seed = 1});
    EXPECT_TRUE(std::any_of(breaches.begin(), breaches.end(), [&](const auto& b) {
      return b.find(sentence) != std::string::npos;
    })) << sentence;
  }
}

}  // namespace
}  // namespace abn
