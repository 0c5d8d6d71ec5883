#include "harness/summary.h"

#include <gtest/gtest.h>

namespace abn::harness {
namespace {

Json row(const std::string& label, std::uint64_t seed, double rmse) {
  return {{"scene", "scene:ramp"},
          {"samples", 100},
          {"label", label},
          {"seed", seed},
          {"scores", {{"rmse", rmse}}},
          {"time", {{"generate_s", 0.002}, {"total_s", 0.003}}}};
}

TEST(Summary, SaysBetterOnlyWhereTheIntervalExcludesOne) {
  std::vector<Json> rows;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const double noise = 1.0 + 0.01 * static_cast<double>(seed % 5);
    rows.push_back(row("base", seed, 0.1 * noise));
    rows.push_back(row("half", seed, 0.05 * noise * (seed % 2 == 0 ? 1.01 : 0.99)));
    rows.push_back(row("tied", seed, 0.1 * noise * (seed % 2 == 0 ? 1.05 : 0.9523)));
    rows.push_back(row("double", seed, 0.2 * noise));
  }
  const std::string table = summary_table(rows, "base");
  const auto line = [&](const std::string& label) {
    const auto begin = table.find("| " + label);
    return table.substr(begin, table.find('\n', begin) - begin);
  };
  EXPECT_NE(line("half").find("0.500 ["), std::string::npos) << table;
  EXPECT_NE(line("half").find("better"), std::string::npos);
  EXPECT_EQ(line("tied").find("better"), std::string::npos) << table;
  EXPECT_EQ(line("tied").find("worse"), std::string::npos);
  EXPECT_NE(line("double").find("worse"), std::string::npos);
  EXPECT_NE(line("base").find("| 1 "), std::string::npos);
  EXPECT_NE(line("base").find(" 20 |"), std::string::npos);
}

TEST(Summary, PairsBySeedWhateverTheOrderOfTheRows) {
  const std::vector<Json> rows = {row("a", 1, 1), row("a", 2, 4), row("b", 2, 2), row("b", 1, 0.5)};
  EXPECT_NE(summary_table(rows, "a").find("0.500 [0.500, 0.500]"), std::string::npos) << summary_table(rows, "a");
}

TEST(Summary, OneSeedOrAnUndefinedErrorGivesNoInterval) {
  std::vector<Json> rows = {row("a", 1, 0.5), row("b", 1, 0.25)};
  EXPECT_EQ(summary_table(rows, "a").find('['), summary_table(rows, "a").find("[95 %]"));
  rows[1]["scores"]["rmse"] = nullptr;
  EXPECT_NE(summary_table(rows, "a").find("–"), std::string::npos);
}

TEST(Summary, ComparesInsideEveryRegion) {
  std::vector<Json> rows;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    rows.push_back(row("a", seed, 0.1));
    rows.back()["regions"] = {{"stalk", 0.2}, {"far", 0.1}};
    rows.push_back(row("b", seed, 0.1));
    rows.back()["regions"] = {{"stalk", 0.1}, {"far", 0.4}};
  }
  const std::string table = summary_table(rows, "a");
  EXPECT_NE(table.find("| stalk  | b        | 0.10000 ± 0.00000 "), std::string::npos) << table;
  EXPECT_NE(table.find("| 0.500 [0.500, 0.500] better "), std::string::npos) << table;
  EXPECT_NE(table.find("| 4.000 [4.000, 4.000] worse "), std::string::npos) << table;
  EXPECT_EQ(summary_table({row("a", 1, 0.1)}, "a").find("region"), std::string::npos);
}

TEST(Summary, RunsThatStopEarlyStandInTheTableOfTheirBudget) {
  std::vector<Json> rows = {row("a", 1, 0.1), row("a", 2, 0.1)};
  for (Json& row : rows) row["budget"] = 400;
  rows[0]["samples"] = 100;
  rows[0]["spp"] = 1;
  rows[1]["samples"] = 300;
  rows[1]["spp"] = 3;
  rows[1]["calibration"] = {{"rmse_ratio", 0.9}};
  const std::string table = summary_table(rows, "a");
  EXPECT_EQ(table.find("samples:"), table.rfind("samples:")) << table;
  EXPECT_NE(table.find("400 samples:"), std::string::npos);
  EXPECT_NE(table.find("| 2.00 |            0.900 |"), std::string::npos) << table;
}

TEST(Summary, FiltersHaveTheirOwnTables) {
  std::vector<Json> rows = {row("a", 1, 0.1), row("a", 1, 0.2)};
  rows[0]["filter"] = "box";
  rows[1]["filter"] = "gaussian";
  const std::string table = summary_table(rows, "a");
  EXPECT_NE(table.find("filter box, 100 samples"), std::string::npos) << table;
  EXPECT_NE(table.find("filter gaussian, 100 samples"), std::string::npos) << table;
}

}  // namespace
}  // namespace abn::harness
