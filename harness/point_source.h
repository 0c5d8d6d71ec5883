// Point sets without an integrand: what `abn points`, `abn analyze` and point-set experiments draw.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "harness/progress.h"
#include "sampling/analysis/points.h"
#include "sampling/strategy.h"

namespace abn::harness {

struct PointTask {
  std::string strategy;       // as typed: a name, an alias, file:PATH, command:CMD
  ParameterWords parameters;  // overrides of its defaults
  std::uint64_t count = 0;
  std::uint64_t seed = 1;
  std::string backend = "auto";                          // auto | cpu | cuda
  std::shared_ptr<const Grid<float>> density = nullptr;  // null = uniform
  bool cache = true;                                     // stages may come from the disk cache
};

struct DrawnPoints {
  PointSet set;  // on `plane`
  Extent plane;  // the unit square as one pixel, or the cells of a density that the strategy itself looks at
  ParameterWords parameters;  // every one, defaults included
  std::vector<Diagnostic> diagnostics;
  std::string backend;
  double generate_s = 0;
  std::vector<Vec2f> ghosts = {};  // outside `plane` [px]; empty for most strategies
};

/// Draws the points. A density is placed by the strategy if it can (StrategyInfo::density), otherwise its uniform
/// points are warped by the inverse cumulative distribution. `progress`, if given, is told of every batch, one step per
/// point. Throws ConfigError, IoError, DeviceError, and Interrupted between batches.
DrawnPoints draw_points(const PointTask& task, Progress* progress = nullptr);

/// The sampler of a task, not run: throws what draw_points would throw before its first point.
void require_points(const PointTask& task);

}  // namespace abn::harness
