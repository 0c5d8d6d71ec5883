#include "sampling/poisson_disk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <span>
#include <string>

#include "sampling/disk_grid.h"
#include "sampling/error.h"
#include "sampling/rng.h"

namespace abn {
namespace {

constexpr std::size_t max_batch = 1U << 20;
constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();
// Below this share of the reference radius only the resolution of float positions can be what keeps points apart.
constexpr double lowest_radius = 0.25;
// Where a full run gives a little less than the budget; measured with 30 candidates, see poisson_disk_test.cpp.
constexpr double first_radius = 0.7325;

/// A position on the axis of the torus, in [0, length) as a float [px].
float wrap(double position, double length) {
  if (position < 0 || position >= length) position -= length * std::floor(position / length);
  const auto rounded = static_cast<float>(position);
  return rounded < static_cast<float>(length) ? rounded : 0.0F;
}

/// Random displacements of the ring between radius 1 and 2, uniform by area. Nearly all of the method's random numbers
/// are these: made a block at a time they cost 40 % of the same numbers from Rng one by one, and rejection instead of
/// sines gives the same bits on every processor. Draws from streams of its own.
class RingSampler {
 public:
  RingSampler(std::uint64_t seed, std::uint32_t run) : seed_(seed), run_(run) {}

  Vec2f next() {
    while (used_ == ready_) refill();
    return displacement_[used_++];
  }

 private:
  static constexpr std::uint32_t blocks = 256;

  void refill() {
    const auto key0 = static_cast<std::uint32_t>(seed_);
    const auto key1 = static_cast<std::uint32_t>(seed_ >> 32);
    std::array<std::uint32_t, 2 * blocks> x_bits;
    std::array<std::uint32_t, 2 * blocks> y_bits;
#pragma omp simd
    for (std::uint32_t i = 0; i < blocks; ++i) {
      const std::uint64_t block = first_block_ + i;
      const Philox4 random = philox4x32({{run_, static_cast<std::uint32_t>(block >> 32), stream_id("poisson_disk ring"),
                                          static_cast<std::uint32_t>(block)}},
                                        key0, key1);
      x_bits[i] = random.word[0];
      y_bits[i] = random.word[1];
      x_bits[i + blocks] = random.word[2];
      y_bits[i + blocks] = random.word[3];
    }
    first_block_ += blocks;
    used_ = 0;
    ready_ = 0;
    for (std::uint32_t i = 0; i < 2 * blocks; ++i) {
      const float x = 4.0F * unit_float(x_bits[i]) - 2.0F;
      const float y = 4.0F * unit_float(y_bits[i]) - 2.0F;
      const float squared = x * x + y * y;
      displacement_[ready_] = {x, y};
      ready_ += static_cast<std::uint32_t>(squared >= 1.0F) & static_cast<std::uint32_t>(squared <= 4.0F);
    }
  }

  std::uint64_t seed_;
  std::uint32_t run_;
  std::uint64_t first_block_ = 0;
  std::uint32_t ready_ = 0;
  std::uint32_t used_ = 0;
  std::array<Vec2f, 2 * blocks> displacement_{};
};

/// A run of the method: its grid and its random numbers.
struct Run {
  Extent plane;
  int candidates;
  Rng rng;
  RingSampler ring;
  DiskGrid grid;

  /// Starts from one random point, no two to be closer than `radius` [px].
  Run(const SamplingTask& task, int tries, double radius, std::uint32_t number)
      : plane(task.plane),
        candidates(tries),
        rng(task.seed, stream_id("poisson_disk"), number),
        ring(task.seed, number),
        grid(plane, radius) {
    add_anywhere();
  }

  void add_anywhere() {
    const float x = uniform_position(rng, plane.width);
    grid.try_add({x, uniform_position(rng, plane.height)});
  }

