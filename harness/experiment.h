// Runs an experiment: rows appended as they finish, pictures of the first seed, a table at the end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "harness/record.h"
#include "harness/spec.h"

namespace abn::harness {

struct ExperimentOptions {
  std::filesystem::path out;  // folder of the results
  bool resume = false;        // skip runs whose rows are there
  bool overwrite = false;     // replace the results of an earlier experiment in `out`
  std::uint64_t shard = 0;    // this process does the runs with index % shards == shard
  std::uint64_t shards = 1;
  bool quiet = false;
  bool json = false;  // every finished row goes to stdout too
  bool cache = true;  // stages that depend on no image may come from the disk cache
};

/// What is left of an experiment when it ends or is stopped.
struct ExperimentOutcome {
  std::size_t rows = 0;            // rows in runs.jsonl now
  std::size_t skipped = 0;         // of them found there by --resume
  bool stopped = false;            // the user pressed Ctrl-C: finished rows are kept
  std::string table;               // the summary, Markdown
  std::filesystem::path overview;  // picture of all first-seed results; empty if none was asked for
};

/// Leaves runs.jsonl, runs.csv, table.md and, with images, images/ in `out`. Throws ConfigError (an existing folder
/// without resume or overwrite; a run whose words are wrong), IoError.
ExperimentOutcome run_experiment(const ExperimentSpec& spec, const ExperimentOptions& options);

}  // namespace abn::harness
