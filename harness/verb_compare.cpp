// abn compare: metrics between two image files.
#include <fmt/format.h>

#include <cmath>

#include "harness/image_io.h"
#include "harness/metrics.h"
#include "harness/output.h"
#include "harness/progress.h"
#include "harness/record.h"
#include "harness/verbs.h"
#include "sampling/error.h"

namespace abn::harness {

int compare(const GlobalOptions& global, const CompareOptions& options) {
  std::vector<const Metric*> chosen;
  for (const auto& name : options.metrics) chosen.push_back(&find_metric(name));
  if (chosen.empty()) {
    for (const auto& metric : metrics()) chosen.push_back(&metric);
  }
  if (!options.error_map.empty()) require_writable_image(options.error_map);
  const LoadOptions load{.channels = options.channels, .on_nonfinite = parse_on_nonfinite(options.on_nonfinite)};
  const LoadedImage test = load_image(options.test, load);
  const LoadedImage reference = load_image(options.reference, load);
  if (!global.quiet) {
    for (const auto& notice : test.notices) fmt::print(stderr, "abn: {}: {}\n", options.test, notice);
    for (const auto& notice : reference.notices) fmt::print(stderr, "abn: {}: {}\n", options.reference, notice);
  }
  const MetricInput input{test.image, reference.image, test.floating_point || reference.floating_point};
  Json scores = Json::object();
  double first = 0;
  Progress progress("compare", chosen.size(), global.quiet);
  std::size_t done = 0;
  for (const Metric* metric : chosen) {
    progress.update(done++, metric->name);
    const double score = metric->score(input);
    if (metric == chosen.front()) first = score;
    scores[metric->name] = std::isfinite(score) ? Json(score) : Json(nullptr);
  }
  progress.clear();
  stop_if_interrupted();
  const WorstPixel worst = worst_pixel(test.image, reference.image);
  if (!options.error_map.empty()) write_error_map(options.error_map, test.image, reference.image, options.gain);

  // Worse = larger where small is good (in magnitude, for bias), smaller where large is good; an undefined score fails.
  const bool failed =
      options.fail && !(chosen.front()->smaller_is_better ? std::abs(first) <= *options.fail : first >= *options.fail);
  if (global.json) {
    const Json worst_json = {{"x", worst.x},
                             {"y", worst.y},
                             {"channel", worst.channel},
                             {"difference", std::isfinite(worst.difference) ? Json(worst.difference) : Json(nullptr)}};
    fmt::print(
        "{}\n",
        Json({{"test", options.test}, {"reference", options.reference}, {"scores", scores}, {"worst", worst_json}})
            .dump());
  } else {
    for (const Metric* metric : chosen) {
      const Json& score = scores[metric->name];
      fmt::print("{:<16} {:>12}  {}\n", metric->name,
                 score.is_null() ? "–" : fmt::format("{:.6g}", score.get<double>()), metric->summary);
    }
    fmt::print("worst            {:>12.6g}  at x {}, y {}, channel {}\n", worst.difference, worst.x, worst.y,
               worst.channel);
    if (!options.error_map.empty()) fmt::print("wrote {}\n", options.error_map);
  }
  if (failed)
    fmt::print(stderr, "abn: {} is {:.6g}, worse than --fail {:g}\n", chosen.front()->name, first, *options.fail);
  return failed ? 1 : 0;
}

}  // namespace abn::harness
