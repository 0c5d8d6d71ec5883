#include "harness/point_source.h"

#include <fmt/format.h>

#include <chrono>
#include <optional>

#include "harness/backend.h"
#include "harness/run.h"
#include "sampling/density_warp.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

struct Prepared {
  Extent plane{1, 1};
  bool warped = false;
  ParameterWords parameters;
  std::string backend;
  std::unique_ptr<Sampler> sampler;
};

Prepared prepare(const PointTask& task) {
  Prepared prepared;
  ParameterWords words = task.parameters;
  const Strategy& strategy = find_strategy(task.strategy, words);
  prepared.parameters = strategy.resolve(words);
  if (strategy.info.adaptive || strategy.info.filter) {
    throw ConfigError(fmt::format("{}: its samples depend on {}; use abn downscale IMAGE --strategy {} --points FILE",
                                  strategy.info.name, strategy.info.adaptive ? "an image" : "pixels and a filter",
                                  strategy.info.name));
  }
  const Backend backend = resolve_backend(task.backend);
  prepared.backend = backend.name;
  SamplingTask sampling{
      .plane = {1, 1}, .budget = task.count, .seed = task.seed, .solver = backend.factory, .cache = task.cache};
  if (task.density && strategy.info.density) {
    // The plane of the density keeps its aspect; the unit square would squeeze the distances.
    sampling.plane = task.density->size();
    sampling.density = task.density;
  } else {
    prepared.warped = task.density != nullptr;
  }
  prepared.plane = sampling.plane;
  prepared.sampler = strategy.make(sampling, words);
  return prepared;
}

}  // namespace

void require_points(const PointTask& task) { static_cast<void>(prepare(task)); }

DrawnPoints draw_points(const PointTask& task, Progress* progress) {
  const auto begin = std::chrono::steady_clock::now();
  Prepared prepared = prepare(task);
  std::optional<DensityWarp> warp;
  if (prepared.warped) warp.emplace(*task.density);
  DrawnPoints drawn{.set = {},
                    .plane = prepared.plane,
                    .parameters = std::move(prepared.parameters),
                    .diagnostics = {},
                    .backend = std::move(prepared.backend)};
  const Grid<PixelStats> nothing({1, 1});  // strategies that are not adaptive never look at it
  PointSet& set = drawn.set;
  Sampler& sampler = *prepared.sampler;
  for (auto batch = next_batch(sampler, {nothing}); !batch.empty(); batch = next_batch(sampler, {nothing})) {
    stop_if_interrupted();
    set.position.insert(set.position.end(), batch.position.begin(), batch.position.end());
    set.weight.insert(set.weight.end(), batch.weight.begin(), batch.weight.end());
    if (progress != nullptr) progress->update(set.position.size());
  }
  if (warp) {
    for (auto& position : set.position) position = (*warp)(position);
  }
  drawn.diagnostics = sampler.diagnostics();
  drawn.ghosts.assign(sampler.ghosts().begin(), sampler.ghosts().end());
  drawn.generate_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return drawn;
}

}  // namespace abn::harness
