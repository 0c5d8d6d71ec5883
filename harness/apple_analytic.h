// The procedural apple: a picture given by a formula, so that it can be evaluated at any position.
#pragma once

#include "harness/image.h"
#include "harness/integrand.h"

namespace abn::harness {

/// An apple with stalk and speckles on a checkerboard that runs to the horizon, ray traced at every position: an
/// integrand with no texel lattice behind it. Three channels, linear light, values in [0, 1].
///
/// Bit-reproducible: the arithmetic is + - * / sqrt and floor in double, which IEEE 754 rounds in one way only, in an
/// order fixed by the source (compile with -ffp-contract=off). No function of the mathematical library is called.
class AppleAnalytic final : public Integrand {
 public:
  /// The picture stretched over `plane` with square pixels: its width always spans the same field of view.
  explicit AppleAnalytic(Extent plane) : plane_(plane) {}

  /// Large batches use all OpenMP threads. Positions outside the plane see what the camera would see there.
  void evaluate(std::span<const Vec2f> position, std::span<float> values) const override;
  std::uint32_t channels() const override { return 3; }
  Extent plane() const override { return plane_; }

 private:
  Extent plane_;
};

/// AppleAnalytic at every texel centre.
Image render_apple_analytic(Extent size);

}  // namespace abn::harness
