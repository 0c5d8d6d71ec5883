// abn points: a strategy's samples as a file, and as a picture.
#include <fmt/format.h>

#include <algorithm>

#include "harness/backend.h"
#include "harness/analysis_pictures.h"
#include "harness/density.h"
#include "harness/image_io.h"
#include "harness/output.h"
#include "harness/point_source.h"
#include "harness/record.h"
#include "harness/verbs.h"
#include "sampling/error.h"
#include "sampling/points_io.h"

namespace abn::harness {
namespace {

/// A picture as wide as its density, within what a screen shows.
void draw_picture(const std::string& path, const DrawnPoints& drawn, const Grid<float>* density) {
  const std::uint32_t width = density == nullptr ? 1000 : std::clamp(density->size().width, 1000U, 2000U);
  std::vector<analysis::Point> ghosts;
  for (const Vec2f ghost : drawn.ghosts)
    ghosts.push_back({double{ghost.x} / drawn.plane.width, double{ghost.y} / drawn.plane.height});
  const Picture picture = draw_stipples(analysis::to_unit(drawn.set.position, drawn.plane), density, width, ghosts);
  save_rgb8(path, picture.size(), picture.rgb);
}

}  // namespace

int points(const GlobalOptions& global, const PointsOptions& options) {
  PointTask task{.strategy = options.strategy,
                 .parameters = parse_assignments(options.set),
                 .count = options.count,
                 .seed = options.seed,
                 .backend = global.backend,
                 .cache = !global.no_cache};
  const PointFormat format = options.format.empty() ? format_for(options.output) : parse_point_format(options.format);
  // All that can be wrong shows before the work: a wrong name must not cost minutes.
  require_points(task);
  require_writable(options.output);
  if (!options.picture.empty()) {
    require_writable_image(options.picture);
    if (is_linear_format(options.picture))
      throw ConfigError(fmt::format("--picture {}: dots are drawn as 8-bit pictures; give a .png", options.picture));
  }
  if (!options.density.empty()) {
    const LoadedDensity loaded = load_density(
        options.density,
        {.channels = options.channels, .on_nonfinite = options.on_nonfinite, .floor = options.density_floor});
    task.density = loaded.density;
    for (const auto& notice : loaded.notices)
      if (!global.quiet) fmt::print(stderr, "abn: {}: {}\n", options.density, notice);
  }

  if (!global.quiet) {
    ParameterWords words = task.parameters;
    tell_fallback(task.backend, find_strategy(task.strategy, words).info);
  }

  Progress progress(options.strategy, options.count, global.quiet);
  progress.update(0);
  const DrawnPoints drawn = draw_points(task, &progress);
  stop_if_interrupted();
  progress.update(options.count, "writing");
  const std::string notice = write_points(options.output, drawn.set.view(), drawn.plane, format);
  if (!options.picture.empty()) draw_picture(options.picture, drawn, task.density.get());
  progress.clear();
  if (!global.quiet) {
    if (!notice.empty()) fmt::print(stderr, "abn: {}: {}\n", options.output, notice);
    for (const Diagnostic& diagnostic : drawn.diagnostics) {
      if (diagnostic.warning)
        fmt::print(stderr, "abn: {}: {}: {}\n", options.strategy, diagnostic.name, diagnostic.text);
    }
  }
  const std::size_t count = drawn.set.position.size();
  if (global.json) {
    Json json = {{"strategy", options.strategy}, {"count", count}, {"seed", options.seed}, {"file", options.output}};
    if (!options.density.empty()) json["density"] = options.density;
    if (!options.picture.empty()) json["picture"] = options.picture;
    fmt::print("{}\n", json.dump());
  } else if (!global.quiet) {
    // The points themselves may be on stdout.
    fmt::print(options.output.starts_with("/dev/") ? stderr : stdout, "wrote {} points to {}\n", count, options.output);
  }
  return 0;
}

}  // namespace abn::harness
