// What all engines have in common: the bookkeeping. An engine adds the storage of the particles and the steps.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sampling/sph/problem.h"
#include "sampling/sph/relax_control.h"
#include "sampling/sph/solver.h"

namespace abn::sph {

/// The state of a relaxation of `free` particles before its first step.
RelaxControl relax_control(const Setup& setup, bool classed, std::uint64_t free, int max_steps, bool stop_early);

class SteppingSolver : public Solver {
 public:
  void set_size_field(const Grid<float>& s) final;
  void freeze(std::span<const std::uint32_t> ids) final;
  RelaxReport relax(int max_steps, bool stop_early) final;
  std::span<const Vec2f> positions() final;
  std::span<const Vec2f> ghosts() final;

 protected:
  /// Validates, unless a problem is given. The derived constructor calls load(problem()).
  explicit SteppingSolver(const Setup& setup);
  SteppingSolver(const Setup& setup, Problem problem);

  /// Takes the particles over, at rest.
  virtual void load(const Problem& problem) = 0;
  /// Puts the particles where they are into another size field without the host's help, at rest, and leaves in
  /// `problem` what make_problem() would, but for the raster, and for positions their number. Returns false, and
  /// changes nothing, if it cannot.
  virtual bool reload(const Grid<float>& /*s*/, Problem& /*problem*/) { return false; }
  /// Steps of every particle that is not fixed, each with the length control.report.step, until control.done.
  virtual void run(RelaxControl& control) = 0;
  /// Writes the particles' positions by id [d], ghosts included.
  virtual void store(std::vector<double>& x, std::vector<double>& y) = 0;

  const Setup& setup() const { return setup_; }  // its spans are empty
  const Problem& problem() const { return problem_; }
  /// By id, ghosts included: 1 = moves no more. Empty = all free.
  const std::vector<std::uint8_t>& fixed() const { return fixed_; }

 private:
  void fix_ghosts();

  Setup setup_;
  Problem problem_;
  std::vector<std::uint8_t> fixed_;
  std::vector<Vec2f> positions_, ghosts_;  // [px]
};

}  // namespace abn::sph
