// Everything that is measured of one or several point sets, as numbers, JSON and pictures.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "harness/point_metrics.h"
#include "harness/record.h"
#include "harness/statistics.h"
#include "sampling/analysis/radial_profile.h"

namespace abn::harness {

/// Where the sets come from, for titles and JSON.
struct AnalysisSource {
  std::string name;                   // of the strategy or file
  Json description = Json::object();  // whatever tells them apart: parameters, seed, …
  std::shared_ptr<const Grid<float>> density = nullptr;
  Extent pixels = {200, 200};
  std::optional<std::vector<std::string>> metrics = std::nullopt;  // names; not given = all
};

/// A measure over the sets.
struct Estimate {
  const PointMetric* metric = nullptr;
  Summary summary;                // over the sets where it is defined
  std::string skipped;            // why it was not computed; empty = it was
  double standard_error() const;  // of the mean; NaN for one set
};

/// Numbers of the spectrum averaged over the sets: what the literature reports. Noise that differs between sets has
/// cancelled in it, what they have in common stands out.
struct AveragedSpectrum {
  analysis::RadialProfile radial;
  double effective_nyquist = 0, oscillation = 0;
  analysis::Peak peak;
  double anisotropy_db = 0;
};

/// Tallest peak on the frequency axes, averaged over the sets.
struct AveragedAxes {
  double largest = 0;
  std::string axis;  // x | y
  std::size_t frequency = 0;
};

/// Measures sets one by one; keeps sums, and the points of the first one.
class Analysis {
 public:
  explicit Analysis(AnalysisSource source);

  /// Measures one more set; all have equally many points. Throws ConfigError, Interrupted.
  void add(std::vector<analysis::Point> points, std::span<const Diagnostic> diagnostics = {});

  const AnalysisSource& source() const { return source_; }
  std::size_t count() const { return first_.size(); }  // points per set
  std::size_t sets() const { return sets_; }
  const std::vector<analysis::Point>& first_set() const { return first_; }

  /// Every metric, in the order of the table.
  std::vector<Estimate> estimates() const;
  /// Empty where the spectrum is not defined or too expensive.
  std::optional<AveragedSpectrum> averaged_spectrum() const;
  std::optional<AveragedAxes> averaged_axes() const;
  std::optional<analysis::PairCorrelation> pair_correlation() const;
  const analysis::PeriodogramMean& periodogram() const { return radial_.periodogram(); }

 private:
  AnalysisSource source_;
  std::size_t sets_ = 0;
  std::vector<analysis::Point> first_;
  std::map<std::string, std::vector<double>> values_;
  std::map<std::string, std::string> skipped_;
  analysis::RadialAverage radial_;
  std::vector<double> axis_x_, axis_y_;  // sums
  std::vector<analysis::PairCorrelation> pairs_;
};

/// {"set":{…},"spectrum":{"effective_nyquist":{"mean","standard_error"},…},…,"averaged_spectrum":{…},"skipped":{…}};
/// with `curves` also "radial" and "pair_correlation" as arrays. Undefined numbers are null.
Json to_json(const Analysis& analysis, bool curves);

/// The same for a person: one line per number, with its unit and what good values look like.
std::string to_text(const Analysis& analysis);

}  // namespace abn::harness
