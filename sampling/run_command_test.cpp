#include "sampling/run_command.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <string>
#include <thread>

#include "sampling/test_folder.h"

namespace abn {
namespace {

using End = CommandResult::End;
constexpr std::size_t plenty = 1U << 24;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Whether a process still runs; one that ended and was not collected yet does not.
bool running(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(file, text);
  const auto bracket = text.rfind(')');
  return bracket != std::string::npos && bracket + 2 < text.size() && text[bracket + 2] != 'Z';
}

/// The number a file holds, waiting for a line of it to appear; 0 after 10 s.
pid_t number_in(const std::filesystem::path& path) {
  for (int i = 0; i < 1000; ++i) {
    std::ifstream file(path);
    std::string line;
    if (std::getline(file, line) && !file.eof()) return std::stoi(line);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return 0;
}

/// Whether it ends within 5 s.
bool ends(pid_t process) {
  for (int i = 0; i < 500 && running(process); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return !running(process);
}

TEST(RunCommand, OutputAndMessagesAreKeptApart) {
  const CommandResult result = run_command("echo out; echo err >&2; exit 4", 60, plenty);
  EXPECT_EQ(result.end, End::exited);
  EXPECT_EQ(result.code, 4);
  EXPECT_EQ(result.output, "out\n");
  EXPECT_EQ(result.messages, "err\n");
}

TEST(RunCommand, NothingComesFromStandardInput) { EXPECT_EQ(run_command("cat", 60, plenty).output, ""); }

TEST(RunCommand, BothStreamsMayOverflowTheirPipes) {
  const CommandResult result =
      run_command("head -c 3000000 /dev/zero; head -c 3000000 /dev/zero >&2; echo last >&2", 60, plenty);
  EXPECT_EQ(result.output.size(), 3'000'000U);
  EXPECT_LE(result.messages.size(), 65536U);
  EXPECT_TRUE(result.messages.ends_with("last\n"));
}

TEST(RunCommand, TimeLimitKillsTheWholeGroup) {
  const TestFolder folder;
  const auto file = folder.path() / "pid";
  const auto start = std::chrono::steady_clock::now();
  const CommandResult result =
      run_command("sh -c 'trap \"\" TERM INT; echo $$ > " + file.string() + "; sleep 60; sleep 60' & wait", 1, plenty);
  EXPECT_EQ(result.end, End::timed_out);
  EXPECT_LT(seconds_since(start), 20);
  const pid_t grandchild = number_in(file);
  ASSERT_GT(grandchild, 0);
  EXPECT_TRUE(ends(grandchild));
}

TEST(RunCommand, BackgroundProcessNeitherHoldsUpNorStays) {
  const auto start = std::chrono::steady_clock::now();
  const CommandResult result = run_command("sleep 60 & echo $!", 60, plenty);
  EXPECT_LT(seconds_since(start), 20);
  EXPECT_EQ(result.end, End::exited);
  EXPECT_TRUE(ends(std::stoi(result.output)));
}

TEST(RunCommand, EndlessOutputIsCutOff) {
  const CommandResult result = run_command("yes", 60, 1'000'000);
  EXPECT_EQ(result.end, End::printed_too_much);
  EXPECT_LT(result.output.size(), 1'200'000U);
}

// Ctrl-C: this process alone gets the signal here, because the command has a group of its own.
TEST(RunCommand, InterruptEndsBothAsIfNothingHadBeenBetween) {
  const TestFolder folder;
  const auto file = folder.path() / "pid";
  const pid_t child = ::fork();
  if (child == 0) {
    run_command("sleep 60 & echo $! > " + file.string() + "; wait", 60, plenty);
    ::_exit(0);
  }
  const pid_t sleeper = number_in(file);
  ASSERT_GT(sleeper, 0);
  ::kill(child, SIGINT);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGINT);
  EXPECT_TRUE(ends(sleeper));
}

volatile sig_atomic_t seen_signal = 0;

TEST(RunCommand, InterruptIsHandedOnToTheHandlerBefore) {
  struct sigaction action {};
  struct sigaction before {};
  action.sa_handler = [](int signal) { seen_signal = signal; };
  ::sigaction(SIGTERM, &action, &before);
  const CommandResult result = run_command("kill -TERM $PPID; sleep 60", 60, plenty);
  EXPECT_EQ(result.end, End::interrupted);
  EXPECT_EQ(result.code, SIGTERM);
  EXPECT_EQ(seen_signal, SIGTERM);
  ::sigaction(SIGTERM, &before, nullptr);
}

TEST(RunCommand, DescriptorsAreGivenBack) {
  const auto open_descriptors = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), std::filesystem::directory_iterator());
  };
  const auto before = open_descriptors();
  for (int i = 0; i < 20; ++i) run_command("exit 1", 60, plenty);
  EXPECT_EQ(open_descriptors(), before);
}

}  // namespace
}  // namespace abn
