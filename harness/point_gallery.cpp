#include "harness/point_gallery.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "harness/analysis_pictures.h"
#include "harness/chart.h"
#include "harness/density.h"
#include "harness/experiment_loop.h"
#include "harness/image_io.h"
#include "harness/statistics.h"
#include "sampling/error.h"
#include "sampling/points_io.h"

namespace abn::harness {
namespace {

namespace fs = std::filesystem;

/// A density as a part of file names, with '_' behind it; empty for none.
std::string density_stem(const std::string& density) {
  if (density.empty()) return "";
  if (density.starts_with("scene:")) return file_name(density.substr(6)) + "_";
  if (density.starts_with("size:")) return file_name(density) + "_";
  return file_name(fs::path(density).stem().string()) + "_";
}

std::string picture_stem(const std::string& density, std::uint64_t count, const std::string& label) {
  return fmt::format("{}{}_{}", density_stem(density), count, file_name(label));
}

using Density = std::shared_ptr<const Grid<float>>;

/// All sets of one strategy, from disk; nothing if one is missing. Only what the pictures show is measured.
std::optional<Analysis> read_sets(const fs::path& out, PointRunSpec run, std::uint64_t first_seed, std::uint64_t seeds,
                                  const Density& density) {
  Analysis analysis({.name = run.label, .density = density, .metrics = std::vector<std::string>{}});
  for (std::uint64_t k = 0; k < seeds; ++k) {
    run.task.seed = first_seed + k;
    const fs::path file = points_file(out, run);
    std::error_code error;
    if (!fs::exists(file, error)) return std::nullopt;
    std::vector<analysis::Point> points;
    for (const FilePoint& p : read_points(file).position) points.push_back({p.x, p.y});
    analysis.add(std::move(points));
  }
  return analysis;
}

void save(const fs::path& path, const Picture& picture) {
  if (!picture.rgb.empty()) save_rgb8(path.string(), picture.size(), picture.rgb);
}

/// The wanted density in grey, brightest = highest.
Picture draw_density(const Grid<float>& density, std::uint32_t width) {
  Image image(density.size(), 1);
  const float largest = *std::max_element(density.cells().begin(), density.cells().end());
  for (std::size_t i = 0; i < image.texels.size(); ++i) image.texels[i] = density[i] / largest;
  const Picture whole = to_picture(image);
  // Nearest cells are enough to recognise it by.
  const auto height =
      static_cast<std::uint32_t>(std::max(1L, std::lround(static_cast<double>(width) * whole.height / whole.width)));
  Picture small(width, height);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      std::copy_n(whole.pixel(static_cast<std::uint32_t>(std::uint64_t{x} * whole.width / width),
                              static_cast<std::uint32_t>(std::uint64_t{y} * whole.height / height)),
                  3, small.pixel(x, y));
    }
  }
  return small;
}

/// Thesis fig. 3.4: points above, spectra below, radial means under them; then all of them in one chart.
Picture draw_uniform_sheet(const std::string& title, const std::vector<const Analysis*>& analyses) {
  const std::uint32_t width = analyses.size() <= 4 ? 400 : 320;
  Page columns;
  columns.title = title;
  columns.rows.resize(3);
  for (const Analysis* analysis : analyses) {
    columns.rows[0].push_back(draw_points(*analysis, width, analysis->source().name));
    columns.rows[1].push_back(draw_spectrum(*analysis, width));
    columns.rows[2].push_back(draw_radial({analysis}, width));
  }
  std::vector<Picture> together;
  for (Picture& picture : std::vector<Picture>{draw_radial(analyses, 760), draw_pair_correlation(analyses, 760)}) {
    if (!picture.rgb.empty()) together.push_back(std::move(picture));
  }
  const Picture above = draw_page(columns);
  if (analyses.size() == 1 || together.empty()) return above;
  const Picture below = draw_page({.title = "", .note = "", .rows = {together}});
  Picture sheet(std::max(above.width, below.width), above.height + below.height);
  paste(sheet, above, 0, 0);
  paste(sheet, below, 0, static_cast<int>(above.height));
  return sheet;
}

/// The density and what every strategy made of it, in rows of three; the pair correlation below.
Picture draw_density_sheet(const std::string& title, const Grid<float>& density,
                           const std::vector<const Analysis*>& analyses) {
  constexpr std::uint32_t width = 700;
  std::vector<MontageItem> items = {{.label = "density wanted", .picture = draw_density(density, width)}};
  for (const Analysis* analysis : analyses) {
    items.push_back(
        {.label = analysis->source().name, .picture = draw_stipples(analysis->first_set(), &density, width)});
  }
  const Picture above = montage(items, {.columns = items.size() <= 4 ? 2U : 3U,
                                        .title = title,
                                        .note = "White dots, many where the density is high.",
                                        .colour_bar = std::nullopt});
  const Picture below = draw_pair_correlation(analyses, std::min(above.width, 900U));
  if (below.rgb.empty()) return above;
  Picture sheet(above.width, above.height + below.height + 20);
  paste(sheet, above, 0, 0);
  paste(sheet, below, 20, static_cast<int>(above.height));
  return sheet;
}

/// Mean of a metric over the seeds of a label; NaN if there is none.
double mean_of_rows(const std::vector<Json>& rows, const std::string& density, std::uint64_t count,
                    const std::string& label, const std::string& metric) {
  std::vector<double> values;
  for (const auto& row : rows) {
    if (row["density"] != density || row["count"] != count || row["label"] != label) continue;
    const Json& score = row["scores"].contains(metric) ? row["scores"][metric] : Json(nullptr);
    if (score.is_number()) values.push_back(score);
  }
  return summarize(values).mean;
}

