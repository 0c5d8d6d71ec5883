// abn run: a whole experiment.
#include <fmt/format.h>

#include <charconv>

#include "harness/experiment.h"
#include "harness/point_experiment.h"
#include "harness/verbs.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

void parse_shard(const std::string& word, ExperimentOptions& options) {
  if (word.empty()) return;
  const char* end = word.data() + word.size();
  const auto [middle, first_error] = std::from_chars(word.data(), end, options.shard);
  if (first_error == std::errc{} && middle != end && *middle == '/') {
    const auto [rest, second_error] = std::from_chars(middle + 1, end, options.shards);
    if (second_error == std::errc{} && rest == end && options.shard < options.shards) return;
  }
  throw ConfigError(fmt::format("--shard is '{}'; give I/N with 0 <= I < N, e.g. 0/4", word));
}

/// What both kinds of experiments share, from the words to the last line.
template <class Spec>
int run_spec(const GlobalOptions& global, const RunOptions& options, Spec spec) {
  if (options.seeds > 0) spec.seeds = options.seeds;
  if (global.backend != "auto") spec.backend = global.backend;
  for (const auto& assignment : options.set) apply_override(spec.strategies, assignment);
  validate(spec);

  ExperimentOptions experiment;
  experiment.out =
      options.out.empty() ? std::filesystem::path("results/runs") / spec.name : std::filesystem::path(options.out);
  experiment.resume = options.resume;
  experiment.overwrite = options.overwrite;
  experiment.quiet = global.quiet;
  experiment.json = global.json;
  experiment.cache = !global.no_cache;
  parse_shard(options.shard, experiment);

  if (options.dry_run) {
    std::uint64_t index = 0;
    for (const auto& run : spec.expand()) {
      if (index++ % experiment.shards == experiment.shard) fmt::print("{}\n", canonical(run));
    }
    return 0;
  }

  const ExperimentOutcome outcome = run_experiment(spec, experiment);
  if (!global.json) {
    fmt::print("{}{}\n\n{}", spec.title, spec.thesis.empty() ? "" : " (thesis " + spec.thesis + ")", outcome.table);
    fmt::print("results   {}\n", (experiment.out / "runs.csv").string());
    fmt::print("          {}\n", (experiment.out / "runs.jsonl").string());
    if (spec.images) fmt::print("pictures  {}\n", (experiment.out / "images").string());
    if (!outcome.overview.empty()) fmt::print("overview  {}\n", outcome.overview.string());
  }
  if (outcome.stopped) {
    fmt::print(stderr, "abn: stopped; {} rows are kept in {}; go on with --resume\n", outcome.rows,
               experiment.out.string());
    return 130;
  }
  if (outcome.skipped > 0 && !global.quiet) fmt::print(stderr, "abn: {} runs were there already\n", outcome.skipped);
  return 0;
}

}  // namespace

int run_verb(const GlobalOptions& global, const RunOptions& options) {
  const std::filesystem::path file = find_experiment(options.spec);
  if (experiment_kind(file) == "points") return run_spec(global, options, load_point_experiment(file));
  return run_spec(global, options, load_experiment(file));
}

}  // namespace abn::harness
