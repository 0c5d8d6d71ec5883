// What the passes of an adaptive plane compute, wherever that runs: the samples seen so far, and where the next belong.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "sampling/grid.h"
#include "sampling/sph/solver.h"
#include "sampling/vec.h"

namespace abn {

/// What the density of an adaptive plane follows.
enum class Driver : std::uint8_t { variance, gradient, luminance, guide };

struct AdaptivePlaneOptions {
  Extent plane;                    // [px]
  Extent map;                      // cells of the maps over it
  std::uint64_t most_samples = 0;  // there will never be more
  Driver driver = Driver::variance;
  std::shared_ptr<const Grid<float>> guide = nullptr;  // for Driver::guide, of any size
  bool both_lights = false;  // the driver is mixed of that of the values and that of the linear light
  double light_share = 0;    // of the latter
  double exponent = 0.5;     // density grows with driver^exponent
  double floor = 0;          // added to the driver, relative to its mean
  double most_ratio = 16;    // largest density, relative to the mean
  int neighbours = 8;        // samples that a local variance is taken of
  int blur = 1;              // 1-2-1 passes over the driver
  sph::Boundary boundary = sph::Boundary::ghost;
  float delta = 0.3F;  // Setup::stiffness_ratio of a pass
  int iterations = 5;  // of a pass
  double refine_activity = 0;
  std::uint64_t seed = 1;
};

/// A pass that adds samples by density.
struct DensityPass {
  std::uint64_t target = 0;  // samples there shall be afterwards
  double mean_density = 0;   // [1/px^2], what AdaptivePlaneOptions::most_ratio is relative to
  bool even = false;         // density follows nothing: the target is uniform
  std::uint64_t seed = 1;
};

/// Samples are known by the order in which they were added.
class AdaptivePlane {
 public:
  virtual ~AdaptivePlane() = default;
  /// Takes over samples that have been evaluated and stay where they are: position [n] [px], inside the plane; value
  /// [n * channels], finite; light likewise, looked at with both_lights. The first ones are taken to be spread evenly.
  virtual void add(std::span<const Vec2f> position, std::span<const float> value, std::span<const float> light,
                   std::uint32_t channels) = 0;
  /// The driver map, by all samples so far.
  virtual Grid<float> driver() = 0;
  /// uniform_share() of the driver map.
  virtual double uniform_share() = 0;
  /// Where pass.target samples less those there are belong: drawn where density is missing, relaxed around the samples
  /// there are. Precondition: target is above the number of samples.
  virtual std::vector<Vec2f> add_by_density(const DensityPass& pass) = 0;
  /// gabriel_midpoints() of all samples so far.
  virtual std::vector<Vec2f> refine(std::size_t count, std::uint64_t seed) = 0;
  /// straight_edge_share() of all samples so far.
  virtual double straight_edge_share() = 0;
  /// The ring of ghosts of the last add_by_density() [px].
  virtual std::span<const Vec2f> ghosts() const = 0;
  /// What the last add_by_density() ran on; "" before.
  virtual const char* backend() const = 0;
};

using AdaptivePlaneFactory = std::function<std::unique_ptr<AdaptivePlane>(const AdaptivePlaneOptions&)>;

/// On the CPU, but for the relaxation, which is the solver's; null = CPU too.
std::unique_ptr<AdaptivePlane> make_adaptive_plane(const AdaptivePlaneOptions& options,
                                                   const sph::SolverFactory& solver = nullptr);

/// The driver map for anything but Driver::variance, without blur; value [n * channels].
Grid<float> driver_without_search(const AdaptivePlaneOptions& options, std::span<const Vec2f> position,
                                  std::span<const float> value, std::uint32_t channels);

/// How the particles of a pass are relaxed; without positions and size field.
sph::Setup setup_of_pass(const AdaptivePlaneOptions& options);

}  // namespace abn
