// The interface between a strategy and an SPH engine, whatever it runs on.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "sampling/grid.h"
#include "sampling/vec.h"

namespace abn::sph {

/// How relax() went. Displacements are in mean spacings d = sqrt(area / N).
struct RelaxReport {
  int steps = 0;
  double mean_displacement = 0;  // of the free particles in the last step [d], with a size field [local spacing]
  double max_displacement = 0;   // likewise
  double mean_density = 0;       // before the last step, relative to N / area; 1 at equilibrium
  bool converged = false;        // mean displacement fell below Setup::tolerance
  std::uint64_t non_finite = 0;  // steps of a particle that were not finite and were dropped
};

/// Density and force of every particle, by id: what tests compare between engines.
struct Evaluation {
  std::vector<double> density;  // relative to N / area; thesis eq. 2.15
  std::vector<double> force_x;  // thesis eq. 2.16 before `step`, in units of the local spacing
  std::vector<double> force_y;
};

/// Everything an engine needs to start. Positions are copied.
struct Setup {
  Extent plane;                      // [px]; opposite sides are joined (torus)
  std::span<const Vec2f> positions;  // [px], inside the plane
  float support_radius = 2.0F;       // H [d]
  float stiffness_ratio = 0.3F;      // Delta = density difference of thesis eq. 2.18 relative to the mean density
  float step = 1.2F;                 // [d]
  float damping = 0.6F;              // share of the velocity that survives a step
  float velocity_cap = 0.3F;         // [d per step]
  float tolerance = 0.01F;           // converged when the mean displacement is below [d]
};

/// N particles on a torus. Ids are indices into Setup::positions, stable for life.
class Solver {
 public:
  virtual ~Solver() = default;
  /// Relative spacing s(x) > 0, bilinear between cell centres, periodic; only ratios count: normalised inside so that
  /// int s^-2 dA = area, and cut at sqrt(N) d (one particle on the whole plane). Throws ConfigError if a value is not
  /// finite and > 0.
  virtual void set_size_field(const Grid<float>& s) = 0;
  /// These particles stay in every density sum and move no more.
  virtual void freeze(std::span<const std::uint32_t> ids) = 0;
  /// At most `max_steps` steps, fewer if converged and `stop_early`.
  virtual RelaxReport relax(int max_steps, bool stop_early) = 0;
  /// At the current positions, without a step.
  virtual Evaluation evaluate() = 0;
  /// Current positions by id [px], inside the plane; valid until the next call. Synchronises a device, so timing is
  /// honest.
  virtual std::span<const Vec2f> positions() = 0;
  virtual const char* backend() const = 0;
};

using SolverFactory = std::function<std::unique_ptr<Solver>(const Setup&)>;

/// The reference engine in float, on all OpenMP threads; bit-identical for any number of them. All images of a particle
/// within reach interact (cells.h). Memory: at most 100 B per particle. Throws ConfigError for an empty plane, no
/// particles or more than 2^32-1, a position outside the plane, or a parameter out of range.
std::unique_ptr<Solver> make_cpu_solver(const Setup& setup);
/// The same in double: the difference to the float engine is its rounding.
std::unique_ptr<Solver> make_cpu_solver_double(const Setup& setup);

}  // namespace abn::sph
