#include "harness/data_path.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>

#include "sampling/error.h"

namespace abn::harness {
namespace {

namespace fs = std::filesystem;

/// Two empty folders, ABN_DATA and the working directory, put back as they were at the end.
class DataPath : public testing::Test {
 protected:
  void SetUp() override {
    if (const char* value = std::getenv("ABN_DATA")) before_ = value;
    unsetenv("ABN_DATA");
    folder_ = fs::path(testing::TempDir()) / ("abn_data_path_" + std::to_string(getpid()));
    working_directory_ = fs::current_path();
    fs::create_directories(folder_ / "chosen");
    fs::create_directories(folder_ / "elsewhere");
    fs::current_path(folder_ / "elsewhere");
  }
  void TearDown() override {
    fs::current_path(working_directory_);
    fs::remove_all(folder_);
    if (before_) {
      setenv("ABN_DATA", before_->c_str(), 1);
    } else {
      unsetenv("ABN_DATA");
    }
  }
  static void write(const fs::path& file) {
    fs::create_directories(file.parent_path());
    std::ofstream(file) << "x";
  }

  fs::path folder_, working_directory_;
  std::optional<std::string> before_;
};

TEST_F(DataPath, EnvironmentComesFirst) {
  setenv("ABN_DATA", (folder_ / "chosen").c_str(), 1);
  write(folder_ / "chosen" / "reference_images" / "apple.png");
  EXPECT_EQ(find_data("reference_images/apple.png"), folder_ / "chosen" / "reference_images" / "apple.png");
  EXPECT_EQ(data_folders().front(), folder_ / "chosen");
}

TEST_F(DataPath, WorkingDirectoryIsNeverSearched) {
  write(folder_ / "elsewhere" / "only_here.toml");
  EXPECT_THROW(find_data("only_here.toml"), IoError);
  for (const fs::path& place : data_folders()) EXPECT_TRUE(place.is_absolute()) << place;
}

TEST_F(DataPath, FallsBackToTheInstalledOrSourceFolder) {
  setenv("ABN_DATA", (folder_ / "chosen").c_str(), 1);  // exists, but is empty
  const fs::path found = find_data("reference_images/MANIFEST.toml");
  EXPECT_TRUE(fs::is_regular_file(found));
  EXPECT_NE(found.parent_path().parent_path(), folder_ / "chosen");
}

TEST_F(DataPath, MissingFileListsThePlaces) {
  setenv("ABN_DATA", (folder_ / "chosen").c_str(), 1);
  try {
    find_data("reference_images/no_such_scene.png");
    FAIL() << "expected an IoError";
  } catch (const IoError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("reference_images/no_such_scene.png"), std::string::npos) << message;
    for (const fs::path& place : data_folders()) EXPECT_NE(message.find(place.string()), std::string::npos) << message;
    EXPECT_NE(message.find("ABN_DATA"), std::string::npos) << message;
  }
}

TEST_F(DataPath, NamesAndVariableThatDependOnTheWorkingDirectoryAreRefused) {
  EXPECT_THROW(find_data("/etc/passwd"), ConfigError);
  EXPECT_THROW(find_data("reference_images/../../secret"), ConfigError);
  EXPECT_THROW(find_data(""), ConfigError);
  setenv("ABN_DATA", "relative/folder", 1);
  EXPECT_THROW(find_data("reference_images/MANIFEST.toml"), ConfigError);
}

}  // namespace
}  // namespace abn::harness
