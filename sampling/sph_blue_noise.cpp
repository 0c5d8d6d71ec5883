#include "sampling/sph_blue_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn {
namespace {

constexpr std::size_t batch_size = std::size_t{1} << 20;

std::vector<Vec2f> white_start(Extent plane, std::uint64_t count, std::uint64_t seed) {
  std::vector<Vec2f> positions(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    positions[i] = to_plane(Rng(seed, stream_id("sph_blue_noise white"), i).uniform2(), plane);
  }
  return positions;
}

/// Stable counting sort by floor of one coordinate.
std::vector<Vec2f> sorted_by(const std::vector<Vec2f>& points, float Vec2f::*coordinate, std::uint32_t length) {
  std::vector<std::uint64_t> next(std::size_t{length} + 1, 0);
  for (const Vec2f p : points) ++next[static_cast<std::size_t>(p.*coordinate) + 1];
  for (std::size_t k = 1; k < next.size(); ++k) next[k] += next[k - 1];
  std::vector<Vec2f> sorted(points.size());
  for (const Vec2f p : points) sorted[next[static_cast<std::size_t>(p.*coordinate)]++] = p;
  return sorted;
}

}  // namespace

std::vector<Vec2f> coarse_cell_positions(Extent plane, std::uint64_t count, std::uint64_t seed, double per_cell) {
  const double cells = std::max(1.0, static_cast<double>(count) / per_cell);
  // The shorter side first: on a thin plane it gets one cell and the longer side all the others.
  const auto shorter = std::min(plane.width, plane.height);
  const auto longer = std::max(plane.width, plane.height);
  const double across = std::max(1.0, std::round(std::sqrt(cells * shorter / longer)));
  const double along = std::max(1.0, std::round(cells / across));
  const bool wide = plane.width >= plane.height;
  const auto columns = static_cast<std::uint64_t>(wide ? along : across);
  const auto rows = static_cast<std::uint64_t>(wide ? across : along);

  const double cell_width = static_cast<double>(plane.width) / static_cast<double>(columns);
  const double cell_height = static_cast<double>(plane.height) / static_cast<double>(rows);
  const float right = just_below(static_cast<float>(plane.width));
  const float bottom = just_below(static_cast<float>(plane.height));
  std::vector<Vec2f> positions;
  positions.reserve(count);
  // count * (visited + 1) / total without overflow: whole part and remainder of the mean count, apart.
  const std::uint64_t total = columns * rows;
  const std::uint64_t whole = count / total;
  const std::uint64_t rest = count % total;
  std::uint64_t visited = 0;
  for (std::uint64_t row = 0; row < rows; ++row) {
    for (std::uint64_t k = 0; k < columns; ++k, ++visited) {
      const std::uint64_t column = row % 2 == 0 ? k : columns - 1 - k;
      std::uint64_t here = whole + rest * (visited + 1) / total - rest * visited / total;
      for (; here > 0; --here) {
        const Vec2f unit = Rng(seed, stream_id("sph_blue_noise coarse cells"), positions.size()).uniform2();
        const double x = (static_cast<double>(column) + double{unit.x}) * cell_width;
        const double y = (static_cast<double>(row) + double{unit.y}) * cell_height;
        positions.push_back({std::min(static_cast<float>(x), right), std::min(static_cast<float>(y), bottom)});
      }
    }
  }
  return positions;
}

const StrategyInfo SphBlueNoise::info = {
    .name = "sph_blue_noise",
    .family = "blue noise",
    .summary = "Particles that repel each other like a fluid, relaxed together over the whole plane.",
    .cite = "Jiang et al. 2015, Blue noise sampling using an SPH-based method; Russell 2017 (thesis), 2.5 and 2.6",
    .advice = "The best plain choice where neither axis nor scale of the image is special; the start of sph_adaptive.",
};

