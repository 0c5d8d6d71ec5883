// An experiment on point sets, without an integrand (TOML, kind = "points"), validated as a whole before anything runs.
//
//   kind = "points"
//   name = "fig_3_4"   title = "…"   thesis = "fig. 3.4"
//   counts = [1024]                      # points in a set
//   seeds = 10         first_seed = 1    # sets
//   density = ["scene:stipple"]          # image, scene:NAME or size:NAME[:RATIO]; one or a list; default: uniform
//   density_floor = 0.01                 # lower densities are raised to this share of the highest
//   pixels = "200x200"                   # grid for the variation of counts
//   metrics = ["relative_radius"]        # names of harness/point_metrics.h; default: all
//   images = true                        # keep the points and draw them, their spectra and maps of sweeps
//   [[strategy]]
//   name = "sph_blue_noise"   label = "…"   set = { key = "value" }
//   [sweep]                              # every combination of these values, for the strategies named
//   sph_blue_noise.delta = [0.1, 0.3]
//   sph_blue_noise.step = [0.6, 1.2]
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "harness/point_source.h"
#include "harness/spec.h"

namespace abn::harness {

/// Everything that decides the points and numbers of one set.
struct PointRunSpec {
  std::string label;
  std::string density;  // a word of load_density; empty = uniform
  double density_floor = 0;
  Extent pixels = {200, 200};
  PointTask task;  // without the density itself
};

/// The canonical form of a spec (every parameter spelled out) and its hash: the key of `--resume`.
std::string canonical(const PointRunSpec& spec);
std::string run_key(const PointRunSpec& spec);

/// One parameter that takes several values.
struct SweepAxis {
  std::string strategy;  // name or label
  std::string key;
  std::vector<std::string> values;
};

struct PointExperimentSpec {
  std::string name, title, thesis;
  std::vector<std::uint64_t> counts;
  std::uint64_t seeds = 1, first_seed = 1;
  std::vector<std::string> densities = {""};
  double density_floor = 0;
  Extent pixels = {200, 200};
  std::string backend = "auto";
  std::vector<std::string> metrics;
  bool images = false;
  std::vector<StrategyChoice> strategies;
  std::vector<SweepAxis> sweep;

  /// The strategies with every combination of the sweep in place of those it names, labelled "LABEL key=value …".
  std::vector<StrategyChoice> choices() const;
  /// Seeds of a choice: 1 where another seed gives the same points.
  std::uint64_t seeds_of(const StrategyChoice& choice) const;
  /// All runs in fixed order: density, count, choice, seed.
  std::vector<PointRunSpec> expand() const;
};

/// What `kind` says of an experiment file: images (also if it says nothing) or points. Throws ConfigError, IoError.
std::string experiment_kind(const std::filesystem::path& file);

/// Reads and validates everything. Throws ConfigError (file, line, key, remedy) or IoError.
PointExperimentSpec load_point_experiment(const std::filesystem::path& file);

/// Validates every run of an experiment. Throws ConfigError.
void validate(const PointExperimentSpec& spec);

}  // namespace abn::harness
