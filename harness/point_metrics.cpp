#include "harness/point_metrics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "harness/progress.h"
#include "sampling/analysis/count_variation.h"
#include "sampling/analysis/discrepancy.h"
#include "sampling/analysis/integration_error.h"
#include "sampling/analysis/order.h"
#include "sampling/analysis/radial_profile.h"
#include "sampling/analysis/spacing.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

/// A measure that several rows share, computed once and only when asked for.
template <class T>
class Lazy {
 public:
  template <class Make>
  const T& get(Make make) {
    if (!value_) {
      stop_if_interrupted();
      value_.emplace(make());
    }
    return *value_;
  }
  bool ready() const { return value_.has_value(); }
  std::optional<T> take() { return std::move(value_); }

 private:
  std::optional<T> value_;
};

/// How well the counts of a set follow its density.
struct DensityMatch {
  double correlation = 0;
  double band_least = 0, band_most = 0;
};

std::uint32_t cell_of(double unit, std::uint32_t cells) {
  return std::min(static_cast<std::uint32_t>(unit * cells), cells - 1);
}

/// Cells from the lowest density to the highest, to within 2^-8 of a value: a counting sort by the leading bits,
/// because sorting the nine million cells of an image takes longer than drawing the points.
std::vector<std::uint32_t> by_density(const Grid<float>& density) {
  // Floats >= 0 are ordered as their bits are.
  const auto key = [](float value) { return std::bit_cast<std::uint32_t>(value) >> 15; };
  std::vector<std::uint32_t> begin((std::size_t{1} << 16) + 1);
  for (const float value : density.cells()) ++begin[key(value) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> order(density.cells().size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[begin[key(density[i])]++] = i;
  return order;
}

DensityMatch match_density(analysis::Points points, const Grid<float>& density) {
  const Extent size = density.size();
  std::vector<std::uint32_t> counts(density.cells().size());
  for (const auto& p : points) ++counts[density.index(cell_of(p.x, size.width), cell_of(p.y, size.height))];
  const double total = std::accumulate(density.cells().begin(), density.cells().end(), 0.0);
  DensityMatch match;

  // Correlation of counts and mass on 32 x 32 squares; a cell belongs to the square of its centre, with its points.
  constexpr std::uint32_t side = 32;
  std::vector<double> mass(side * side);
  std::vector<double> found(side * side);
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = 0; x < size.width; ++x) {
      const std::size_t square =
          std::size_t{cell_of((y + 0.5) / size.height, side)} * side + cell_of((x + 0.5) / size.width, side);
      mass[square] += static_cast<double>(density.at(x, y));
      found[square] += counts[density.index(x, y)];
    }
  }
  const double mass_mean = std::accumulate(mass.begin(), mass.end(), 0.0) / (side * side);
  const double found_mean = std::accumulate(found.begin(), found.end(), 0.0) / (side * side);
  double both = 0, mass_squares = 0, found_squares = 0;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    both += (mass[i] - mass_mean) * (found[i] - found_mean);
    mass_squares += (mass[i] - mass_mean) * (mass[i] - mass_mean);
    found_squares += (found[i] - found_mean) * (found[i] - found_mean);
  }
  match.correlation = both / std::sqrt(mass_squares * found_squares);  // NaN for a constant density

  // Ten bands of density, each of which should hold a tenth of the points.
  const std::vector<std::uint32_t> order = by_density(density);
  match.band_least = INFINITY;
  match.band_most = 0;
  double walked = 0, band_mass = 0, band_count = 0;
  int band = 1;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto cell_mass = static_cast<double>(density[order[i]]);
    walked += cell_mass;
    band_mass += cell_mass;
    band_count += counts[order[i]];
    if (walked < band * 0.1 * total * (1 - 1e-12) && i + 1 < order.size()) continue;
    while (walked >= band * 0.1 * total * (1 - 1e-12)) ++band;
    const double ratio = band_count / static_cast<double>(points.size()) / (band_mass / total);
    if (band_mass > 0) {
      match.band_least = std::min(match.band_least, ratio);
      match.band_most = std::max(match.band_most, ratio);
    }
    band_mass = band_count = 0;
  }
  return match;
}

