// abn scene and abn truth: pictures that need no strategy.
#include <fmt/format.h>

#include "harness/image_io.h"
#include "harness/output.h"
#include "harness/progress.h"
#include "harness/record.h"
#include "harness/run.h"
#include "harness/scenes.h"
#include "harness/verbs.h"

namespace abn::harness {
namespace {

/// Linear formats keep what is there; display formats get high dynamic range tone-mapped, so that it can be seen.
void save_for_people(const std::string& path, const Image& image, bool high_dynamic_range, bool quiet) {
  if (high_dynamic_range && !is_linear_format(path) && !quiet) {
    fmt::print(stderr, "abn: {}: high dynamic range is shown tone-mapped, x/(1+x); use .exr to keep the values\n",
               path);
  }
  write_picture(path, image, high_dynamic_range);
}

void report(const GlobalOptions& global, const std::string& name, const Image& image, const std::string& path,
            Json extra) {
  Json json = {{"name", name},
               {"width", image.size.width},
               {"height", image.size.height},
               {"channels", image.channels},
               {"hash", pixel_hash(image)},
               {"file", path}};
  json.update(extra);
  if (global.json) {
    fmt::print("{}\n", json.dump());
  } else if (!global.quiet) {
    fmt::print("wrote {} ({}x{}, {} channel{}, pixel hash {})\n", path, image.size.width, image.size.height,
               image.channels, image.channels == 1 ? "" : "s", pixel_hash(image));
  }
}

}  // namespace

int scene(const GlobalOptions& global, const SceneOptions& options) {
  const Scene& row = find_scene(options.name.starts_with("scene:") ? options.name.substr(6) : options.name);
  require_writable_image(options.output);
  Progress progress("scene " + row.name, 0, global.quiet);
  progress.update(0, "rendering");
  const Image image = render_scene(row, {options.size, options.size});
  progress.clear();
  stop_if_interrupted();
  save_for_people(options.output, image, row.high_dynamic_range, global.quiet);
  report(global, row.name, image, options.output, Json::object());
  return 0;
}

int truth(const GlobalOptions& global, const TruthOptions& options) {
  require_writable_image(options.output);
  Progress progress("truth of " + options.image, 0, global.quiet);
  progress.update(0);
  const auto subject = load_subject({.scene = options.image,
                                     .to = parse_extent(options.to, "--to"),
                                     .integrand = options.integrand,
                                     .truth = options.method,
                                     .filter = options.filter,
                                     .channels = options.channels,
                                     .on_nonfinite = options.on_nonfinite});
  progress.clear();
  stop_if_interrupted();
  if (!global.quiet) {
    for (const auto& notice : subject->notices) fmt::print(stderr, "abn: {}: {}\n", options.image, notice);
  }
  save_for_people(options.output, subject->truth.image, subject->high_dynamic_range, global.quiet);
  Json extra = {{"method", subject->truth.method}, {"filter", options.filter}, {"input_hash", subject->source_hash}};
  if (!subject->truth.standard_error.texels.empty()) {
    extra["standard_error_rms"] = standard_error_rms(subject->truth);
    if (!global.json && !global.quiet)
      fmt::print("standard error, root mean square over pixels: {:.6g}\n", extra["standard_error_rms"].get<double>());
  }
  report(global, options.image, subject->truth.image, options.output, extra);
  return 0;
}

}  // namespace abn::harness
