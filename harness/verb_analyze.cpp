// abn analyze: what a strategy or a file of points is worth, without an integrand.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "harness/backend.h"
#include "harness/analysis.h"
#include "harness/analysis_pictures.h"
#include "harness/density.h"
#include "harness/image_io.h"
#include "harness/point_source.h"
#include "harness/run.h"
#include "harness/verbs.h"
#include "sampling/atomic_file.h"
#include "sampling/error.h"
#include "sampling/points_io.h"

namespace abn::harness {
namespace {

namespace fs = std::filesystem;

/// The folder of the results, made if need be; asked for before the work.
void prepare_folder(const fs::path& folder) {
  if (folder.empty()) return;
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    throw IoError(fmt::format("{}: this is no folder; give a folder with -o", folder.string()));
  fs::create_directories(folder, error);
  if (error)
    throw IoError(
        fmt::format("{}: cannot be made: {}; give a writable folder with -o", folder.string(), error.message()));
  const AtomicFile probe(folder / "analysis.json");
}

/// Positions of a file on the unit torus.
std::vector<analysis::Point> read_set(const std::string& file, bool quiet) {
  const FilePoints read = read_points(file);
  if (!read.notice.empty() && !quiet) fmt::print(stderr, "abn: {}: {}\n", file, read.notice);
  std::vector<analysis::Point> points;
  for (const FilePoint& p : read.position) {
    const auto wrapped = [](double value) {
      const double rest = value - std::floor(value);
      return rest < 1 ? rest : 0.0;
    };
    points.push_back({wrapped(p.x), wrapped(p.y)});
  }
  return points;
}

void save(const fs::path& path, const Picture& picture) {
  if (!picture.rgb.empty()) save_rgb8(path.string(), picture.size(), picture.rgb);
}

void write_results(const Analysis& analysis, const fs::path& folder) {
  write_atomically(folder / "analysis.json", to_json(analysis, true).dump(1) + "\n");
  save(folder / "points.png", draw_points(analysis, 640));
  save(folder / "spectrum.png", draw_spectrum(analysis, 640));
  save(folder / "radial.png", draw_radial({&analysis}));
  save(folder / "pair_correlation.png", draw_pair_correlation({&analysis}));
  save(folder / "sheet.png", draw_sheet(analysis));
}

void require_words(const AnalyzeOptions& options) {
  if (options.file.empty() == options.strategy.empty())
    throw ConfigError(options.file.empty() ? "give a file of points, or a strategy with --strategy"
                                           : "give either a file of points or --strategy, not both");
  if (options.strategy.empty() && (options.count > 0 || options.sets > 0 || !options.set.empty())) {
    throw ConfigError(fmt::format("{}: a file has its own points; leave out --count, --sets and --set", options.file));
  }
}

/// The analysis of a file, or of the sets that a strategy draws.
Analysis analyze_sets(const GlobalOptions& global, const AnalyzeOptions& options, AnalysisSource source) {
  if (!options.file.empty()) {
    source.name = fs::path(options.file).filename().string();
    source.description["file"] = options.file;
    Analysis analysis(std::move(source));
    Progress progress("analyze", 1, global.quiet);
    std::vector<analysis::Point> points = read_set(options.file, global.quiet);
    progress.update(0, source.name);
    analysis.add(std::move(points));
    return analysis;
  }
  PointTask task{.strategy = options.strategy,
                 .parameters = parse_assignments(options.set),
                 .count = options.count > 0 ? options.count : 4096,
                 .seed = options.seed,
                 .backend = global.backend,
                 .density = source.density,
                 .cache = !global.no_cache};
  ParameterWords words = task.parameters;
  const Strategy& strategy = find_strategy(task.strategy, words);
  std::uint64_t sets = options.sets > 0 ? options.sets : 10;
  if (!strategy.info.random && sets > 1) {
    if (options.sets > 1 && !global.quiet)
      fmt::print(stderr, "abn: {} gives the same points for every seed; one set is analysed\n", task.strategy);
    sets = 1;
  }
  if (!global.quiet) tell_fallback(task.backend, strategy.info);
  source.name = options.strategy;
  source.description["strategy"] = strategy.info.name;
  source.description["params"] = Json::object();
  for (const auto& [key, value] : strategy.resolve(words)) source.description["params"][key] = value;
  source.description["seed"] = options.seed;
  Analysis analysis(std::move(source));
  Progress progress("analyze", sets, global.quiet);
  for (std::uint64_t k = 0; k < sets; ++k) {
    stop_if_interrupted();
    task.seed = options.seed + k;
    progress.update(k, fmt::format("drawing set {}", k + 1));
    const DrawnPoints drawn = draw_points(task);
    progress.update(k, fmt::format("measuring set {}", k + 1));
    analysis.add(analysis::to_unit(drawn.set.position, drawn.plane), drawn.diagnostics);
    for (const Diagnostic& diagnostic : drawn.diagnostics) {
      if (!diagnostic.warning || global.quiet) continue;
      progress.clear();
      fmt::print(stderr, "abn: {}, seed {}: {}: {}\n", options.strategy, task.seed, diagnostic.name, diagnostic.text);
    }
  }
  return analysis;
}

}  // namespace

int analyze(const GlobalOptions& global, const AnalyzeOptions& options) {
  require_words(options);
  AnalysisSource source;
  source.pixels = parse_extent(options.pixels, "--pixels");
  if (!options.density.empty()) {
    const LoadedDensity loaded = load_density(
        options.density,
        {.channels = options.channels, .on_nonfinite = options.on_nonfinite, .floor = options.density_floor});
    source.density = loaded.density;
    for (const auto& notice : loaded.notices)
      if (!global.quiet) fmt::print(stderr, "abn: {}: {}\n", options.density, notice);
    source.description["density"] = options.density;
    source.description["density_floor"] = options.density_floor;
  }
  source.description["pixels"] = fmt::format("{}x{}", source.pixels.width, source.pixels.height);
  prepare_folder(options.output);
  const Analysis analysis = analyze_sets(global, options, std::move(source));
  if (!options.output.empty()) write_results(analysis, options.output);
  if (global.json) {
    fmt::print("{}\n", to_json(analysis, false).dump());
    return 0;
  }
  fmt::print("{}", to_text(analysis));
  if (!options.output.empty() && !global.quiet)
    fmt::print("results   {}\npictures  {}\n", (fs::path(options.output) / "analysis.json").string(),
               (fs::path(options.output) / "sheet.png").string());
  return 0;
}

}  // namespace abn::harness