double empty_cells(analysis::Points points, std::uint32_t side) {
  std::vector<bool> hit(std::size_t{side} * side);
  for (const auto& p : points) hit[std::size_t{cell_of(p.y, side)} * side + cell_of(p.x, side)] = true;
  return static_cast<double>(std::count(hit.begin(), hit.end(), false));
}

/// 0 unless `count` is a square.
std::uint32_t square_root(std::size_t count) {
  const auto root = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(count))));
  return std::size_t{root} * root == count ? root : 0;
}

/// The measures of one set, each computed when first asked for.
class Facts {
 public:
  explicit Facts(const MeasuredSet& set) : set_(set) {
    if (!set.density) return;
    spacing_.reserve(set.points.size());
    for (const auto& p : set.points) {
      const Extent size = set.density->size();
      const float value = set.density->at(cell_of(p.x, size.width), cell_of(p.y, size.height));
      spacing_.push_back(1 / std::sqrt(static_cast<double>(value)));
      outside_ = outside_ || !(value > 0);
    }
  }
  const MeasuredSet& set() const { return set_; }
  std::size_t count() const { return set_.points.size(); }
  bool adaptive() const { return set_.density != nullptr; }
  /// Why distances between points cannot be measured; empty if they can.
  std::string no_distances() const {
    if (adaptive() && set_.density->size().width != set_.density->size().height)
      return "distances on the torus need a square density";
    if (outside_) return "points lie where the density is 0; give it a floor";
    return {};
  }

  const analysis::Periodogram& periodogram() {
    return periodogram_.get([&] { return analysis::Periodogram(set_.points, spectrum_reach(count())); });
  }
  const analysis::RadialProfile& radial() {
    return radial_.get([&] {
      analysis::RadialAverage average;
      average.add(periodogram());
      return average.profile();
    });
  }
  const analysis::AxisPower& axes() {
    return axes_.get([&] { return analysis::axis_power(set_.points); });
  }
  const analysis::Spacing& spacing() {
    return nearest_.get([&] { return analysis::spacing(set_.points, spacing_); });
  }
  const analysis::BondOrder& order() {
    return order_.get([&] { return analysis::bond_order(set_.points); });
  }
  double star() {
    return star_.get([&] { return analysis::star_discrepancy(set_.points); });
  }
  const analysis::L2Discrepancies& l2() {
    return l2_.get([&] { return analysis::l2_discrepancies(set_.points); });
  }
  const analysis::CountVariation& counts() {
    return counts_.get([&] { return analysis::count_variation(set_.points, set_.pixels); });
  }
  const analysis::IntegrationError& integration() {
    return integration_.get([&] { return analysis::integration_error(set_.points); });
  }
  const analysis::PairCorrelation& pairs() {
    return pairs_.get(
        [&] { return analysis::pair_correlation(set_.points, std::vector<float>(spacing_.begin(), spacing_.end())); });
  }
  const DensityMatch& density() {
    return density_.get([&] { return match_density(set_.points, *set_.density); });
  }
  double diagnostic(std::string_view name) const {
    for (const Diagnostic& diagnostic : set_.diagnostics)
      if (diagnostic.name == name) return diagnostic.value;
    return std::nan("");
  }
  double warnings() const {
    return static_cast<double>(std::count_if(set_.diagnostics.begin(), set_.diagnostics.end(),
                                             [](const Diagnostic& diagnostic) { return diagnostic.warning; }));
  }
  /// Gives away what pictures need.
  void release(SetMeasures& measures) {
    measures.periodogram = periodogram_.take();
    measures.axes = axes_.take();
    measures.pairs = pairs_.take();
  }

