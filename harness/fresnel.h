// Fresnel integrals, for the exact pixel means of a zone plate.
#pragma once

namespace abn::harness {

struct FresnelIntegrals {
  double cosine;  // C(x) = integral of cos(pi t^2 / 2) over [0, x]
  double sine;    // S(x) = integral of sin(pi t^2 / 2) over [0, x]
};

/// C(x) and S(x) for finite x, with an absolute error below 1e-12 for |x| < 100; both are odd in x.
/// Abramowitz and Stegun 1964, 7.3.11 and 7.3.13 (power series) and 7.1.14 (continued fraction of erfc).
FresnelIntegrals fresnel(double x);

}  // namespace abn::harness