  /// Bridson's loop with every point active, until none is or there are `limit` points.
  void fill(std::size_t limit) {
    std::vector<std::uint32_t> active(grid.points().size());
    std::iota(active.begin(), active.end(), 0U);
    while (!active.empty() && grid.points().size() < limit) {
      const std::uint32_t slot = rng.below(static_cast<std::uint32_t>(active.size()));
      const Vec2f centre = grid.points()[active[slot]];
      bool added = false;
      for (int k = 0; k < candidates && !added; ++k) {
        const Vec2f step = ring.next();
        added = grid.try_add(
            {wrap(static_cast<double>(centre.x) + grid.radius() * static_cast<double>(step.x), plane.width),
             wrap(static_cast<double>(centre.y) + grid.radius() * static_cast<double>(step.y), plane.height)});
      }
      if (added) {
        active.push_back(static_cast<std::uint32_t>(grid.points().size() - 1));
      } else {
        active[slot] = active.back();
        active.pop_back();
      }
    }
  }
};

/// Keeps `count` points, each subset with equal chance.
void remove_at_random(std::vector<Vec2f>& points, std::size_t count, std::uint64_t seed) {
  Rng rng(seed, stream_id("poisson_disk removal"));
  for (std::size_t size = points.size(); size > count; --size) {
    points[rng.below(static_cast<std::uint32_t>(size))] = points[size - 1];
  }
  points.resize(count);
}

}  // namespace

const StrategyInfo PoissonDisk::info = {
    .name = "poisson_disk",
    .family = "blue noise",
    .summary = "Bridson's Poisson disk on the torus: random, but no two samples closer than a radius",
    .cite = "Bridson 2007, Fast Poisson disk sampling in arbitrary dimensions",
    .advice = "fast blue noise for edges and textures; sph_blue_noise has less low-frequency noise",
};

std::vector<Field<PoissonDisk::Params>> PoissonDisk::fields() {
  return {
      {"radius", &Params::radius,
       "distance aimed at [densest packing's]; 0: the largest the count allows; surplus samples are removed at random",
       0, 0.9},
      {"candidates", &Params::candidates, "tries around a sample before it retires", 1, 10000},
  };
}

PoissonDisk::PoissonDisk(const SamplingTask& task, const Params& params) : task_(task), params_(params) {
  if (params.radius > 0 && params.radius < 0.3) {
    throw ConfigError("parameter 'radius' of poisson_disk is '" + std::to_string(params.radius) +
                      "', too small to matter; give 0 (largest possible) or a number in [0.3, 0.9]");
  }
  if (task.budget > max_disk_points) {
    throw ConfigError("poisson_disk holds all its points in memory: " + std::to_string(task.budget) +
                      " samples are too many; give at most " + std::to_string(max_disk_points) + " with --samples");
  }
}

void PoissonDisk::generate() {
  const auto budget = static_cast<std::size_t>(task_.budget);
  const double reference = reference_radius(task_.plane, budget);
  const bool automatic = params_.radius == 0;

  double radius = (automatic ? first_radius : params_.radius) * reference;
  const std::size_t limit = automatic ? budget + 1 : unlimited;
  std::uint32_t number = 0;
  auto run = std::make_unique<Run>(task_, params_.candidates, radius, number);
  run->fill(limit);
  while (automatic && run->grid.points().size() > budget) {
    radius *= 1.02;
    run = std::make_unique<Run>(task_, params_.candidates, radius, ++number);
    run->fill(limit);
  }
  DiskGrid& grid = run->grid;
  while (grid.points().size() < budget) {
    const double lower = 0.99 * grid.radius();
    if (lower >= lowest_radius * reference) {
      grid.lower_radius(lower);
      run->fill(budget);
    } else {
      grid.lower_radius(0);
      while (grid.points().size() < budget) run->add_anywhere();
    }
  }
  radius_ = grid.radius();
  points_ = grid.take_points();
  removed_ = points_.size() - budget;
  remove_at_random(points_, budget, task_.seed);
}

SampleBatch PoissonDisk::next(const Feedback&) {
  if (points_.empty() && task_.budget > 0) generate();
  const auto rest = std::span<const Vec2f>(points_).subspan(emitted_);
  const auto batch = rest.first(std::min(rest.size(), max_batch));
  emitted_ += batch.size();
  return {.position = batch};
}

std::vector<Diagnostic> PoissonDisk::diagnostics() const {
  if (points_.empty()) return {};
  std::vector<Diagnostic> list = {
      {"relative_radius", radius_ / reference_radius(task_.plane, task_.budget)},
      {"min_distance", radius_},
      {"removed", static_cast<double>(removed_)},
  };
  if (radius_ == 0) {
    list.push_back(
        {"distance_lost", 1, "the plane's float positions are too coarse to keep so many points apart", true});
  }
  return list;
}

}  // namespace abn