 private:
  const MeasuredSet& set_;
  std::vector<double> spacing_;  // wanted at every point, any unit; empty for a uniform set
  bool outside_ = false;         // a point lies where the density is 0
  Lazy<analysis::Periodogram> periodogram_;
  Lazy<analysis::RadialProfile> radial_;
  Lazy<analysis::AxisPower> axes_;
  Lazy<analysis::Spacing> nearest_;
  Lazy<analysis::BondOrder> order_;
  Lazy<double> star_;
  Lazy<analysis::L2Discrepancies> l2_;
  Lazy<analysis::CountVariation> counts_;
  Lazy<analysis::IntegrationError> integration_;
  Lazy<analysis::PairCorrelation> pairs_;
  Lazy<DensityMatch> density_;
};

// --- Why a row may be skipped: empty = it is computed ---

std::string always(const Facts&) { return {}; }
std::string uniform_only(const Facts& facts) { return facts.adaptive() ? "defined for uniform sets only" : ""; }
std::string spectrum_limit(const Facts& facts) {
  if (facts.adaptive()) return "defined for uniform sets only; the pair correlation serves others";
  if (facts.count() > largest_for_spectrum)
    return fmt::format("{} points are more than {}: O(N^2) operations", facts.count(), largest_for_spectrum);
  return {};
}
std::string discrepancy_limit(const Facts& facts) {
  if (facts.adaptive()) return "defined for uniform sets only";
  if (facts.count() > largest_for_discrepancy)
    return fmt::format("{} points are more than {}: O(N^2) operations", facts.count(), largest_for_discrepancy);
  return {};
}
std::string distances(const Facts& facts) { return facts.no_distances(); }
std::string pair_limit(const Facts& facts) { return facts.count() < 16 ? "needs 16 points" : facts.no_distances(); }
std::string square_count(const Facts& facts) {
  if (facts.adaptive()) return "defined for uniform sets only";
  return square_root(facts.count()) == 0 ? "needs a square number of points" : "";
}
std::string density_only(const Facts& facts) { return facts.adaptive() ? "" : "needs a density"; }
std::string run_only(const Facts& facts) { return facts.set().diagnostics.empty() ? "its strategy reports none" : ""; }

struct Row {
  PointMetric metric;
  std::string (*reason)(const Facts&);
  double (*value)(Facts&);
};

