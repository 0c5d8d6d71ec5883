// Running a shell command and keeping what it prints.
#pragma once

#include <cstddef>
#include <string>

namespace abn {

/// How a command ended.
struct CommandResult {
  enum class End { exited, killed_by_signal, timed_out, printed_too_much, interrupted };
  End end = End::exited;
  int code = 0;          // exit status, or the number of the signal
  std::string output;    // its standard output
  std::string messages;  // the end of its standard error, at most 64 KiB
};

/// Runs `command` by /bin/sh -c, without input, in a process group of its own, until it ends, `timeout_s` [s] are over,
/// or its output exceeds `max_output` [bytes]. Whatever is then left of the group is killed. While it runs, SIGINT,
/// SIGTERM and SIGHUP to this process kill the group first and then do what they would have done. Throws IoError if it
/// cannot be started. Not for two threads at once: the second waits.
CommandResult run_command(const std::string& command, double timeout_s, std::size_t max_output);

}  // namespace abn
