#include "harness/rows.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "sampling/error.h"
#include "sampling/test_folder.h"

namespace abn::harness {
namespace {

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

Json row(const std::string& key, double rmse) {
  return {{"key", key}, {"label", "a, \"b\""}, {"scores", {{"rmse", rmse}, {"psnr", nullptr}}}};
}

TEST(RowFile, AppendsTheSameRowToBothFiles) {
  const TestFolder folder;
  RowFile file(folder.path(), {"key", "label", "scores.rmse", "scores.psnr", "absent"}, false);
  file.append(row("k1", 0.25));
  EXPECT_EQ(content(folder.path() / "runs.csv"),
            "key,label,scores.rmse,scores.psnr,absent\nk1,\"a, \"\"b\"\"\",0.25,,\n");
  EXPECT_EQ(Json::parse(content(folder.path() / "runs.jsonl"))["scores"]["rmse"], 0.25);
  EXPECT_TRUE(file.has("k1"));
  EXPECT_FALSE(file.has("k2"));
}

TEST(RowFile, KeepsRowsWhenOpenedAgainAndDropsACutOffLine) {
  const TestFolder folder;
  { RowFile(folder.path(), {"key"}, false).append(row("k1", 1)); }
  { std::ofstream(folder.path() / "runs.jsonl", std::ios::app) << R"({"key":"k2","scor)"; }
  RowFile file(folder.path(), {"key"}, true);
  EXPECT_EQ(file.rows().size(), 1U);
  EXPECT_FALSE(file.has("k2"));
  file.append(row("k2", 2));
  EXPECT_EQ(content(folder.path() / "runs.csv"), "key\nk1\nk2\n");
  RowFile again(folder.path(), {"key"}, true);
  EXPECT_EQ(again.rows().size(), 2U);
  RowFile fresh(folder.path(), {"key"}, false);
  EXPECT_TRUE(fresh.rows().empty());
}

TEST(RowFile, FolderThatIsNotThereIsAnInputError) {
  EXPECT_THROW(RowFile("/nonexistent/folder", {"key"}, false), IoError);
}

}  // namespace
}  // namespace abn::harness