const std::vector<Row>& rows() {
  static const std::vector<Row> table = {
      {{"effective_nyquist", "spectrum", "effective_nyquist", "sqrt(N)/2", "white noise 0, good blue noise > .8"},
       spectrum_limit,
       [](Facts& f) { return analysis::effective_nyquist(f.radial()); }},
      {{"oscillation", "spectrum", "oscillation", "", "lower aliases less; Poisson disk 1.4"},
       spectrum_limit,
       [](Facts& f) { return analysis::oscillation(f.radial()); }},
      {{"low_power", "spectrum", "low_power", "white noise = 1", "below sqrt(N)/2; good blue noise < 5e-4"},
       spectrum_limit,
       [](Facts& f) { return f.radial().low_power; }},
      {{"peak", "spectrum", "peak", "white noise = 1", "of the radial mean; lower aliases less"},
       spectrum_limit,
       [](Facts& f) { return analysis::spectral_peak(f.radial()).power; }},
      {{"peak_frequency", "spectrum", "peak_frequency", "sqrt(N)", "about 1 for blue noise"},
       spectrum_limit,
       [](Facts& f) { return analysis::spectral_peak(f.radial()).frequency; }},
      {{"anisotropy_db", "spectrum", "anisotropy_db", "dB", "0 for one set without preferred directions"},
       spectrum_limit,
       [](Facts& f) { return analysis::mean_anisotropy_db(f.radial()); }},
      {{"largest_axis_power", "spectrum", "largest_axis_power", "white noise = 1", "lattice alarm: below 30"},
       uniform_only,
       [](Facts& f) { return f.axes().largest; }},
      {{"largest_axis_frequency", "spectrum", "largest_axis_frequency", "cycles", "where that peak lies"},
       uniform_only,
       [](Facts& f) { return static_cast<double>(f.axes().frequency); }},
      {{"largest_diagonal_power", "spectrum", "largest_diagonal_power", "white noise = 1",
        "no alarm: good nets have it"},
       uniform_only,
       [](Facts& f) { return f.axes().largest_diagonal; }},
      {{"relative_radius", "spacing", "relative_radius", "r_max", "white noise .01, good blue noise > .7"},
       distances,
       [](Facts& f) { return f.spacing().smallest; }},
      {{"mean_nearest", "spacing", "mean_nearest", "r_max", "white noise .47, good blue noise > .87"},
       distances,
       [](Facts& f) { return f.spacing().mean; }},
      {{"nearest_quantile_01", "spacing", "nearest_quantile_01", "r_max", "1 % of the points are closer"},
       distances,
       [](Facts& f) { return f.spacing().quantile_01; }},
      {{"nearest_median", "spacing", "nearest_median", "r_max", "half of the points are closer"},
       distances,
       [](Facts& f) { return f.spacing().median; }},
      {{"pair_plateau", "spacing", "pair_plateau", "", "far pairs: 1 where the density is as wanted"},
       pair_limit,
       [](Facts& f) { return f.pairs().plateau; }},
      {{"local_order", "order", "local_order", "", "mean |psi_6|: white noise .37, hexagonal lattice 1"},
       always,
       [](Facts& f) { return f.order().local_order; }},
      {{"global_order", "order", "global_order", "", "|mean psi_6|: near 0 unless one crystal"},
       always,
       [](Facts& f) { return f.order().global_order; }},
      {{"six_valent", "order", "six_valent", "", "share with six neighbours: white noise .295, crystal 1"},
       always,
       [](Facts& f) { return f.order().six_valent; }},
      {{"coverage_radius", "order", "coverage_radius", "r_max", "largest hole: hexagonal lattice .577"},
       uniform_only,
       [](Facts& f) { return f.order().coverage_radius; }},
      {{"star_discrepancy", "discrepancy", "star", "", "boxes from the origin, exact; lower is better"},
       discrepancy_limit,
       [](Facts& f) { return f.star(); }},
      {{"l2_star_discrepancy", "discrepancy", "l2_star", "", "root; lower is better"},
       discrepancy_limit,
       [](Facts& f) { return f.l2().star; }},
      {{"centred_discrepancy", "discrepancy", "centred", "", "root; lower is better"},
       discrepancy_limit,
       [](Facts& f) { return f.l2().centred; }},
      {{"wraparound_discrepancy", "discrepancy", "wraparound", "", "root; the right one for periodic sets"},
       discrepancy_limit,
       [](Facts& f) { return f.l2().wraparound; }},
      {{"generalised_discrepancy", "discrepancy", "generalised", "", "root; lower is better"},
       discrepancy_limit,
       [](Facts& f) { return f.l2().generalised; }},
      {{"unanchored_discrepancy", "discrepancy", "unanchored", "", "root; lower is better"},
       discrepancy_limit,
       [](Facts& f) { return f.l2().unanchored; }},
      {{"symmetric_discrepancy", "discrepancy", "symmetric", "", "root; lower is better"},
       discrepancy_limit,
       [](Facts& f) { return f.l2().symmetric; }},
      {{"count_variation", "counts", "variation", "of the mean", "white noise 1/sqrt(mean); jittered pixels 0"},
       uniform_only,
       [](Facts& f) { return f.counts().coefficient; }},
      {{"empty_pixels", "counts", "empty_pixels", "pixels", "without a point"},
       uniform_only,
       [](Facts& f) { return static_cast<double>(f.counts().empty); }},
      {{"most_in_pixel", "counts", "most_in_pixel", "points", "in the fullest pixel"},
       uniform_only,
       [](Facts& f) { return static_cast<double>(f.counts().most); }},
      {{"empty_cells", "counts", "empty_cells", "cells", "of a sqrt(N) x sqrt(N) grid; white noise .368 N, a net 0"},
       square_count,
       [](Facts& f) { return empty_cells(f.set().points, square_root(f.count())); }},
      {{"half_plane_error", "integration", "half_plane", "white noise = 1", "edges; lower is better"},
       uniform_only,
       [](Facts& f) { return f.integration().half_planes; }},
      {{"gaussian_error", "integration", "gaussian", "white noise = 1", "smooth bumps; lower is better"},
       uniform_only,
       [](Facts& f) { return f.integration().gaussians; }},
      {{"disc_error", "integration", "disc", "white noise = 1", "round edges; lower is better"},
       uniform_only,
       [](Facts& f) { return f.integration().discs; }},
      {{"density_correlation", "density", "correlation", "", "of counts and density on 32 x 32 squares; good > .98"},
       density_only,
       [](Facts& f) { return f.density().correlation; }},
      {{"density_band_least", "density", "band_least", "wanted = 1", "emptiest of ten equal bands of density"},
       density_only,
       [](Facts& f) { return f.density().band_least; }},
      {{"density_band_most", "density", "band_most", "wanted = 1", "fullest of ten equal bands of density"},
       density_only,
       [](Facts& f) { return f.density().band_most; }},
      {{"iterations", "run", "iterations", "", "that the strategy took"},
       run_only,
       [](Facts& f) { return f.diagnostic("iterations"); }},
      {{"mean_displacement", "run", "mean_displacement", "spacings", "of the last iteration; converged < .01"},
       run_only,
       [](Facts& f) { return f.diagnostic("mean_displacement"); }},
      {{"converged", "run", "converged", "", "1 = the strategy says so"},
       run_only,
       [](Facts& f) { return f.diagnostic("converged"); }},
      {{"warnings", "run", "warnings", "", "what the strategy warns of; 0 is good"},
       run_only,
       [](Facts& f) { return f.warnings(); }},
  };
  return table;
}

}  // namespace

