#include "sampling/params.h"

#include <gtest/gtest.h>

namespace abn {
namespace {

struct Params {
  double radius = 0.5;
  int steps = 12;
  bool stop_early = true;
  std::string boundary = "periodic";
  std::string path = "";
};

// Named one by one: GCC 12 crashes on this list as a braced return value.
std::vector<Field<Params>> fields() {
  Field<Params> boundary{"boundary", &Params::boundary, "border"};
  boundary.choices = {"periodic", "ghost"};
  const Field<Params> radius{"radius", &Params::radius, "radius [px]", 0.1, 2.0};
  const Field<Params> steps{"steps", &Params::steps, "steps", 0, 100};
  const Field<Params> stop_early{"stop_early", &Params::stop_early, "whether to stop"};
  const Field<Params> path{"path", &Params::path, "a file"};
  return {radius, steps, stop_early, boundary, path};
}

Params parse(const ParameterWords& words) { return parse_parameters("thing", fields(), words); }

std::string complaint(const ParameterWords& words) {
  try {
    parse(words);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(ParseParameters, DefaultsWithoutWords) {
  const Params p = parse({});
  EXPECT_EQ(p.radius, 0.5);
  EXPECT_EQ(p.steps, 12);
  EXPECT_TRUE(p.stop_early);
  EXPECT_EQ(p.boundary, "periodic");
}

TEST(ParseParameters, WordsOverride) {
  const Params p =
      parse({{"radius", "1e-1"}, {"steps", "100"}, {"stop_early", "off"}, {"boundary", "ghost"}, {"path", "a b"}});
  EXPECT_EQ(p.radius, 0.1);
  EXPECT_EQ(p.steps, 100);
  EXPECT_FALSE(p.stop_early);
  EXPECT_EQ(p.boundary, "ghost");
  EXPECT_EQ(p.path, "a b");
}

TEST(ParseParameters, RefusesWithKeyValueAndRemedy) {
  const std::pair<ParameterWords, std::string> cases[] = {
      {{{"radus", "1"}}, "radius"},          {{{"radius", "3"}}, "[0.1, 2]"},       {{{"radius", "nan"}}, "number"},
      {{{"radius", "1x"}}, "number"},        {{{"radius", ""}}, "number"},          {{{"steps", "1.5"}}, "whole"},
      {{{"steps", "-1"}}, "[0, 100]"},       {{{"steps", "99999999999"}}, "range"}, {{{"stop_early", "yes"}}, "true"},
      {{{"boundary", "torus"}}, "periodic"}, {{{"radius", "inf"}}, "number"},
  };
  for (const auto& [words, remedy] : cases) {
    const std::string text = complaint(words);
    EXPECT_NE(text.find(words.begin()->first), std::string::npos) << text;
    EXPECT_NE(text.find("thing"), std::string::npos) << text;
    if (words.begin()->first != "radus") {
      EXPECT_NE(text.find("'" + words.begin()->second + "'"), std::string::npos) << text;
    }
    EXPECT_NE(text.find(remedy), std::string::npos) << text;
  }
}

TEST(ParseParameters, AnAggregateWithoutMembersRefusesEveryWord) {
  struct Empty {};
  EXPECT_NO_THROW(parse_parameters<Empty>("thing", {}, {}));
  EXPECT_THROW(parse_parameters<Empty>("thing", {}, {{"radius", "1"}}), ConfigError);
}

TEST(EchoParameters, ParsesBackToTheSame) {
  const Params p = parse({{"radius", "0.3"}, {"boundary", "ghost"}});
  const ParameterWords words = echo_parameters(fields(), p);
  EXPECT_EQ(words.size(), 5U);
  EXPECT_EQ(words.at("radius"), "0.3");
  EXPECT_EQ(echo_parameters(fields(), parse(words)), words);
}

TEST(DescribeFields, NamesTypesDefaultsAndRanges) {
  const auto descriptions = describe_fields(fields());
  ASSERT_EQ(descriptions.size(), 5U);
  EXPECT_EQ(descriptions[0].type, "number");
  EXPECT_EQ(descriptions[0].default_value, "0.5");
  EXPECT_EQ(descriptions[0].hi, 2.0);
  EXPECT_EQ(descriptions[1].type, "integer");
  EXPECT_EQ(descriptions[2].type, "bool");
  EXPECT_EQ(descriptions[3].type, "choice");
  EXPECT_EQ(descriptions[4].type, "text");
}

}  // namespace
}  // namespace abn