/// A map of every metric for one swept strategy: the first two keys span it, the third (or nothing) makes several.
void draw_maps(const PointExperimentSpec& spec, const fs::path& out, const std::vector<Json>& rows,
               const std::string& density, std::uint64_t count) {
  for (const auto& choice : spec.strategies) {
    std::vector<SweepAxis> axes;
    for (const auto& axis : spec.sweep)
      if (axis.strategy == choice.name || axis.strategy == choice.label) axes.push_back(axis);
    if (axes.size() != 2 && axes.size() != 3) continue;
    const SweepAxis& x = axes[0];
    const SweepAxis& y = axes[1];
    const std::vector<std::string> panels = axes.size() == 3 ? axes[2].values : std::vector<std::string>{""};
    for (const auto& metric : spec.metrics) {
      std::vector<HeatMap> maps;
      double low = INFINITY;
      double high = -INFINITY;
      for (const auto& panel : panels) {
        HeatMap map;
        map.title = axes.size() == 3 ? fmt::format("{} = {}", axes[2].key, panel) : choice.label;
        map.x_label = x.key;
        map.y_label = y.key;
        map.x_words = x.values;
        map.y_words = y.values;
        map.values = Grid<double>(
            {static_cast<std::uint32_t>(x.values.size()), static_cast<std::uint32_t>(y.values.size())}, std::nan(""));
        for (std::uint32_t j = 0; j < map.values.size().height; ++j) {
          for (std::uint32_t i = 0; i < map.values.size().width; ++i) {
            std::string label = choice.label + fmt::format(" {}={} {}={}", x.key, x.values[i], y.key, y.values[j]);
            if (axes.size() == 3) label += fmt::format(" {}={}", axes[2].key, panel);
            const double value = mean_of_rows(rows, density, count, label, metric);
            map.values.at(i, j) = value;
            if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
          }
        }
        maps.push_back(std::move(map));
      }
      if (!(low <= high)) continue;  // defined nowhere
      if (!(low < high)) high = low + 1;
      Page page;
      const std::string& unit = find_point_metric(metric).unit;
      page.title = fmt::format("{}{} of {}: {}{} points, {}", metric, unit.empty() ? "" : " [" + unit + "]",
                               choice.label, density.empty() ? "" : density + ", ", count,
                               spec.seeds == 1 ? "1 set" : fmt::format("mean of {} sets", spec.seeds));
      page.rows.emplace_back();
      for (HeatMap& map : maps) {
        map.low = low;
        map.high = high;
        map.note = "the colours of all maps of this page mean the same";
        if (maps.size() == 1) map.note = metric;
        page.rows[0].push_back(draw_heat_map(map));
      }
      save(out / fmt::format("map_{}_{}.png", picture_stem(density, count, choice.label), metric), draw_page(page));
    }
  }
}

}  // namespace

fs::path points_file(const fs::path& out, const PointRunSpec& spec) {
  return out / "points" /
         fmt::format("{}_{}.bin", picture_stem(spec.density, spec.task.count, spec.label), spec.task.seed);
}

void require_own_pictures(const PointExperimentSpec& spec) {
  std::map<std::string, std::string> owners;
  for (const auto& run : spec.expand()) {
    const auto [other, is_new] = owners.emplace(points_file("", run).string(), run.label);
    if (!is_new) {
      throw ConfigError(fmt::format("the files of '{}' and '{}' would have the same names; change a label or a density",
                                    other->second, run.label));
    }
  }
}

fs::path draw_gallery(const PointExperimentSpec& spec, const fs::path& out, const std::vector<Json>& rows) {
  fs::create_directories(out / "images");
  const std::vector<StrategyChoice> choices = spec.choices();
  fs::path first;
  for (const auto& word : spec.densities) {
    const Density density = word.empty() ? nullptr : load_density(word, {.floor = spec.density_floor}).density;
    for (const std::uint64_t count : spec.counts) {
      draw_maps(spec, out, rows, word, count);
      // A sweep is looked at in maps; a sheet of dozens of columns could not be read.
      if (choices.size() > 12) continue;
      std::vector<Analysis> analyses;
      for (const auto& choice : choices) {
        PointRunSpec run{.label = choice.label, .density = word, .task = {}};
        run.task.count = count;
        auto analysis = read_sets(out, run, spec.first_seed, spec.seeds_of(choice), density);
        if (!analysis) break;
        const std::string stem = picture_stem(word, count, choice.label);
        if (density) {
          save(out / "images" / (stem + "_points.png"), draw_stipples(analysis->first_set(), density.get(), 1200));
        } else {
          save(out / "images" / (stem + "_points.png"), draw_points(*analysis, 640, choice.label));
          save(out / "images" / (stem + "_spectrum.png"), draw_spectrum(*analysis, 640));
          save(out / "images" / (stem + "_radial.png"), draw_radial({&*analysis}));
        }
        save(out / "images" / (stem + "_pair_correlation.png"), draw_pair_correlation({&*analysis}));
        analyses.push_back(std::move(*analysis));
      }
      if (analyses.size() != choices.size()) continue;
      std::vector<const Analysis*> all;
      for (const auto& analysis : analyses) all.push_back(&analysis);
      const std::string title = fmt::format("{}: {}{} points, {} {}", spec.title, word.empty() ? "" : word + ", ",
                                            count, spec.seeds, spec.seeds == 1 ? "set" : "sets");
      const bool only_one = spec.densities.size() * spec.counts.size() == 1;
      const fs::path path =
          out / (only_one ? "overview.png" : fmt::format("overview_{}{}.png", density_stem(word), count));
      save(path, density ? draw_density_sheet(title, *density, all) : draw_uniform_sheet(title, all));
      if (first.empty()) first = path;
    }
  }
  return first;
}

}  // namespace abn::harness