const std::vector<PointMetric>& point_metrics() {
  static const std::vector<PointMetric> table = [] {
    std::vector<PointMetric> metrics;
    for (const Row& row : rows()) metrics.push_back(row.metric);
    return metrics;
  }();
  return table;
}

const PointMetric& find_point_metric(std::string_view name) {
  std::vector<std::string> known;
  for (const PointMetric& metric : point_metrics()) {
    if (metric.name == name) return metric;
    known.push_back(metric.name);
  }
  throw ConfigError(
      fmt::format("metric '{}' of point sets is unknown; known metrics: {}", name, fmt::join(known, ", ")));
}

int spectrum_reach(std::size_t count) {
  const double factor = count <= 4096 ? 6 : count <= 16384 ? 3 : 2;
  return std::max(8, static_cast<int>(std::ceil(factor * std::sqrt(static_cast<double>(count)))));
}

SetMeasures measure(const MeasuredSet& set, std::span<const std::string> metrics, bool keep) {
  if (set.points.empty()) throw ConfigError("there are no points to measure; give at least one");
  for (const auto& name : metrics) find_point_metric(name);
  Facts facts(set);
  SetMeasures measures;
  for (const Row& row : rows()) {
    const std::string& name = row.metric.name;
    if (std::find(metrics.begin(), metrics.end(), name) == metrics.end()) continue;
    const std::string reason = row.reason(facts);
    if (reason.empty()) {
      measures.values[name] = row.value(facts);
    } else {
      measures.skipped[name] = reason;
    }
  }
  if (keep) {
    if (spectrum_limit(facts).empty()) facts.periodogram();
    if (uniform_only(facts).empty()) facts.axes();
    if (pair_limit(facts).empty()) facts.pairs();
    facts.release(measures);
  }
  return measures;
}

}  // namespace abn::harness
