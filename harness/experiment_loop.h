// What every kind of experiment has in common: its folder, and the loop over runs whose rows are kept.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "harness/experiment.h"
#include "harness/progress.h"
#include "harness/record.h"
#include "harness/rows.h"

namespace abn::harness {

/// Holds a folder for one process, until that ends: two that append to the same rows would lose some.
class FolderLock {
 public:
  /// Throws IoError if another process has it.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

/// Makes or checks the folder of results and takes it for this process; with `overwrite` the pictures and tables of
/// earlier results are removed. Throws ConfigError (an existing folder without resume or overwrite), IoError.
class ExperimentFolder {
 public:
  explicit ExperimentFolder(const ExperimentOptions& options);

 private:
  std::unique_ptr<FolderLock> lock_;
};

/// A name for files: letters, digits, dots and dashes of `text`, '_' for the rest.
std::string file_name(const std::string& text);

/// One run of an experiment.
struct Job {
  std::string key;             // what --resume knows it by
  std::string detail;          // what the progress bar says of it
  std::function<Json()> work;  // does it and returns the row, without "experiment", "key" and "build"
};

struct LoopOutcome {
  std::size_t skipped = 0;  // jobs of this shard whose rows were there already
  bool stopped = false;     // the user pressed Ctrl-C: finished rows are kept
};

/// Does the jobs of this process's shard whose rows `file` lacks, in order, and appends a row for each.
LoopOutcome run_jobs(const std::string& experiment, const std::vector<Job>& jobs, const ExperimentOptions& options,
                     RowFile& file, Progress& progress);

/// tell_fallback() for the strategies of an experiment.
void tell_fallbacks(const std::string& backend, const std::vector<StrategyChoice>& strategies,
                    const std::string& reconstruction = "");

/// How many of the jobs are to be done.
std::size_t count_jobs(const std::vector<Job>& jobs, const ExperimentOptions& options, const RowFile& file);

}  // namespace abn::harness
