// The passes of an adaptive downscale without image and strategy: what tests and benchmarks of the planes run.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "sampling/adaptive/adaptive_plane.h"
#include "sampling/rng.h"
#include "sampling/vec.h"

namespace abn::sph_cuda {

/// A picture of three channels in [0,1]: a bright disc and a dark bar with sharp edges, on a slope with fine ripples in
/// one corner.
inline void shade(Vec2f at, Extent plane, float* rgb) {
  const float x = at.x / static_cast<float>(plane.width);
  const float y = at.y / static_cast<float>(plane.height);
  float light = 0.2F + 0.3F * x;
  if (x > 0.6F && y > 0.6F) light += 0.1F * std::sin(160 * x) * std::sin(140 * y);
  if (std::hypot(x - 0.35F, y - 0.4F) < 0.22F) light = 0.9F - 0.3F * y;
  if (std::abs(y - 0.3F * x - 0.7F) < 0.02F) light = 0.05F;
  rgb[0] = light;
  rgb[1] = light * (0.5F + 0.5F * y);
  rgb[2] = 1 - light;
}

inline std::vector<float> values_at(std::span<const Vec2f> position, Extent plane) {
  std::vector<float> value(3 * position.size());
  for (std::size_t i = 0; i < position.size(); ++i) shade(position[i], plane, value.data() + 3 * i);
  return value;
}

struct DownscaleStage {
  std::string name;
  double milliseconds = 0;
};

struct Downscale {
  std::vector<Vec2f> position;
  std::vector<float> value;  // [samples * 3]
  double uniform_share = 0, straight_edge_share = 0;
  std::vector<Vec2f> ghosts;
  std::vector<DownscaleStage> stages;  // evaluation is "evaluate"
};

/// A quarter of the budget, less what `base` has, by density in each of three passes, then two of refinement: what
/// sph_adaptive does by default where straight edges dominate. `base` [px]: spread evenly.
inline Downscale run_downscale(const AdaptivePlaneFactory& make, AdaptivePlaneOptions options,
                               std::span<const Vec2f> base, std::uint64_t budget) {
  Downscale run;
  auto last = std::chrono::steady_clock::now();
  const auto stage = [&](const std::string& name) {
    const auto now = std::chrono::steady_clock::now();
    run.stages.push_back({name, std::chrono::duration<double, std::milli>(now - last).count()});
    last = now;
  };
  options.most_samples = budget;
  const auto plane = make(options);
  stage("plane made");
  const auto take = [&](std::span<const Vec2f> position) {
    const std::vector<float> value = values_at(position, options.plane);
    stage("evaluate");
    plane->add(position, value, value, 3);
    run.position.insert(run.position.end(), position.begin(), position.end());
    run.value.insert(run.value.end(), value.begin(), value.end());
    stage("values added");
  };
  take(base);
  run.uniform_share = plane->uniform_share();
  stage("uniform share");
  const std::uint64_t refined = budget / 4;
  for (std::uint64_t k = 1; k <= 3; ++k) {
    DensityPass pass;
    pass.target = base.size() + (budget - refined - base.size()) * k / 3;
    pass.mean_density = static_cast<double>(budget) / static_cast<double>(options.plane.area());
    pass.seed = options.seed + k;
    const std::vector<Vec2f> fresh = plane->add_by_density(pass);
    stage("density pass");
    take(fresh);
  }
  run.straight_edge_share = plane->straight_edge_share();
  stage("straight edges");
  for (const std::uint64_t count : {refined / 2, refined - refined / 2}) {
    const std::vector<Vec2f> fresh = plane->refine(count, options.seed + run.position.size());
    stage("refinement");
    take(fresh);
  }
  const auto ring = plane->ghosts();
  run.ghosts.assign(ring.begin(), ring.end());
  return run;
}

/// Points of a jittered grid, about `count`: a base that needs no relaxation.
inline std::vector<Vec2f> jittered_base(Extent plane, std::uint64_t count, std::uint64_t seed) {
  const double side = std::sqrt(static_cast<double>(plane.area()) / static_cast<double>(count));
  const auto cells = [&](std::uint32_t length) {
    return std::max(1U, static_cast<std::uint32_t>(std::lround(length / side)));
  };
  const std::uint32_t columns = cells(plane.width);
  const std::uint32_t rows = cells(plane.height);
  std::vector<Vec2f> points;
  for (std::uint32_t i = 0; i < columns * rows; ++i) {
    const Vec2f u = Rng(seed, 7, i).uniform2();
    points.push_back(to_plane({(static_cast<float>(i % columns) + u.x) / static_cast<float>(columns),
                               (static_cast<float>(i / columns) + u.y) / static_cast<float>(rows)},
                              plane));
  }
  return points;
}

}  // namespace abn::sph_cuda
