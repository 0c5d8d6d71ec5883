#include "sampling/relaxation_start.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "sampling/error.h"
#include "sampling/jitter.h"
#include "sampling/rng.h"
#include "sampling/sobol_owen.h"
#include "sampling/sph_blue_noise.h"

namespace abn {
namespace {

std::vector<Vec2f> all_of(Sampler&& sampler) {
  const Grid<PixelStats> nothing;
  std::vector<Vec2f> positions;
  for (;;) {
    const SampleBatch batch = sampler.next({nothing});
    if (batch.empty()) return positions;
    positions.insert(positions.end(), batch.position.begin(), batch.position.end());
  }
}

std::vector<Vec2f> first_positions(std::string_view start, const SamplingTask& task) {
  if (start == "sobol_owen") return all_of(SobolOwen(task, {.domain = "plane"}));
  if (start == "jitter") return all_of(JitterPlane(task, {}));
  if (start == "coarse_cells") return coarse_cell_positions(task.plane, task.budget, task.seed);
  assert(start == "white");
  std::vector<Vec2f> positions(task.budget);
  for (std::uint64_t i = 0; i < task.budget; ++i) {
    positions[i] = to_plane(Rng(task.seed, stream_id("relaxation white start"), i).uniform2(), task.plane);
  }
  return positions;
}

}  // namespace

float wrap_to_plane(double x, std::uint32_t length) {
  const double period = length;
  if (x < 0 || x >= period) x -= period * std::floor(x / period);
  const auto wrapped = static_cast<float>(x);
  // A little below 0 or below the period may round up to the period.
  return wrapped < static_cast<float>(length) ? wrapped : 0.0F;
}

void separate_coincident(std::vector<Vec2f>& positions, Extent plane, std::uint64_t seed) {
  const double spacing = std::sqrt(static_cast<double>(plane.area()) / static_cast<double>(positions.size()));
  const auto reach = [&](std::uint32_t length) {
    return std::max(1e-3 * spacing, 4.0 * double{std::numeric_limits<float>::epsilon()} * length);
  };
  const double reach_x = reach(plane.width);
  const double reach_y = reach(plane.height);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec2f unit = Rng(seed, stream_id("relaxation separation"), i).uniform2();
    positions[i] = {wrap_to_plane(double{positions[i].x} + reach_x * (2 * double{unit.x} - 1), plane.width),
                    wrap_to_plane(double{positions[i].y} + reach_y * (2 * double{unit.y} - 1), plane.height)};
  }
}

std::vector<Vec2f> relaxation_start(std::string_view start, Extent plane, std::uint64_t count, std::uint64_t seed) {
  std::vector<Vec2f> positions = first_positions(start, {.plane = plane, .budget = count, .seed = seed});
  separate_coincident(positions, plane, seed);
  return positions;
}

void require_budget(std::string_view strategy, std::uint64_t budget, std::uint64_t most) {
  if (budget >= 1 && budget <= most) return;
  throw ConfigError(std::string(strategy) + ": budget " + std::to_string(budget) + " is not possible; ask for 1 to " +
                    std::to_string(most) + " samples");
}

}  // namespace abn
