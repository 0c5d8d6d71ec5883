#include "sampling/from_command.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "sampling/error.h"
#include "sampling/from_file.h"
#include "sampling/points_io.h"
#include "sampling/run_command.h"

namespace abn {
namespace {

// A point as text takes about 40 bytes; a command that prints three times that has not understood {n}.
constexpr std::size_t output_per_point = 128;
constexpr std::size_t output_at_least = std::size_t{1} << 20;

std::string substituted(const std::string& command, const SamplingTask& task) {
  const std::array<std::pair<std::string_view, std::string>, 4> words = {
      {{"{n}", std::to_string(task.budget)},
       {"{seed}", std::to_string(task.seed)},
       {"{width}", std::to_string(task.plane.width)},
       {"{height}", std::to_string(task.plane.height)}}};
  std::string text;
  for (std::size_t i = 0; i < command.size();) {
    bool replaced = false;
    for (const auto& [key, value] : words) {
      if (std::string_view(command).substr(i).starts_with(key)) {
        text += value;
        i += key.size();
        replaced = true;
        break;
      }
    }
    if (!replaced) text += command[i++];
  }
  return text;
}

/// The last line with anything on it; control characters replaced.
std::string last_line(std::string_view text) {
  const auto end = text.find_last_not_of(" \t\r\n");
  if (end == std::string_view::npos) return {};
  text = text.substr(0, end + 1);
  const auto start = text.rfind('\n');
  if (start != std::string_view::npos) text = text.substr(start + 1);
  std::string line;
  for (const char c : text.substr(0, 300)) line += static_cast<unsigned char>(c) < ' ' || c == '\x7f' ? '?' : c;
  return line;
}

std::string seconds(double value) { return detail::to_word(value) + " s"; }

}  // namespace

const StrategyInfo FromCommand::info = {
    .name = "command",
    .family = "outside",
    .summary = "the points a shell command prints for {n} {seed} {width} {height}, scaled to the plane: command:CMD",
    .cite = "whoever wrote the command",
    .advice = "to compare a sampler of your own without touching this program",
};

std::vector<Field<FromCommand::Params>> FromCommand::fields() {
  return {
      {"command", &Params::command, "shell command that prints {n} points of the unit square; command:CMD sets it"},
      {"timeout_s", &Params::timeout_s, "it is killed after this time [s]", 0.001, 1e7},
  };
}

FromCommand::FromCommand(const SamplingTask& task, const Params& params) : task_(task), timeout_s_(params.timeout_s) {
  if (params.command.find_first_not_of(" \t\n") == std::string::npos) {
    throw ConfigError("strategy command needs a command; write command:'CMD {n} {seed}'");
  }
  command_ = substituted(params.command, task);
  if (command_.find('\0') != std::string::npos) {
    throw ConfigError("command '" + command_ + "' contains a zero byte; remove it");
  }
}

void FromCommand::run() {
  const std::string name = "command '" + command_ + "'";
  const std::size_t max_output = output_at_least + output_per_point * std::min(task_.budget, std::uint64_t{1} << 40);
  const CommandResult result = run_command(command_, timeout_s_, max_output);
  const std::string said = last_line(result.messages);
  const std::string message = said.empty() ? std::string("; it said nothing on standard error")
                                           : "; the last line of its standard error: " + said;
  using End = CommandResult::End;
  if (result.end == End::interrupted) throw IoError(name + " was stopped by signal " + std::to_string(result.code));
  if (result.end == End::timed_out) {
    throw IoError(name + " took longer than " + seconds(timeout_s_) +
                  " and was killed; raise timeout_s, or make it faster" + message);
  }
  if (result.end == End::printed_too_much) {
    throw ConfigError(name + " printed more than " + std::to_string(max_output) + " bytes for " +
                      std::to_string(task_.budget) + " points; make it print exactly {n}");
  }
  if (result.end == End::killed_by_signal) {
    throw IoError(name + " was killed by signal " + std::to_string(result.code) + " (" + ::strsignal(result.code) +
                  ")" + message);
  }
  if (result.code != 0) {
    throw IoError(name + " ended with exit status " + std::to_string(result.code) +
                  (result.code == 127 ? " (not found: check its name and PATH)" : "") + message);
  }

  FilePoints points = parse_points(result.output, "the output of " + name);
  if (points.position.size() != task_.budget) {
    throw ConfigError(name + " printed " + std::to_string(points.position.size()) + " points, but " +
                      std::to_string(task_.budget) + " samples are asked for; make it print exactly {n}, or give " +
                      "--samples " + std::to_string(points.position.size()));
  }
  notice_ = std::exchange(points.notice, {});
  points_ = scale_to_plane(std::move(points), task_.plane, name);
}

SampleBatch FromCommand::next(const Feedback&) {
  if (!ran_) run();
  ran_ = true;
  return next_chunk(points_, emitted_);
}

std::vector<Diagnostic> FromCommand::diagnostics() const {
  if (notice_.empty()) return {};
  return {{"more_realisations", 1, notice_, true}};
}

}  // namespace abn
