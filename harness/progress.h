// What long work tells a person, and how a person stops it.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <string>

namespace abn::harness {

/// Installs handlers for SIGINT and SIGTERM that only set a flag: work stops at the next safe place and loses nothing.
void install_interrupt_handler();
/// True once the user asked to stop.
bool interrupted();

/// Thrown where work was cut off by the user; the program exits with 130 (128 + SIGINT) after keeping what is finished.
struct Interrupted {};

/// A bar with the estimated time left, on stderr, only on a terminal and only for work that lasts over a second.
class Progress {
 public:
  /// `total` steps of work called `label`; silent if `quiet` or stderr is no terminal.
  Progress(std::string label, std::size_t total, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// `done` of the steps are finished; `detail` says what is under way.
  void update(std::size_t done, const std::string& detail = {});
  /// Removes the bar, so that other lines can be printed; the next update draws it again.
  void clear();

 private:
  std::string label_;
  std::size_t total_;
  bool visible_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_draw_;
};

}  // namespace abn::harness
