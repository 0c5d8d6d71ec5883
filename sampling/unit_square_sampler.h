// What the strategies have in common that know how to put n points into a unit square: one set for the whole plane or
// one per pixel, the exact budget, batches, threads.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sampling/params.h"
#include "sampling/rng.h"
#include "sampling/sampler.h"

namespace abn {

/// A point of the unit square in 32-bit fixed point, (x, y) * 2^-32: strata of an integer construction stay exact,
/// where a float would round a point across a border.
struct UnitPoint {
  std::uint32_t x, y;
};

/// (k + u * 2^-32) / n: the place of offset u inside stratum k of n; k < n <= 2^31. Rounded down, except that the
/// result is never below the stratum.
constexpr std::uint32_t stratum_place(std::uint64_t k, std::uint32_t u, std::uint64_t n) {
  const std::uint64_t place = ((k << 32) | u) / n;
  return static_cast<std::uint32_t>(place + (place * n < k << 32 ? 1 : 0));
}

/// Numbers of equal strata along the axes whose borders rounding to float must respect; 0 = no matter.
struct Strata {
  std::uint64_t x = 0;
  std::uint64_t y = 0;
};

/// Points [first, first + out.size()) of the independent uniform points named by a key: the offsets inside strata, or
/// the samples themselves. Point i is the words 0, 1 (i even) or 2, 3 (i odd) of Philox block i / 2.
void random_points(std::uint64_t key, std::uint64_t first, std::span<UnitPoint> out);

/// Whether a strategy makes one point set for every pixel or a single one for the whole plane.
enum class Domain { pixel, plane };

inline Domain domain_of(const std::string& word) { return word == "pixel" ? Domain::pixel : Domain::plane; }

/// The `domain` parameter of a strategy that offers both.
template <class P>
Field<P> domain_field() {
  Field<P> field{"domain", &P::domain, "one point set per pixel, or one for the whole plane"};
  field.choices = {"pixel", "plane"};
  return field;
}

/// Emits the budget from sets of points in the unit square.
///
/// Plane: one set of `budget` points, stretched over the plane. Pixel: every pixel gets a set of its own with
/// floor(budget / pixels) points, and budget % pixels pixels, a pseudo-random choice that depends on the seed only,
/// get one more (so strategies compared under one seed agree about them); pixels follow row by row.
/// Batches hold at most 2^20 samples whatever the budget. Positions are rounded down to float, so that no point leaves
/// its pixel and none a stratum whose border is a float; borders that are none (thirds) are respected by rounding up
/// where a strategy names its strata and a float lies inside.
class UnitSquareSampler : public Sampler {
 public:
  SampleBatch next(const Feedback& seen) final;

 protected:
  /// `name` separates the random numbers of strategies. Throws ConfigError for an empty task or sets over 2^31 points.
  UnitSquareSampler(const SamplingTask& task, const std::string& name, Domain domain);

  /// Points [first, first + out.size()) of the set of n points named by `key`: a pure function, called from many
  /// threads at once. n is smaller_set() or one more.
  virtual void points(std::uint64_t key, std::uint64_t first, std::uint64_t n, std::span<UnitPoint> out) const = 0;

  /// Strata of the sets of n points to be respected; powers of two are without being named.
  virtual Strata strata(std::uint64_t) const { return {}; }

  /// Whether every second pixel, like the black squares of a chessboard, gets its set with x and y exchanged. For sets
  /// of a x b cells with a < b: without it the picture's orientation decides (apple at 6 spp, jitter: RMSE .0242 with
  /// 2 x 3 cells in every pixel, .0269 alternating).
  virtual bool alternates_axes() const { return false; }

  /// Points of the smaller of the (at most two) sizes of set; may be 0.
  std::uint64_t smaller_set() const { return per_set_; }

 private:
  std::uint64_t set_size(std::uint64_t set) const;
  void emit(std::uint64_t set, std::uint64_t first, std::uint64_t n, std::span<Vec2f> out) const;
  void emit_part_of_set();
  void emit_whole_sets();

  Extent plane_;
  std::uint64_t budget_;
  std::uint64_t seed_;
  std::uint32_t stream_;
  Domain domain_;
  std::uint64_t sets_;       // pixels, or 1
  std::uint64_t per_set_;    // budget / sets
  std::uint64_t remainder_;  // budget % sets: so many sets have one point more
  std::uint64_t emitted_ = 0;
  std::uint64_t set_ = 0;    // the next set to emit from ...
  std::uint64_t first_ = 0;  // ... and its next point
  std::vector<Vec2f> positions_;
  std::vector<std::uint32_t> starts_;  // of the sets of one batch in positions_
};

}  // namespace abn
