#include "sampling/adaptive/ranked_plane.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <string>
#include <utility>

#include "sampling/adaptive/rank_order.h"
#include "sampling/disk_cache.h"
#include "sampling/error.h"
#include "sampling/hash.h"
#include "sampling/sph_blue_noise.h"

namespace abn {
namespace {

std::vector<Vec2f> make(Extent plane, std::uint64_t count, std::uint64_t seed, const RankedPlaneOptions& options,
                        const sph::SolverFactory& factory) {
  const std::vector<Vec2f> start = coarse_cell_positions(plane, count, seed, options.per_cell);
  sph::Setup setup;
  setup.plane = plane;
  setup.positions = start;
  setup.boundary = options.boundary;
  setup.seed = seed;
  const auto solver = factory ? factory(setup) : sph::make_cpu_solver(setup);
  solver->relax(options.iterations, false);
  const auto relaxed = solver->positions();
  std::vector<Vec2f> ranked;
  ranked.reserve(relaxed.size());
  for (const std::uint32_t i : farthest_first_order(relaxed, plane, seed)) ranked.push_back(relaxed[i]);
  return ranked;
}

/// What the method makes of a small plane: its bits change if the method does.
std::uint64_t fingerprint(const RankedPlaneOptions& options) {
  std::uint64_t sum = 0;
  for (const Vec2f p : make({12, 10}, 120, 1, options, nullptr)) {
    sum = mix64(sum ^ std::bit_cast<std::uint32_t>(p.x));
    sum = mix64(sum ^ std::bit_cast<std::uint32_t>(p.y));
  }
  return sum;
}

std::string key_of(Extent plane, std::uint64_t count, std::uint64_t seed, const RankedPlaneOptions& options) {
  return "ranked_plane 1: plane " + std::to_string(plane.width) + "x" + std::to_string(plane.height) + ", count " +
         std::to_string(count) + ", seed " + std::to_string(seed) + ", boundary " +
         (options.boundary == sph::Boundary::ghost ? "ghost" : "periodic") + ", iterations " +
         std::to_string(options.iterations) + ", per_cell " +
         std::to_string(std::bit_cast<std::uint64_t>(options.per_cell)) + ", method " +
         std::to_string(fingerprint(options));
}

/// Nothing is believed of a file but what can be checked.
bool plausible(const std::vector<Vec2f>& position, Extent plane, std::uint64_t count) {
  const auto width = static_cast<float>(plane.width);
  const auto height = static_cast<float>(plane.height);
  return position.size() == count && std::all_of(position.begin(), position.end(), [&](Vec2f p) {
           return p.x >= 0 && p.x < width && p.y >= 0 && p.y < height;
         });
}

}  // namespace

RankedPlane ranked_plane(Extent plane, std::uint64_t count, std::uint64_t seed, const RankedPlaneOptions& options,
                         bool use_cache, const sph::SolverFactory& solver) {
  if (count == 0 || count > 0xFFFFFFFEU) {
    throw ConfigError("budget: " + std::to_string(count) + " points cannot be ranked; give 1 to 4294967294");
  }
  RankedPlane ranked;
  const std::string key = use_cache && !solver ? key_of(plane, count, seed, options) : std::string();
  if (!key.empty()) {
    if (auto position = load_cached_values<Vec2f>(key); position && plausible(*position, plane, count)) {
      ranked.position = std::move(*position);
      ranked.cached = true;
      return ranked;
    }
  }
  ranked.position = make(plane, count, seed, options, solver);
  if (!key.empty()) store_cached_values<Vec2f>(key, ranked.position);
  return ranked;
}

}  // namespace abn
