#include "sampling/atomic_file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <string>

#include "sampling/error.h"
#include "sampling/test_folder.h"

namespace abn {
namespace {

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The message of the IoError that writing there throws; empty if it throws none.
std::string refusal(const std::filesystem::path& target, std::string_view bytes = "x") {
  try {
    write_atomically(target, bytes);
  } catch (const IoError& error) {
    return error.what();
  }
  return {};
}

void expect_mentions(const std::string& message, const std::string& word) {
  EXPECT_NE(message.find(word), std::string::npos) << "'" << message << "' does not say '" << word << "'";
}

TEST(AtomicFile, WholeContentReplacesTheOldOne) {
  const TestFolder folder;
  const auto target = folder.path() / "out.bin";
  const std::string bytes(3'000'000, '\x7f');
  write_atomically(target, "old");
  write_atomically(target, bytes);
  EXPECT_EQ(content(target), bytes);
  EXPECT_EQ(folder.entries(), 1);
  write_atomically(target, "");
  EXPECT_EQ(content(target), "");
}

TEST(AtomicFile, UncommittedLeavesNoTrace) {
  const TestFolder folder;
  const auto target = folder.path() / "out.txt";
  write_atomically(target, "old");
  {
    AtomicFile file(target);
    file.write("half of the new");
    EXPECT_EQ(content(target), "old");
    EXPECT_EQ(folder.entries(), 2);
  }
  EXPECT_EQ(content(target), "old");
  EXPECT_EQ(folder.entries(), 1);
}

TEST(AtomicFile, TemporaryKeepsFolderAndExtensionAndMayBeWrittenByName) {
  const TestFolder folder;
  const auto target = folder.path() / "picture.tar.png";
  AtomicFile file(target);
  EXPECT_EQ(file.temporary().parent_path(), folder.path());
  EXPECT_EQ(file.temporary().extension(), ".png");
  EXPECT_NE(file.temporary(), target);
  std::ofstream(file.temporary()) << "pixels";
  EXPECT_FALSE(std::filesystem::exists(target));
  file.commit();
  EXPECT_EQ(content(target), "pixels");
  EXPECT_EQ(folder.entries(), 1);
}

TEST(AtomicFile, TwoAtOnceDoNotMeet) {
  const TestFolder folder;
  AtomicFile first(folder.path() / "a.txt");
  AtomicFile second(folder.path() / "a.txt");
  EXPECT_NE(first.temporary(), second.temporary());
  first.write("first");
  second.write("second");
  second.commit();
  first.commit();
  EXPECT_EQ(content(folder.path() / "a.txt"), "first");
}

TEST(AtomicFile, SymbolicLinkIsFollowedNotReplaced) {
  const TestFolder folder;
  std::filesystem::create_directory(folder.path() / "real");
  write_atomically(folder.path() / "real/data.txt", "old");
  std::filesystem::create_symlink("real/data.txt", folder.path() / "link.txt");
  write_atomically(folder.path() / "link.txt", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path() / "link.txt"));
  EXPECT_EQ(content(folder.path() / "real/data.txt"), "new");
}

TEST(AtomicFile, OrdinaryPermissionsFollowTheUmask) {
  const TestFolder folder;
  const mode_t before = ::umask(027);
  write_atomically(folder.path() / "out.txt", "x");
  ::umask(before);
  EXPECT_EQ(std::filesystem::status(folder.path() / "out.txt").permissions(), std::filesystem::perms(0640));
}

TEST(AtomicFile, BadTargetsAreNamedWithAReasonAndARemedy) {
  const TestFolder folder;
  write_atomically(folder.path() / "file", "x");

  const std::string missing = refusal(folder.path() / "no/such/out.txt");
  expect_mentions(missing, "no/such/out.txt");
  expect_mentions(missing, "No such file or directory");
  expect_mentions(missing, "create the folder first");

  const std::string under_a_file = refusal(folder.path() / "file/out.txt");
  expect_mentions(under_a_file, "Not a directory");
  expect_mentions(refusal(folder.path()), "name a file, not a folder");
  expect_mentions(refusal(folder.path() / ""), "name a file, not a folder");
  EXPECT_FALSE(refusal("").empty());
  expect_mentions(refusal(folder.path() / (std::string("a.") + std::string(300, 'x'))), "give a shorter name");
  EXPECT_EQ(folder.entries(), 1);
}

TEST(AtomicFile, FullDeviceIsReported) {
  ASSERT_TRUE(std::filesystem::exists("/dev/full")) << "every Linux has it: is /dev mounted?";
  const std::string message = refusal("/dev/full", std::string(100'000, 'x'));
  expect_mentions(message, "/dev/full");
  expect_mentions(message, "No space left on device");
  expect_mentions(message, "the disk is full");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

TEST(AtomicFile, DevicesAreWrittenNotReplaced) {
  EXPECT_EQ(refusal("/dev/null", "nothing"), "");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
  EXPECT_THROW(AtomicFile("/dev/null"), IoError);
}

// A disk that runs full in the middle of a write, without needing one: the process' own size limit.
TEST(AtomicFile, WriteCutShortKeepsTheOldContent) {
  const TestFolder folder;
  const auto target = folder.path() / "out.bin";
  write_atomically(target, "old");

  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 10'000;
  struct sigaction ignore {};
  struct sigaction previous {};
  ignore.sa_handler = SIG_IGN;
  ::sigaction(SIGXFSZ, &ignore, &previous);
  ::setrlimit(RLIMIT_FSIZE, &small);
  const std::string message = refusal(target, std::string(1'000'000, 'x'));
  ::setrlimit(RLIMIT_FSIZE, &before);
  ::sigaction(SIGXFSZ, &previous, nullptr);

  expect_mentions(message, "File too large");
  EXPECT_EQ(content(target), "old");
  EXPECT_EQ(folder.entries(), 1);
}

TEST(AtomicFile, VanishedTemporaryIsAnError) {
  const TestFolder folder;
  AtomicFile file(folder.path() / "out.txt");
  std::filesystem::remove(file.temporary());
  EXPECT_THROW(file.commit(), IoError);
  EXPECT_EQ(folder.entries(), 0);
}

}  // namespace
}  // namespace abn
