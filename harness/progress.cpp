#include "harness/progress.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <string_view>

namespace abn::harness {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr Seconds kSilence{1.0};       // work shorter than this shows no bar
constexpr Seconds kLeastPeriod{0.1};   // between two drawings
constexpr Seconds kLongestPeriod{.5};  // the time shown must move while a step takes long

volatile std::sig_atomic_t stop_requested = 0;
volatile std::sig_atomic_t on_terminal = 0;

void request_stop(int signal_number) {
  if (stop_requested != 0) {  // asked twice: the user means now
    std::signal(signal_number, SIG_DFL);
    std::raise(signal_number);
  }
  stop_requested = 1;
  if (on_terminal != 0) {
    constexpr std::string_view text = "\nabn: stopping at the next safe place; once more stops at once\n";
    // Of what a handler may call, this is all there is to say it with; nothing can be done if it fails.
    if (::write(STDERR_FILENO, text.data(), text.size()) < 0) return;
  }
}

std::string duration_text(Seconds duration) {
  const auto whole = std::lround(std::max(0.0, duration.count()));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

/// Columns of the terminal [characters].
std::size_t terminal_width() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80U;
}

/// The first `columns` characters of UTF-8 text.
std::string cut(const std::string& text, std::size_t columns) {
  std::size_t end = 0;
  for (std::size_t column = 0; end < text.size(); ++end) {
    const bool starts_character = (static_cast<unsigned char>(text[end]) & 0xC0U) != 0x80U;
    if (starts_character && column++ == columns) break;
  }
  return text.substr(0, end);
}

/// Signals are for the thread that works: this one, made with all of them blocked, gets none.
template <class Function>
std::thread start_without_signals(Function function) {
  sigset_t all;
  sigset_t before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread thread(std::move(function));
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return thread;
}

}  // namespace

void install_interrupt_handler() {
  on_terminal = ::isatty(STDERR_FILENO);
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
}

bool interrupted() { return stop_requested != 0; }

void stop_if_interrupted() {
  if (interrupted()) throw Interrupted{};
}

Progress::Progress(std::string label, std::size_t total, bool quiet)
    : label_(std::move(label)), total_(total), visible_(!quiet && ::isatty(STDERR_FILENO) != 0) {
  if (visible_) thread_ = start_without_signals([this] { keep_alive(); });
}

Progress::~Progress() {
  if (!visible_) return;
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  wake_.notify_one();
  thread_.join();
  erase();
}

void Progress::update(std::size_t done, const std::string& detail) {
  if (!visible_) return;
  const std::lock_guard lock(mutex_);
  active_ = true;
  done_ = total_ > 0 ? std::min(done, total_) : done;
  detail_ = detail;
  last_update_ = Clock::now();
  if (last_update_ - start_ > kSilence && last_update_ - last_draw_ > kLeastPeriod) draw();
}

void Progress::clear() {
  if (!visible_) return;
  const std::lock_guard lock(mutex_);
  active_ = false;
  erase();
}

void Progress::keep_alive() {
  std::unique_lock lock(mutex_);
  while (!ended_) {
    wake_.wait_for(lock, kLongestPeriod);
    if (!ended_ && active_ && !interrupted() && Clock::now() - start_ > kSilence) draw();
  }
}

void Progress::draw() {
  last_draw_ = Clock::now();
  const std::size_t columns = terminal_width();
  std::string line = label_;
  if (total_ == 0) {
    line += "  " + duration_text(last_draw_ - start_);
  } else {
    const std::size_t width = std::min<std::size_t>(30, columns / 4);
    const auto filled =
        static_cast<std::size_t>(static_cast<double>(done_) / static_cast<double>(total_) * static_cast<double>(width));
    line += fmt::format(" [{}{}] {}/{}", std::string(filled, '#'), std::string(width - filled, '.'), done_, total_);
    if (done_ > 0) {
      const Seconds per_step = Seconds(last_update_ - start_) / static_cast<double>(done_);
      const Seconds left = per_step * static_cast<double>(total_ - done_) - Seconds(last_draw_ - last_update_);
      line += "  left " + duration_text(left);
    } else {
      line += "  " + duration_text(last_draw_ - start_);
    }
  }
  if (!detail_.empty()) line += "  " + detail_;
  // A line that wraps could not be taken back.
  std::fputs(("\r\x1b[K" + cut(line, columns - 1)).c_str(), stderr);
  std::fflush(stderr);
  drawn_ = true;
}

void Progress::erase() {
  if (!drawn_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace abn::harness
