// How much of what is left to gain lies at straight edges.
#pragma once

#include <cstdint>
#include <span>

#include "sampling/vec.h"

namespace abn {

/// The share of sum V n^-1.5 (the error that n blue samples leave in a pixel of variance V, up to a constant) that
/// comes from pixels crossed by one straight edge; in [0,1], 0 if nothing varies.
///
/// A pixel counts as crossed if it has at least 10 samples, two classes by a threshold explain at least 92 % of their
/// variance (Otsu 1979), each class has 3 samples or more, and Fisher's discriminant (1936) separates them up to .05
/// px. `position` [px], inside the plane; `value` [n * channels], finite; channels are averaged.
double straight_edge_share(std::span<const Vec2f> position, std::span<const float> value, std::uint32_t channels,
                           Extent plane);

}  // namespace abn
