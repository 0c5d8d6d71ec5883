// The table of measures of a point set: one row per number. `abn analyze`, point-set experiments and their tests read
// it. The measures themselves are those of sampling/analysis.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sampling/analysis/axis_power.h"
#include "sampling/analysis/pair_correlation.h"
#include "sampling/analysis/periodogram.h"
#include "sampling/analysis/points.h"
#include "sampling/sampler.h"

namespace abn::harness {

/// One point set and what is known of it.
struct MeasuredSet {
  analysis::Points points;                               // on the unit torus; the caller keeps them
  std::shared_ptr<const Grid<float>> density = nullptr;  // wanted of the set, over the unit square; null = uniform
  Extent pixels = {200, 200};                            // for the variation of counts
  std::span<const Diagnostic> diagnostics = {};          // what its strategy said; empty for a file
};

struct PointMetric {
  std::string name;   // unique, as experiments name it: lower_snake
  std::string group;  // spectrum | spacing | order | discrepancy | counts | integration | density | run
  std::string key;    // within the group, in JSON
  std::string unit;   // empty = a plain ratio
  std::string good;   // what a value means, one phrase
};

/// The table.
const std::vector<PointMetric>& point_metrics();
/// Throws ConfigError that lists the names.
const PointMetric& find_point_metric(std::string_view name);

/// Sets above these sizes are not measured so: the time grows with the square of N.
constexpr std::size_t largest_for_spectrum = 65536, largest_for_discrepancy = 16384;
/// Frequencies on each side that the spectrum of a set of `count` points covers: 6 sqrt(N), fewer for large sets.
int spectrum_reach(std::size_t count);

/// The numbers of one set, and what pictures need of it.
struct SetMeasures {
  std::map<std::string, double> values;        // by metric; NaN = undefined
  std::map<std::string, std::string> skipped;  // metrics that were not computed, and why
  std::optional<analysis::Periodogram> periodogram;
  std::optional<analysis::AxisPower> axes;
  std::optional<analysis::PairCorrelation> pairs;
};

/// Measures a set by the metrics named (all distinct). Only what they need is computed. `keep` also fills the three
/// pictures' parts that can be had. Throws ConfigError for an unknown name or an empty set, Interrupted between stages.
SetMeasures measure(const MeasuredSet& set, std::span<const std::string> metrics, bool keep = false);

}  // namespace abn::harness
