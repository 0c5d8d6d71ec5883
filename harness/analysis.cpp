#include "harness/analysis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sampling/error.h"

namespace abn::harness {
namespace {

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json numbers(const std::vector<double>& values, std::size_t first = 0) {
  Json array = Json::array();
  for (std::size_t i = first; i < values.size(); ++i) array.push_back(number(values[i]));
  return array;
}

/// Four digits that matter.
std::string digits(double value) {
  if (std::isnan(value)) return "-";
  return std::abs(value) >= 1e4 || (value == std::floor(value) && std::abs(value) < 1e15)
             ? fmt::format("{:.0f}", value)
             : fmt::format("{:.4g}", value);
}

void add_to(std::vector<double>& sums, const std::vector<double>& values) {
  sums.resize(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) sums[i] += values[i];
}

}  // namespace

double Estimate::standard_error() const {
  return summary.standard_deviation / std::sqrt(static_cast<double>(summary.count));
}

Analysis::Analysis(AnalysisSource source) : source_(std::move(source)) {}

void Analysis::add(std::vector<analysis::Point> points, std::span<const Diagnostic> diagnostics) {
  if (sets_ > 0 && points.size() != first_.size())
    throw ConfigError(
        fmt::format("a set has {} points, the first one {}; analyse sets of equal size", points.size(), first_.size()));
  std::vector<std::string> names;
  if (source_.metrics) {
    names = *source_.metrics;
  } else {
    for (const PointMetric& metric : point_metrics()) names.push_back(metric.name);
  }
  MeasuredSet set{.points = points, .density = source_.density, .pixels = source_.pixels, .diagnostics = diagnostics};
  SetMeasures measures = measure(set, names, true);
  for (const auto& [name, value] : measures.values) values_[name].push_back(value);
  skipped_ = measures.skipped;
  if (measures.periodogram) radial_.add(*measures.periodogram);
  if (measures.axes) {
    add_to(axis_x_, measures.axes->x);
    add_to(axis_y_, measures.axes->y);
  }
  if (measures.pairs) pairs_.push_back(std::move(*measures.pairs));
  if (sets_++ == 0) first_ = std::move(points);
}

std::vector<Estimate> Analysis::estimates() const {
  std::vector<Estimate> estimates;
  for (const PointMetric& metric : point_metrics()) {
    Estimate estimate;
    estimate.metric = &metric;
    if (const auto reason = skipped_.find(metric.name); reason != skipped_.end()) estimate.skipped = reason->second;
    if (const auto values = values_.find(metric.name); values != values_.end()) {
      std::vector<double> defined;
      for (const double value : values->second)
        if (std::isfinite(value)) defined.push_back(value);
      estimate.summary = summarize(defined);
    }
    estimates.push_back(std::move(estimate));
  }
  return estimates;
}

std::optional<AveragedSpectrum> Analysis::averaged_spectrum() const {
  if (radial_.periodogram().sets() == 0) return std::nullopt;
  AveragedSpectrum spectrum;
  spectrum.radial = radial_.profile();
  spectrum.effective_nyquist = analysis::effective_nyquist(spectrum.radial);
  spectrum.oscillation = analysis::oscillation(spectrum.radial);
  spectrum.peak = analysis::spectral_peak(spectrum.radial);
  spectrum.anisotropy_db = analysis::mean_anisotropy_db(spectrum.radial);
  return spectrum;
}

std::optional<AveragedAxes> Analysis::averaged_axes() const {
  if (axis_x_.empty()) return std::nullopt;
  AveragedAxes axes;
  for (const auto* sums : {&axis_x_, &axis_y_}) {
    const auto largest = std::max_element(sums->begin(), sums->end());
    const double power = *largest / static_cast<double>(sets_);
    if (power <= axes.largest) continue;
    axes = {power, sums == &axis_x_ ? "x" : "y", static_cast<std::size_t>(largest - sums->begin())};
  }
  return axes;
}

std::optional<analysis::PairCorrelation> Analysis::pair_correlation() const {
  if (pairs_.empty()) return std::nullopt;
  return analysis::mean_of(pairs_);
}

Json to_json(const Analysis& analysis, bool curves) {
  Json json;
  json["set"] = {{"source", analysis.source().name}, {"count", analysis.count()}, {"sets", analysis.sets()}};
  json["set"].update(analysis.source().description);
  Json skipped = Json::object();
  for (const Estimate& estimate : analysis.estimates()) {
    json[estimate.metric->group][estimate.metric->key] = {{"mean", number(estimate.summary.mean)},
                                                          {"standard_error", number(estimate.standard_error())}};
    if (!estimate.skipped.empty()) skipped[estimate.metric->name] = estimate.skipped;
  }
  const auto spectrum = analysis.averaged_spectrum();
  const auto axes = analysis.averaged_axes();
  if (spectrum) {
    json["averaged_spectrum"] = {{"reach", spectrum->radial.reach()},
                                 {"effective_nyquist", number(spectrum->effective_nyquist)},
                                 {"oscillation", number(spectrum->oscillation)},
                                 {"low_power", number(spectrum->radial.low_power)},
                                 {"low_power_standard_error", number(spectrum->radial.low_power_error)},
                                 {"peak", number(spectrum->peak.power)},
                                 {"peak_frequency", number(spectrum->peak.frequency)},
                                 {"anisotropy_db", number(spectrum->anisotropy_db)},
                                 {"isotropic_db", number(spectrum->radial.isotropic_db)}};
  } else {
    json["averaged_spectrum"] = nullptr;
  }
  if (axes) {
    json["averaged_axes"] = {{"largest_axis_power", number(axes->largest)},
                             {"largest_axis_frequency", axes->frequency},
                             {"axis", axes->axis}};
  } else {
    json["averaged_axes"] = nullptr;
  }
  json["skipped"] = std::move(skipped);
  if (!curves) return json;
  if (spectrum) {
    json["radial"] = {{"frequency_unit", "cycles per side"},
                      {"mean", numbers(spectrum->radial.mean, 1)},
                      {"standard_error", numbers(spectrum->radial.standard_error, 1)},
                      {"anisotropy_db", numbers(spectrum->radial.anisotropy_db, 1)}};
  }
  if (const auto pairs = analysis.pair_correlation()) {
    json["pair_correlation"] = {
        {"distance_unit", "1/sqrt(N)"}, {"bin_width", pairs->bin_width}, {"g", numbers(pairs->g)}};
  }
  return json;
}

std::string to_text(const Analysis& analysis) {
  const bool several = analysis.sets() > 1;
  std::string text = fmt::format("{}: {} of {} points{}\n\n", analysis.source().name,
                                 several ? fmt::format("{} sets", analysis.sets()) : "1 set", analysis.count(),
                                 several ? "; mean and standard error of the mean over the sets" : "");
  std::string group;
  std::map<std::string, std::vector<std::string>> skipped;  // reason -> metrics
  for (const Estimate& estimate : analysis.estimates()) {
    if (!estimate.skipped.empty()) {
      skipped[estimate.skipped].push_back(estimate.metric->key);
      continue;
    }
    if (estimate.summary.count == 0) continue;  // undefined in every set
    if (estimate.metric->group != group) {
      group = estimate.metric->group;
      text += group + "\n";
    }
    const std::string error = several && std::isfinite(estimate.standard_error())
                                  ? "+- " + fmt::format("{:.2g}", estimate.standard_error())
                                  : "";
    text += fmt::format("  {:<23}{:>10} {:<11} {:<16} {}\n", estimate.metric->key, digits(estimate.summary.mean), error,
                        estimate.metric->unit, estimate.metric->good);
  }
  const auto spectrum = analysis.averaged_spectrum();
  if (several && spectrum) {
    const auto axes = analysis.averaged_axes();
    text += fmt::format("of the spectrum averaged over the {} sets\n", analysis.sets());
    const auto line = [&](const char* key, double value, const std::string& unit, const std::string& good) {
      text += fmt::format("  {:<23}{:>10} {:<11} {:<16} {}\n", key, digits(value), "", unit, good);
    };
    line("effective_nyquist", spectrum->effective_nyquist, "sqrt(N)/2", "good blue noise > .86");
    line("oscillation", spectrum->oscillation, "", "");
    line("peak", spectrum->peak.power, "white noise = 1", "");
    line("anisotropy_db", spectrum->anisotropy_db, "dB",
         fmt::format("{:.1f} without preferred directions", spectrum->radial.isotropic_db));
    if (axes)
      line("largest_axis_power", axes->largest, "white noise = 1",
           fmt::format("at frequency {} of {}", axes->frequency, axes->axis));
  }
  for (const auto& [reason, names] : skipped) {
    text += fmt::format("not measured ({}):", reason);
    for (const auto& name : names) text += " " + name;
    text += "\n";
  }
  return text;
}

}  // namespace abn::harness
