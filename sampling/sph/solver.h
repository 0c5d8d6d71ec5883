// The interface between a strategy and an SPH engine, whatever it runs on.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "sampling/grid.h"
#include "sampling/sph/model.h"
#include "sampling/vec.h"

namespace abn::sph {

/// What surrounds the plane.
enum class Boundary : std::uint8_t {
  periodic,  // opposite sides are joined (torus)
  ghost,     // walls, with a ring of fixed ghost particles behind them
};

/// When a relaxation counts as converged: its displacement in the last step is below Setup::tolerance.
enum class Criterion : std::uint8_t {
  mean,   // on the average over the free particles
  every,  // for every free particle, the thesis' criterion: an extreme value that grows with N
};

/// How relax() went. Displacements are in mean spacings d = sqrt(area / N), with a size field in local spacings.
struct RelaxReport {
  int steps = 0;
  double mean_displacement = 0;  // of the free particles in the last step
  double max_displacement = 0;   // likewise
  double still = 0;              // share of the free particles that moved by less than the tolerance in the last step
  double mean_density = 0;      // before the last step, relative to N / area; 1 at equilibrium. An engine that does not
                                // need it (Delta infinite) may say 1
  bool converged = false;       // by Setup::criterion
  int mean_converged_at = -1;   // first step whose mean displacement was below the tolerance; -1 = none
  int every_converged_at = -1;  // first step in which every displacement was; -1 = none
  double step = 0;              // Setup::step as it was at the end
  int step_reductions = 0;      // how often it was reduced because the particles did not calm down
  std::uint64_t non_finite = 0;  // steps of a particle that were not finite and were dropped
};

/// Density and force of every particle, by id: what tests compare between engines.
struct Evaluation {
  std::vector<double> density;  // relative to N / area; thesis eq. 2.15
  std::vector<double>
      force_x;  // thesis eq. 2.16 less the background force, before `step`, in units of the local spacing
  std::vector<double> force_y;
};

/// Everything an engine needs to start. Positions, classes and the size field are copied.
struct Setup {
  Extent plane;                      // [px]
  std::span<const Vec2f> positions;  // [px], inside the plane
  std::span<const std::uint8_t> classes =
      {};                                   // of every particle; empty = one class. Classes are blue alone and together
  const Grid<float>* size_field = nullptr;  // start with this one as if by set_size_field(), but with a single ring
  Kernel kernel = Kernel::wendland;
  Boundary boundary = Boundary::periodic;
  float support_radius = 2.0F;   // H [d]
  float stiffness_ratio = 0.3F;  // Delta = density difference of thesis eq. 2.18 relative to the mean density;
                                 // infinite: the pressure is 1 everywhere and relax() sums no densities
  float step = 1.2F;             // [d]
  float damping = 0.6F;          // share of the velocity that survives a step
  float velocity_cap = 0.3F;     // [d per step]
  bool adaptive_step = true;     // at most 4 Delta (2.5 with classes), less while the particles do not calm down
  float tolerance = 0.01F;       // of the criterion [d]
  Criterion criterion = Criterion::mean;
  bool background = true;       // subtract the mean-field force of a size field, so that the density becomes s^-2
  float gradient_limit = 1.0F;  // largest |grad s| of a size field
  bool thesis_cells = false;    // only the twin: look only into 3x3 cells of H s_min, the thesis' mistake (fig. 2.3)
  std::uint64_t seed = 1;       // of the ghost ring
  int ghost_steps = 40;         // that relax the ghost ring before it is fixed
};

/// N particles. Ids are indices into Setup::positions, stable for life.
class Solver {
 public:
  virtual ~Solver() = default;
  /// Relative spacing s(x) > 0 at the raster's cell centres over the plane; only ratios count. Prepared as
  /// prepare_size_field() says; with ghosts, a new ring is made for it. Throws ConfigError if a value is not finite and
  /// > 0.
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
  /// The ring of ghost particles around the plane [px], empty if periodic; valid until the next call.
  virtual std::span<const Vec2f> ghosts() = 0;
  virtual const char* backend() const = 0;
};

using SolverFactory = std::function<std::unique_ptr<Solver>(const Setup&)>;

// Every maker throws ConfigError for an empty plane, no particles or more than 2^32-1, a position outside the plane, a
// parameter out of range, or classes beside ghosts. All images of a particle within reach interact (cells.h).

/// The engine to use: float, vectorised for the machine's best instruction set, on all OpenMP threads; bit-identical
/// for any number of them and for every instruction set. Memory: at most 100 B per particle beside the size field.
std::unique_ptr<Solver> make_cpu_solver(const Setup& setup);
/// The same for the instruction set that every processor has.
std::unique_ptr<Solver> make_cpu_solver_baseline(const Setup& setup);
/// The same in double: the difference to the float engine is its rounding.
std::unique_ptr<Solver> make_cpu_solver_double(const Setup& setup);
/// The twin of them all: all pairs and all images, in double, without cells, lanes or threads. O(N^2) per step.
std::unique_ptr<Solver> make_twin_solver(const Setup& setup);

}  // namespace abn::sph
