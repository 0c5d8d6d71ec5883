// What long work tells a person, and how a person stops it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>
#include <thread>

namespace abn::harness {

/// Installs handlers for SIGINT and SIGTERM that only set a flag: work stops at the next safe place and loses nothing.
/// A second signal ends the program at once. On a terminal the first one is answered with a line that says so.
void install_interrupt_handler();
/// True once the user asked to stop.
bool interrupted();
/// Throws Interrupted once the user asked to stop.
void stop_if_interrupted();

/// Thrown where work was cut off by the user; the program exits with 130 (128 + SIGINT) after keeping what is finished.
struct Interrupted {};

/// A bar with the estimated time left, on stderr, only on a terminal and only for work that lasts over a second.
/// A thread of its own keeps it alive while one step takes long. Where nothing is to be shown no thread is started.
class Progress {
 public:
  /// `total` steps of work called `label`; 0 = steps that cannot be counted: then the time that went by is shown.
  /// Silent if `quiet` or stderr is no terminal.
  Progress(std::string label, std::size_t total, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// `done` of the steps are finished; `detail` says what is under way.
  void update(std::size_t done, const std::string& detail = {});
  /// Removes the bar, so that other lines can be printed; the next update draws it again.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  void keep_alive();
  void draw();   // with mutex_ held
  void erase();  // with mutex_ held

  std::string label_;
  std::size_t total_;
  bool visible_;
  Clock::time_point start_ = Clock::now();

  std::mutex mutex_;  // guards all below
  std::condition_variable wake_;
  bool active_ = false;  // there is something to show
  bool drawn_ = false;
  bool ended_ = false;
  std::size_t done_ = 0;
  std::string detail_;
  Clock::time_point last_update_;
  Clock::time_point last_draw_;
  std::thread thread_;
};

}  // namespace abn::harness
