#include "sampling/run_command.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <mutex>
#include <system_error>

#include "sampling/error.h"

extern char** environ;  // NOLINT: POSIX declares it nowhere

namespace abn {
namespace {

constexpr std::size_t kept_messages = 64 * 1024;
constexpr std::array<int, 3> stop_signals = {SIGINT, SIGTERM, SIGHUP};

// What the handler may touch: the group to kill, and which signal came.
std::atomic<pid_t> running_group{0};
std::atomic<int> caught_signal{0};
static_assert(std::atomic<pid_t>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

extern "C" void kill_running_group(int signal) {
  const int error = errno;
  caught_signal = signal;
  if (const pid_t group = running_group; group > 0) ::kill(-group, SIGKILL);
  errno = error;
}

/// Takes the stop signals over for its lifetime, except those this process ignores. The last act is to hand on one that
/// came meanwhile, to whoever handled it before.
class StopSignals {
 public:
  StopSignals() {
    caught_signal = 0;
    struct sigaction action {};
    action.sa_handler = kill_running_group;
    ::sigemptyset(&action.sa_mask);
    for (std::size_t i = 0; i < stop_signals.size(); ++i) {
      ::sigaction(stop_signals[i], nullptr, &before_[i]);
      if (before_[i].sa_handler != SIG_IGN) ::sigaction(stop_signals[i], &action, nullptr);
    }
  }
  ~StopSignals() {
    running_group = 0;
    for (std::size_t i = 0; i < stop_signals.size(); ++i) ::sigaction(stop_signals[i], &before_[i], nullptr);
    if (const int signal = caught_signal; signal != 0) ::raise(signal);
  }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

 private:
  std::array<struct sigaction, stop_signals.size()> before_{};
};

/// Both ends of a pipe, closed at the end; not inherited by other programs.
struct Pipe {
  int read_end = -1;
  int write_end = -1;

  Pipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
      throw IoError("cannot make a pipe: " + std::generic_category().message(errno));
    }
    read_end = ends[0];
    write_end = ends[1];
    ::fcntl(read_end, F_SETFL, O_NONBLOCK);
  }
  ~Pipe() {
    close(read_end);
    close(write_end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  static void close(int& end) {
    if (end >= 0) ::close(end);
    end = -1;
  }
  /// Appends what is there to `text`; closes at the end of the stream.
  void drain(std::string& text, std::size_t limit) {
    std::array<char, 65536> chunk;
    while (read_end >= 0 && text.size() <= limit) {
      const ssize_t got = ::read(read_end, chunk.data(), chunk.size());
      if (got > 0) {
        text.append(chunk.data(), static_cast<std::size_t>(got));
      } else if (got == 0 || (errno != EAGAIN && errno != EINTR)) {
        close(read_end);
      } else if (errno == EAGAIN) {
        return;
      }
    }
  }
};

pid_t start(const std::string& command, const Pipe& output, const Pipe& messages) {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawnattr_init(&attributes);
  ::posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&files, output.write_end, STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&files, messages.write_end, STDERR_FILENO);
  sigset_t none;
  ::sigemptyset(&none);
  sigset_t defaults;
  ::sigemptyset(&defaults);
  ::sigaddset(&defaults, SIGPIPE);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setsigdefault(&attributes, &defaults);
  ::posix_spawnattr_setpgroup(&attributes, 0);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);

  std::string shell = "/bin/sh";
  std::string option = "-c";
  std::string text = command;
  char* const arguments[] = {shell.data(), option.data(), text.data(), nullptr};

  // No stop signal between the start and the note of the group it would have to kill.
  sigset_t stops;
  sigset_t before;
  ::sigemptyset(&stops);
  for (const int signal : stop_signals) ::sigaddset(&stops, signal);
  ::pthread_sigmask(SIG_BLOCK, &stops, &before);
  pid_t child = 0;
  const int error = ::posix_spawn(&child, shell.c_str(), &files, &attributes, arguments, environ);
  if (error == 0) running_group = child;
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);

  ::posix_spawn_file_actions_destroy(&files);
  ::posix_spawnattr_destroy(&attributes);
  if (error != 0) throw IoError("cannot start /bin/sh: " + std::generic_category().message(error));
  return child;
}

void keep_end(std::string& text) {
  if (text.size() > kept_messages) text.erase(0, text.size() - kept_messages);
}

}  // namespace

CommandResult run_command(const std::string& command, double timeout_s, std::size_t max_output) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  const StopSignals signals;
  Pipe output;
  Pipe messages;
  using Clock = std::chrono::steady_clock;
  const auto deadline =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(timeout_s));

  CommandResult result;
  const pid_t child = start(command, output, messages);
  Pipe::close(output.write_end);
  Pipe::close(messages.write_end);

  bool ended = false;
  while (!ended) {
    std::array<pollfd, 2> streams = {{{output.read_end, POLLIN, 0}, {messages.read_end, POLLIN, 0}}};
    // Woken by output; the tick is for a command that closed its output, or left it to a process in the background.
    ::poll(streams.data(), streams.size(), 10);
    // Seen, not yet collected: its number stays taken, so that the group below is surely ours.
    siginfo_t seen{};
    ended = ::waitid(P_PID, static_cast<id_t>(child), &seen, WEXITED | WNOHANG | WNOWAIT) == 0 && seen.si_pid == child;
    output.drain(result.output, max_output);
    messages.drain(result.messages, 2 * kept_messages);
    keep_end(result.messages);
    if (ended) break;
    if (caught_signal != 0) {
      result.end = CommandResult::End::interrupted;
    } else if (result.output.size() > max_output) {
      result.end = CommandResult::End::printed_too_much;
    } else if (Clock::now() >= deadline) {
      result.end = CommandResult::End::timed_out;
    } else {
      continue;
    }
    break;
  }
  // The group, even after its leader ended: nothing it started stays behind.
  ::kill(-child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  running_group = 0;
  if (caught_signal != 0) {
    result.end = CommandResult::End::interrupted;
    result.code = caught_signal;
  } else if (ended && result.output.size() > max_output) {
    result.end = CommandResult::End::printed_too_much;
  } else if (ended && WIFSIGNALED(status)) {
    result.end = CommandResult::End::killed_by_signal;
    result.code = WTERMSIG(status);
  } else if (ended) {
    result.code = WEXITSTATUS(status);
  }
  return result;
}

}  // namespace abn
