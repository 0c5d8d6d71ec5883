#include "harness/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>

namespace abn::harness {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

void request_stop(int signal_number) {
  if (stop_requested != 0) {  // asked twice: the user means now
    std::signal(signal_number, SIG_DFL);
    std::raise(signal_number);
  }
  stop_requested = 1;
}

std::string duration_text(double seconds) {
  const auto whole = static_cast<long>(std::max(0.0, seconds) + 0.5);
  return whole < 60 ? fmt::format("{} s", whole) : fmt::format("{} min {:02} s", whole / 60, whole % 60);
}

}  // namespace

void install_interrupt_handler() {
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
  std::signal(SIGPIPE, SIG_IGN);
}

bool interrupted() { return stop_requested != 0; }

Progress::Progress(std::string label, std::size_t total, bool quiet)
    : label_(std::move(label)),
      total_(std::max<std::size_t>(total, 1)),
      visible_(!quiet && isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()),
      last_draw_(start_) {}

Progress::~Progress() { clear(); }

void Progress::update(std::size_t done, const std::string& detail) {
  if (!visible_) return;
  using Seconds = std::chrono::duration<double>;
  const auto now = std::chrono::steady_clock::now();
  const double elapsed = Seconds(now - start_).count();
  if (elapsed < 1.0 || (drawn_ && Seconds(now - last_draw_).count() < 0.1 && done < total_)) return;
  last_draw_ = now;
  constexpr std::size_t kWidth = 30;
  const std::size_t filled = std::min(done, total_) * kWidth / total_;
  const double left =
      done > 0 ? elapsed / static_cast<double>(done) * static_cast<double>(total_ - std::min(done, total_)) : 0.0;
  const std::string line =
      fmt::format("{} [{}{}] {}/{}{}{}{}", label_, std::string(filled, '#'), std::string(kWidth - filled, '.'), done,
                  total_, done > 0 ? "  left " + duration_text(left) : "", detail.empty() ? "" : "  ", detail);
  std::fputs(("\r\x1b[K" + line).c_str(), stderr);
  std::fflush(stderr);
  drawn_ = true;
}

void Progress::clear() {
  if (!drawn_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace abn::harness
