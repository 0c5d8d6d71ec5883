#include "harness/fresnel.h"

#include <cmath>
#include <complex>
#include <numbers>

namespace abn::harness {

namespace {

constexpr double series_limit = 2.0;  // beyond it the alternating series loses digits, below it the fraction is slow
constexpr int fraction_terms = 400;   // more than |z| > 2.5 on the 45 degree line needs for 1e-13

/// Sum of x (i pi x^2 / 2)^n / (n! (2n + 1)): its real part is C(x), its imaginary part S(x).
std::complex<double> by_series(double x) {
  const std::complex<double> step(0.0, std::numbers::pi / 2 * x * x);
  std::complex<double> power(x, 0.0), sum = power;
  for (int n = 1; n <= 60; ++n) {
    power *= step / static_cast<double>(n);
    sum += power / (2.0 * n + 1.0);
  }
  return sum;
}

/// C + iS = (1 + i)/2 erf(z) with z = (1 - i) x sqrt(pi)/2, and erfc(z) by its continued fraction, from its end.
std::complex<double> by_continued_fraction(double x) {
  const std::complex<double> z = std::complex<double>(1.0, -1.0) * (x * std::sqrt(std::numbers::pi) / 2);
  std::complex<double> fraction = z;
  for (int k = fraction_terms; k >= 1; --k) fraction = z + 0.5 * k / fraction;
  const double phase = std::numbers::pi / 2 * x * x;  // -z^2 = i phase
  const std::complex<double> erfc =
      std::complex<double>(std::cos(phase), std::sin(phase)) / (std::sqrt(std::numbers::pi) * fraction);
  return std::complex<double>(0.5, 0.5) * (1.0 - erfc);
}

}  // namespace

FresnelIntegrals fresnel(double x) {
  const double distance = std::abs(x);
  const std::complex<double> value = distance < series_limit ? by_series(distance) : by_continued_fraction(distance);
  return {std::copysign(value.real(), x), std::copysign(value.imag(), x)};
}

}  // namespace abn::harness
