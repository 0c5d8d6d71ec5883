// abn points: a strategy's samples as a file.
#include <fmt/format.h>

#include <optional>

#include "harness/backend.h"
#include "harness/output.h"
#include "harness/progress.h"
#include "harness/record.h"
#include "harness/run.h"
#include "harness/verbs.h"
#include "sampling/density_warp.h"
#include "sampling/error.h"
#include "sampling/points_io.h"

namespace abn::harness {
namespace {

/// Luminance of an image or scene as a density; negative luminances cannot be one.
Grid<float> load_density(const PointsOptions& options) {
  SubjectSpec spec;
  spec.scene = options.density;
  spec.channels = options.channels;
  spec.on_nonfinite = options.on_nonfinite;
  const auto subject = load_subject(spec, false);
  const Image& source = subject->source;
  Grid<float> density(source.size);
  for (std::size_t i = 0; i < density.cells().size(); ++i)
    density[i] = luminance(&source.texels[i * source.channels], source.channels);
  return density;
}

}  // namespace

int points(const GlobalOptions& global, const PointsOptions& options) {
  ParameterWords words = parse_assignments(options.set);
  const Strategy& strategy = find_strategy(options.strategy, words);
  static_cast<void>(strategy.resolve(words));
  const PointFormat format = options.format.empty() ? format_for(options.output) : parse_point_format(options.format);
  const Backend backend = resolve_backend(global.backend);
  require_writable(options.output);

  // The unit square is a plane of one pixel.
  const SamplingTask task{.plane = {1, 1}, .budget = options.count, .seed = options.seed, .solver = backend.factory};
  const auto sampler = strategy.make(task, words);
  // Read before the work: a wrong name must not cost minutes.
  std::optional<DensityWarp> warp;
  if (!options.density.empty()) warp.emplace(load_density(options));
  const Grid<PixelStats> nothing(task.plane);
  PointSet set;
  Progress progress(options.strategy, options.count, global.quiet);
  progress.update(0);
  for (auto batch = next_batch(*sampler, {nothing}); !batch.empty(); batch = next_batch(*sampler, {nothing})) {
    stop_if_interrupted();
    set.position.insert(set.position.end(), batch.position.begin(), batch.position.end());
    set.weight.insert(set.weight.end(), batch.weight.begin(), batch.weight.end());
    progress.update(set.position.size());
  }
  if (warp) {
    for (auto& position : set.position) position = (*warp)(position);
  }
  stop_if_interrupted();
  progress.update(options.count, "writing");
  const std::string notice = write_points(options.output, set.view(), task.plane, format);
  progress.clear();
  if (!notice.empty() && !global.quiet) fmt::print(stderr, "abn: {}: {}\n", options.output, notice);
  if (global.json) {
    fmt::print("{}\n", Json({{"strategy", options.strategy},
                             {"count", set.position.size()},
                             {"seed", options.seed},
                             {"file", options.output}})
                           .dump());
  } else if (!global.quiet) {
    // The points themselves may be on stdout.
    fmt::print(options.output.starts_with("/dev/") ? stderr : stdout, "wrote {} points to {}\n", set.position.size(),
               options.output);
  }
  return 0;
}

}  // namespace abn::harness