std::vector<Field<SphBlueNoise::Params>> SphBlueNoise::fields() {
  using P = Params;
  return {
      {"delta", &P::delta, "density difference relative to the mean density: smaller is stiffer", 0.01, 1e6},
      {"support_radius", &P::support_radius, "support radius of the kernel [spacings]", 1.0, 8.0},
      {"step", &P::step, "force times this is added to the velocity; above 2 unstable [spacings]", 0.0, 10.0},
      {"damping", &P::damping, "share of the velocity that survives an iteration", 0.0, 0.99},
      {"velocity_cap", &P::velocity_cap, "largest move in an iteration [spacings]", 1e-6, 10.0},
      {"iterations", &P::iterations, "iterations, at most", 0, 1000000},
      {"tolerance", &P::tolerance, "stop early when the mean move is below [spacings]; 0 = never stop early", 0.0, 1.0},
      {"start",
       &P::start,
       "first positions: white inside coarse cells of 16, or white",
       0,
       0,
       {"coarse_cells", "white"}},
  };
}

SphBlueNoise::SphBlueNoise(const SamplingTask& task, const Params& params) : task_(task), params_(params) {
  if (task.budget < 1 || task.budget > std::numeric_limits<std::uint32_t>::max()) {
    throw ConfigError("sph_blue_noise: budget " + std::to_string(task.budget) +
                      " is not possible; ask for 1 to 4294967295 samples");
  }
}

void SphBlueNoise::relax() {
  const std::vector<Vec2f> start = params_.start == "white"
                                       ? white_start(task_.plane, task_.budget, task_.seed)
                                       : coarse_cell_positions(task_.plane, task_.budget, task_.seed);
  sph::Setup setup;
  setup.plane = task_.plane;
  setup.positions = start;
  setup.support_radius = static_cast<float>(params_.support_radius);
  setup.stiffness_ratio = static_cast<float>(params_.delta);
  setup.step = static_cast<float>(params_.step);
  setup.damping = static_cast<float>(params_.damping);
  setup.velocity_cap = static_cast<float>(params_.velocity_cap);
  if (params_.tolerance > 0) setup.tolerance = static_cast<float>(params_.tolerance);
  const std::unique_ptr<sph::Solver> solver = task_.solver ? task_.solver(setup) : sph::make_cpu_solver(setup);
  report_ = solver->relax(params_.iterations, params_.tolerance > 0);
  backend_ = solver->backend();
  const auto relaxed = solver->positions();
  samples_.assign(relaxed.begin(), relaxed.end());
  // By pixel, row by row: image reads then walk through memory in order.
  samples_ = sorted_by(samples_, &Vec2f::x, task_.plane.width);
  samples_ = sorted_by(samples_, &Vec2f::y, task_.plane.height);
}

SampleBatch SphBlueNoise::next(const Feedback&) {
  if (samples_.empty()) relax();
  const std::size_t begin = emitted_;
  const std::size_t count = std::min(batch_size, samples_.size() - begin);
  emitted_ += count;
  return {.position = std::span<const Vec2f>(samples_).subspan(begin, count)};
}

std::vector<Diagnostic> SphBlueNoise::diagnostics() const {
  if (samples_.empty()) return {};
  Diagnostic dropped{"non_finite", static_cast<double>(report_.non_finite)};
  if (report_.non_finite > 0) {
    dropped.text = "steps of particles were not finite and were dropped; a larger delta or a smaller step is stable";
    dropped.warning = true;
  }
  Diagnostic moving{"mean_displacement", report_.mean_displacement};
  if (report_.steps >= 10 && report_.mean_displacement > 0.1) {
    moving.text = "the particles still move by more than a tenth of a spacing; a smaller step or damping is stable";
    moving.warning = true;
  }
  return {
      {"iterations", static_cast<double>(report_.steps)},
      moving,
      {"max_displacement", report_.max_displacement},
      {"mean_density", report_.mean_density},
      {"converged", report_.converged ? 1.0 : 0.0},
      dropped,
      {"backend", 0, backend_},
  };
}

}  // namespace abn
