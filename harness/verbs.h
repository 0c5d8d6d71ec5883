// The verbs of the program: one options struct and one function each. main.cpp fills the structs; nothing here knows
// the command line.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace abn::harness {

struct GlobalOptions {
  std::string backend = "auto";
  int threads = 0;  // 0 = all
  bool quiet = false;
  bool json = false;
  bool no_cache = false;
};

struct DownscaleOptions {
  std::string image, to = "200x200", strategy, spp, filter = "box", reconstruction = "auto", truth = "exact",
                     integrand = "nearest", channels, on_nonfinite = "refuse", guide;
  std::uint64_t samples = 0;  // 0 = not given
  std::uint64_t seed = 1;
  std::vector<std::string> set;
  double target_error = 0;  // 0 = not given
  double gain = 10;
  // Files to write; empty = none.
  std::string output, error_map, estimated_error, reliability, points, points_picture, points_region;
};

struct RunOptions {
  std::string spec, out, shard;
  bool resume = false, overwrite = false, dry_run = false;
  std::uint64_t seeds = 0;  // 0 = as the spec says
  std::vector<std::string> set;
};

struct PointsOptions {
  std::string strategy, density, channels, on_nonfinite = "refuse", format, output, picture;
  std::uint64_t count = 0, seed = 1;
  double density_floor = 0;
  std::vector<std::string> set;
};

struct AnalyzeOptions {
  std::string file, strategy, density, channels, on_nonfinite = "refuse", pixels = "200x200", output;
  std::uint64_t count = 0, sets = 0, seed = 1;  // 0 = not given
  double density_floor = 0;
  std::vector<std::string> set;
};

struct CompareOptions {
  std::string test, reference, error_map, channels, on_nonfinite = "refuse";
  std::vector<std::string> metrics;
  double gain = 10;
  std::optional<double> fail;
};

struct TruthOptions {
  std::string image, to = "200x200", filter = "box", method = "exact", integrand = "nearest", channels,
                     on_nonfinite = "refuse", output;
};

struct SceneOptions {
  std::string name, output;
  std::uint32_t size = 3000;
};

struct ListOptions {
  std::string kind, name;
};

// Each returns the exit code of the program, prints results to stdout and all else to stderr, and throws ConfigError,
// IoError, DeviceError or Interrupted.
int downscale(const GlobalOptions& global, const DownscaleOptions& options);
int run_verb(const GlobalOptions& global, const RunOptions& options);
int points(const GlobalOptions& global, const PointsOptions& options);
int analyze(const GlobalOptions& global, const AnalyzeOptions& options);
int compare(const GlobalOptions& global, const CompareOptions& options);
int truth(const GlobalOptions& global, const TruthOptions& options);
int scene(const GlobalOptions& global, const SceneOptions& options);
int list(const GlobalOptions& global, const ListOptions& options);
int info(const GlobalOptions& global);

/// "abn VERSION (REVISION)".
std::string version_text();

/// "KEY=VALUE" words as parameters. Throws ConfigError.
std::map<std::string, std::string> parse_assignments(const std::vector<std::string>& words);

/// The budget from --spp or --samples on a plane of `area` pixels, `default_spp` per pixel if neither was given; throws
/// ConfigError unless the product is whole.
std::uint64_t parse_budget(const std::string& spp, std::uint64_t samples, std::uint64_t area, double default_spp = 6);

}  // namespace abn::harness
