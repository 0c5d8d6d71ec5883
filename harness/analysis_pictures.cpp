#include "harness/analysis_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/chart.h"

namespace abn::harness {
namespace {

std::string sets_text(std::size_t sets) { return sets == 1 ? "1 set" : fmt::format("mean of {} sets", sets); }

/// Aspect of the plane that the unit square stands for.
Extent extent_of(const Analysis& analysis) {
  return analysis.source().density ? analysis.source().density->size() : Extent{1, 1};
}

std::vector<CanvasPoint> on_extent(const std::vector<analysis::Point>& points, Extent extent) {
  std::vector<CanvasPoint> positions;
  positions.reserve(points.size());
  for (const auto& p : points) positions.push_back({p.x * extent.width, p.y * extent.height});
  return positions;
}

/// Two charts above each other.
Picture stack(const Picture& above, const Picture& below) {
  Picture both(std::max(above.width, below.width), above.height + below.height);
  paste(both, above, 0, 0);
  paste(both, below, 0, static_cast<int>(above.height));
  return both;
}

/// A page's height must not grow by a scatter of a tall plane: as wide as fits into a square of `width`.
std::uint32_t fitted_width(Extent extent, std::uint32_t width) {
  const double aspect = static_cast<double>(extent.width) / extent.height;
  return aspect >= 1 ? width : std::max(120U, static_cast<std::uint32_t>(width * aspect));
}

}  // namespace

Picture draw_points(const Analysis& analysis, std::uint32_t width, const std::string& title) {
  const Extent extent = extent_of(analysis);
  ScatterChart chart;
  chart.title = !title.empty()         ? title
                : analysis.sets() == 1 ? fmt::format("{} points", analysis.count())
                                       : fmt::format("{} points, first of {} sets", analysis.count(), analysis.sets());
  chart.width = extent.width;
  chart.height = extent.height;
  chart.picture_width = fitted_width(extent, width);
  // A sixth of the mean distance: dense enough to be seen, small enough to stay apart.
  const double spacing = (chart.picture_width - 20.0) / std::sqrt(static_cast<double>(analysis.count()));
  chart.radius = std::clamp(spacing / 6, 0.6, 3.0);
  chart.dots.push_back({.label = "", .position = on_extent(analysis.first_set(), extent)});
  return harness::draw_scatter(chart);
}

Picture draw_spectrum(const Analysis& analysis, std::uint32_t width) {
  const analysis::PeriodogramMean& spectrum = analysis.periodogram();
  if (spectrum.sets() == 0) return {};
  // Whole pixels per frequency, and frequencies to about 2 sqrt(N), where blue noise has become white.
  const double root = std::sqrt(static_cast<double>(analysis.count()));
  const auto room = static_cast<int>(width) - 20;
  int reach = 0;
  for (int factor = 12; factor >= 1; --factor) {
    reach = std::min({(room / factor - 1) / 2, spectrum.reach(), static_cast<int>(2.5 * root) + 1});
    if (reach >= 1.7 * root) break;
  }
  RasterChart chart;
  chart.title = "power spectrum, " + sets_text(analysis.sets());
  chart.note = fmt::format("frequencies to {:.2g} sqrt(N) on both axes, 0 in the middle", reach / root);
  chart.values = Grid<float>({static_cast<std::uint32_t>(2 * reach + 1), static_cast<std::uint32_t>(2 * reach + 1)});
  for (int v = -reach; v <= reach; ++v) {
    for (int u = -reach; u <= reach; ++u) {
      // P(0,0) = N says nothing; black keeps the middle readable.
      chart.values.at(static_cast<std::uint32_t>(u + reach), static_cast<std::uint32_t>(v + reach)) =
          u == 0 && v == 0 ? 0.0F : static_cast<float>(spectrum.power(u, v));
    }
  }
  chart.high = 3;
  chart.bar_label = "power, white noise = 1; 3 and above are white";
  chart.picture_width = width;
  return draw_raster(chart);
}

Picture draw_radial(const std::vector<const Analysis*>& analyses, std::uint32_t width) {
  LineChart mean;
  LineChart anisotropy;
  double highest = 2;
  std::size_t colour = 0;
  std::size_t sets = 0;
  for (const Analysis* analysis : analyses) {
    const auto spectrum = analysis->averaged_spectrum();
    if (!spectrum) continue;
    const analysis::RadialProfile& radial = spectrum->radial;
    const double root = std::sqrt(static_cast<double>(analysis->count()));
    Series power;
    power.label = analyses.size() > 1 ? analysis->source().name : "";
    power.colour = series_colour(colour++);
    Series directions = power;
    directions.label = "";
    const double t = radial.sets > 1 ? student_quantile(0.975, radial.sets - 1.0) : 0;
    for (std::size_t k = 1; k < radial.mean.size(); ++k) {
      const double frequency = static_cast<double>(k) / root;
      if (frequency > 3) break;
      power.x.push_back(frequency);
      power.y.push_back(radial.mean[k]);
      directions.x.push_back(frequency);
      directions.y.push_back(std::max(-30.0, radial.anisotropy_db[k]));
      if (radial.sets > 1) {
        power.low.push_back(std::max(0.0, radial.mean[k] - t * radial.standard_error[k]));
        power.high.push_back(radial.mean[k] + t * radial.standard_error[k]);
      }
      highest = std::max(highest, std::min(6.0, 1.05 * (power.high.empty() ? power.y : power.high).back()));
    }
    mean.series.push_back(std::move(power));
    anisotropy.series.push_back(std::move(directions));
    if (sets == 0) anisotropy.levels = {{radial.isotropic_db, "isotropic"}};
    sets = analysis->sets();
  }
  if (mean.series.empty()) return {};
  mean.title = width < 480 ? std::string("radial mean of the power")
                           : fmt::format("radial mean of the power, {}{}", sets_text(sets),
                                         sets > 1 ? ", band: 95 % interval" : "");
  mean.x.low = anisotropy.x.low = 0;
  mean.x.high = anisotropy.x.high = 3;
  mean.y = {.label = "power, white = 1", .low = 0, .high = highest};
  mean.levels = {{1, "white"}};
  mean.width = anisotropy.width = width;
  mean.height = 250 + 18 * static_cast<std::uint32_t>(analyses.size() > 1 ? 1 + analyses.size() / 4 : 0);
  mean.x.label = "";
  anisotropy.title = "";
  anisotropy.x.label = "frequency / sqrt(N)";
  anisotropy.y.label = "anisotropy [dB]";
  anisotropy.y.low = -20;
  anisotropy.y.high = 20;
  anisotropy.height = 170;
  mean.left_room = anisotropy.left_room = 70;
  mean.right_room = anisotropy.right_room = 70;
  return stack(harness::draw_chart(mean), harness::draw_chart(anisotropy));
}

Picture draw_pair_correlation(const std::vector<const Analysis*>& analyses, std::uint32_t width) {
  LineChart chart;
  double highest = 2;
  bool adaptive = false;
  for (const Analysis* analysis : analyses) {
    const auto pairs = analysis->pair_correlation();
    if (!pairs) continue;
    Series series;
    series.label = analyses.size() > 1 ? analysis->source().name : "";
    series.colour = series_colour(chart.series.size());
    // Bins of 1/16 spacing: single ones of small sets are too noisy to be read.
    for (std::size_t k = 0; k + 1 < pairs->g.size(); k += 2) {
      const double inner = static_cast<double>(k) * pairs->bin_width;
      if (inner > 5) break;
      const double share = (2.0 * static_cast<double>(k) + 1) / (4.0 * static_cast<double>(k) + 4);  // by area
      series.x.push_back(inner + pairs->bin_width);
      series.y.push_back(share * pairs->g[k] + (1 - share) * pairs->g[k + 1]);
      highest = std::max(highest, 1.05 * series.y.back());
    }
    adaptive = adaptive || analysis->source().density != nullptr;
    chart.series.push_back(std::move(series));
  }
  if (chart.series.empty()) return {};
  chart.title = "pair correlation, " + sets_text(analyses.front()->sets());
  chart.x = {.label = adaptive ? "distance / local spacing" : "distance * sqrt(N)", .low = 0, .high = 5};
  chart.y = {.label = "g, white = 1", .low = 0, .high = highest};
  chart.levels = {{1, "white"}};
  chart.width = width;
  chart.height = 270;
  return harness::draw_chart(chart);
}

Picture draw_sheet(const Analysis& analysis) {
  Page page;
  page.title = fmt::format("{}: {} of {} points", analysis.source().name,
                           analysis.sets() == 1 ? "1 set" : fmt::format("{} sets", analysis.sets()), analysis.count());
  std::vector<Picture> row = {draw_points(analysis)};
  if (Picture spectrum = draw_spectrum(analysis); !spectrum.rgb.empty()) row.push_back(std::move(spectrum));
  page.rows.push_back(std::move(row));
  row.clear();
  for (Picture& picture :
       std::vector<Picture>{draw_radial({&analysis}, 480), draw_pair_correlation({&analysis}, 480)}) {
    if (!picture.rgb.empty()) row.push_back(std::move(picture));
  }
  if (!row.empty()) page.rows.push_back(std::move(row));
  std::string line;
  for (const Estimate& estimate : analysis.estimates()) {
    const std::string& name = estimate.metric->name;
    const bool shown = name == "effective_nyquist" || name == "low_power" || name == "relative_radius" ||
                       name == "mean_nearest" || name == "largest_axis_power" || name == "half_plane_error" ||
                       name == "density_correlation";
    if (!shown || estimate.summary.count == 0) continue;
    line += fmt::format("{}{} {:.3g}", line.empty() ? "" : ",  ", name, estimate.summary.mean);
  }
  page.note = line;
  return draw_page(page);
}

Picture draw_stipples(const std::vector<analysis::Point>& points, const Grid<float>* density, std::uint32_t width,
                      const std::vector<analysis::Point>& ghosts) {
  const Extent extent = density != nullptr ? density->size() : Extent{1, 1};
  const auto height =
      std::max(1U, static_cast<std::uint32_t>(std::lround(static_cast<double>(width) * extent.height / extent.width)));
  double share = 0.5;  // of the paper that all dots cover, overlaps counted twice
  if (density != nullptr) {
    std::vector<float> values(density->cells().begin(), density->cells().end());
    double sum = 0;
    for (const float value : values) sum += static_cast<double>(value);
    const auto fullest = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * 49 / 50);
    std::nth_element(values.begin(), fullest, values.end());
    const auto bright = static_cast<double>(*fullest);
    if (bright > 0) share = 0.8 * std::min(1.0, sum / (bright * static_cast<double>(values.size())));
  }
  // The plane in the middle, around it as much as the ghosts need.
  double border = 0;
  for (const auto& ghost : ghosts) {
    const double x = std::max(-ghost.x, ghost.x - 1) * width;
    const double y = std::max(-ghost.y, ghost.y - 1) * height;
    border = std::max({border, x, y});
  }
  const double area = static_cast<double>(width) * height * share / static_cast<double>(points.size());
  const double radius = std::max(0.4, std::sqrt(area / std::numbers::pi));
  const int margin = ghosts.empty() ? 0 : static_cast<int>(std::ceil(border + radius)) + 1;
  const auto all_around = 2 * static_cast<std::uint32_t>(margin);
  Picture picture(width + all_around, height + all_around, {0, 0, 0});
  const auto draw = [&](const std::vector<analysis::Point>& dots, Rgb8 colour) {
    std::vector<CanvasPoint> centres = on_extent(dots, {width, height});
    for (auto& centre : centres) centre = {centre.x + margin, centre.y + margin};
    draw_dots(picture, area_of(picture), centres, radius, colour);
  };
  if (!ghosts.empty()) {
    draw(ghosts, {86, 180, 233});
    draw_border(picture, {margin - 1, margin - 1, static_cast<int>(width) + 2, static_cast<int>(height) + 2},
                {120, 120, 120});
  }
  draw(points, {255, 255, 255});
  return picture;
}

}  // namespace abn::harness
