// The error of integrals estimated with a point set, relative to independent points.
//
// A small minimum distance says little about integration: Poisson-disk sets keep a tenth of white noise at low
// frequencies and integrate three times worse than blue-noise sets that do not. This measures it directly.
#pragma once

#include "sampling/analysis/points.h"

namespace abn::analysis {

/// For each class, the root of (sum of squared errors over 400 random integrands / the sum that independent points have
/// on average): 1 for white noise, give or take some per cent (errors of the integrands are correlated in one set).
struct IntegrationError {
  double half_planes = 0;  // edges: half-planes through a random point at a random angle, cut by the square
  double gaussians = 0;    // smooth: Gaussians at a random centre, sigma uniform in [0.05, 0.25], cut by the square
  double discs = 0;        // edges without the square's: discs on the torus, radius uniform in [0.05, 0.4]
};

/// Measures `points`, shifted at random on the torus for each integrand. Integrands and shifts are the same for every
/// set: differences between sets are not theirs. Throws ConfigError for an empty set.
IntegrationError integration_error(Points points);

}  // namespace abn::analysis
