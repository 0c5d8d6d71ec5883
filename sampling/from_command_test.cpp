#include "sampling/from_command.h"

#include <gtest/gtest.h>

#include "sampling/blue_noise_test.h"
#include "sampling/error.h"

namespace abn {
namespace {

static_assert(StrategyClass<FromCommand>);

const SamplingTask task{.plane = {20, 10}, .budget = 5, .seed = 42};

template <class Error>
std::string refusal(const std::string& command, double timeout_s = 60) {
  try {
    FromCommand sampler(task, {command, timeout_s});
    const Grid<PixelStats> none(task.plane);
    sampler.next({none});
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

void expect_mentions(const std::string& message, const std::string& word) {
  EXPECT_NE(message.find(word), std::string::npos) << "'" << message << "' does not say '" << word << "'";
}

TEST(FromCommand, PrintedPointsAreScaledToThePlane) {
  for (const char* line : {"0.5 0.25", "(0.5, 0.25)", "0.5,0.25"}) {
    FromCommand sampler(task, {"for i in $(seq {n}); do echo '" + std::string(line) + "'; done"});
    EXPECT_EQ(all_positions(sampler), std::vector<Vec2f>(5, Vec2f{10, 2.5F})) << line;
    EXPECT_TRUE(all_positions(sampler).empty());
  }
}

TEST(FromCommand, WordsInBracesAreSubstitutedOthersStay) {
  FromCommand sampler(task,
                      {"awk 'BEGIN { for (i = 0; i < {n}; ++i) print {seed} / 64, {width} / ({width} + {height} + "
                       "{width} - 18) }'"});
  EXPECT_EQ(all_positions(sampler)[4], (Vec2f{20 * 42 / 64.0F, 10 * 0.625F}));
  expect_mentions(refusal<IoError>("echo {x} {n >&2; exit 1"), "{x} {n");
}

TEST(FromCommand, LargeOutputIsReadWhole) {
  FromCommand sampler({.plane = {1, 1}, .budget = 240'000, .seed = 1},
                      {"awk 'BEGIN { for (i = 0; i < {n}; ++i) printf \"%.17g %.17g\\n\", i / {n}, 0.5 }'"});
  const auto points = all_positions(sampler);
  ASSERT_EQ(points.size(), 240'000U);
  EXPECT_EQ(points[239'999].x, 239'999.0F / 240'000.0F);
}

TEST(FromCommand, FailureShowsStatusAndLastLineOfStandardError) {
  const std::string failed = refusal<IoError>("echo 0.5 0.5; echo first >&2; echo 'out of luck' >&2; exit 7");
  expect_mentions(failed, "exit status 7");
  expect_mentions(failed, "standard error: out of luck");
  EXPECT_EQ(failed.find("first;"), std::string::npos);
  expect_mentions(refusal<IoError>("exit 3"), "said nothing on standard error");
  expect_mentions(refusal<IoError>("no-such-program-anywhere {n}"), "127 (not found");
  expect_mentions(refusal<IoError>("kill -SEGV $$"), "killed by signal 11");
}

TEST(FromCommand, WrongCountIsRefusedWithTheFlag) {
  const std::string message = refusal<ConfigError>("echo 0.5 0.5; echo 0.25 0.25");
  expect_mentions(message, "printed 2 points, but 5");
  expect_mentions(message, "--samples 2");
}

TEST(FromCommand, GarbageIsRefusedWithItsLine) {
  expect_mentions(refusal<IoError>("echo 0.5 0.5; echo hello"), "line 2: 'hello'");
  expect_mentions(refusal<IoError>("true"), "is empty");
  expect_mentions(refusal<IoError>("seq 2 11 | paste - -"), "outside [0,1)");
  expect_mentions(refusal<ConfigError>("yes 0.5 0.5"), "make it print exactly {n}");
}

TEST(FromCommand, TooLongIsKilledAndSaid) {
  const std::string message = refusal<IoError>("echo working >&2; sleep 30", 0.2);
  expect_mentions(message, "longer than 0.2 s");
  expect_mentions(message, "raise timeout_s");
  expect_mentions(message, "working");
}

TEST(FromCommand, NoCommandIsAWrongWord) {
  expect_mentions(refusal<ConfigError>(""), "command:");
  expect_mentions(refusal<ConfigError>("  "), "command:");
}

}  // namespace
}  // namespace abn
