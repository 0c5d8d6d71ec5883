#include "harness/experiment_loop.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

#include "harness/backend.h"
#include "harness/spec.h"
#include "sampling/error.h"
#include "sampling/strategy.h"

namespace abn::harness {

namespace fs = std::filesystem;

FolderLock::FolderLock(const fs::path& folder)
    : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  // A file system without locks is trusted to have one user.
  if (descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(descriptor_);
    throw IoError(fmt::format("{}: another `abn run` writes its results there; wait for its end, or give another --out",
                              folder.string()));
  }
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

ExperimentFolder::ExperimentFolder(const ExperimentOptions& options) {
  std::error_code error;
  const bool there = fs::exists(options.out, error);
  if (there && !fs::is_directory(options.out, error)) {
    throw IoError(
        fmt::format("{}: this is no folder; give the folder of the results with --out", options.out.string()));
  }
  if (there && !options.resume && !options.overwrite) {
    throw ConfigError(fmt::format(
        "{}: the folder exists; go on with --resume, replace its results with --overwrite, or give another --out",
        options.out.string()));
  }
  if (there && options.overwrite && !fs::is_empty(options.out) && !fs::exists(options.out / "runs.jsonl")) {
    throw ConfigError(
        fmt::format("{}: --overwrite replaces the results of an experiment, and this folder holds none (no "
                    "runs.jsonl); give another --out",
                    options.out.string()));
  }
  fs::create_directories(options.out, error);
  if (error)
    throw IoError(fmt::format("{}: cannot be made: {}; give a writable folder with --out", options.out.string(),
                              error.message()));
  lock_ = std::make_unique<FolderLock>(options.out);
  if (there && options.overwrite) {
    fs::remove_all(options.out / "images", error);
    fs::remove_all(options.out / "points", error);
    fs::remove(options.out / "table.md", error);
    for (const auto& entry : fs::directory_iterator(options.out)) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with("overview") || name.starts_with("crops_") || name.starts_with("map"))
        fs::remove(entry.path(), error);
    }
  }
}

std::string file_name(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const bool plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-';
    name += plain ? c : '_';
  }
  return name;
}

namespace {

bool is_mine(std::size_t index, const ExperimentOptions& options) { return index % options.shards == options.shard; }

}  // namespace

std::size_t count_jobs(const std::vector<Job>& jobs, const ExperimentOptions& options, const RowFile& file) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < jobs.size(); ++i) count += is_mine(i, options) && !file.has(jobs[i].key) ? 1 : 0;
  return count;
}

void tell_fallbacks(const std::string& backend, const std::vector<StrategyChoice>& strategies,
                    const std::string& reconstruction) {
  for (const StrategyChoice& choice : strategies) {
    ParameterWords words = choice.parameters;
    tell_fallback(backend, find_strategy(choice.name, words).info,
                  choice.reconstruction.empty() ? reconstruction : choice.reconstruction);
  }
}

LoopOutcome run_jobs(const std::string& experiment, const std::vector<Job>& jobs, const ExperimentOptions& options,
                     RowFile& file, Progress& progress) {
  LoopOutcome outcome;
  std::size_t done = 0;
  try {
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      const Job& job = jobs[i];
      if (!is_mine(i, options)) continue;
      if (file.has(job.key)) {
        ++outcome.skipped;
        continue;
      }
      stop_if_interrupted();
      progress.update(done, job.detail);
      Json row = {{"experiment", experiment}, {"key", job.key}};
      row.update(job.work());
      row["build"] = reproducibility_record();
      file.append(row);
      ++done;
      if (options.json) {
        fmt::print("{}\n", row.dump());
        std::fflush(stdout);  // whoever reads the pipe wants finished rows, not blocks
      }
    }
  } catch (const Interrupted&) {
    outcome.stopped = true;
  }
  progress.clear();
  return outcome;
}

}  // namespace abn::harness
