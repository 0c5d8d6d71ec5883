// The physics of the SPH sampler, one equation per function, for host and device.
//
// Everything is dimensionless (Jiang et al. 2015 made scale-free): the unit of length is the mean spacing
// d = sqrt(area / N), so the number density is 1, the mass is 1, and one set of parameters serves every N and plane.
// Equation numbers are those of Russell's thesis (2017), chapter 2.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "sampling/hd.h"
#include "sampling/rng.h"

namespace abn::sph {

/// Eq. 2.19 as a factor: the warped distance 2|x_i - x_j| / (s_i + s_j) is |x_i - x_j| times this.
template <class Real>
ABN_HD constexpr Real warp(Real size_i, Real size_j) {
  return Real(2) / (size_i + size_j);
}

/// q = warped distance / H from the squared distance [d^2]; the pair interacts where q < 1.
template <class Real>
ABN_HD inline Real kernel_distance(Real squared_distance, Real inverse_reach) {
  return std::sqrt(squared_distance) * inverse_reach;
}

/// max(0, 1 - q): what all kernels are made of; zero past the support without a branch.
template <class Real>
ABN_HD constexpr Real support(Real q) {
  const Real rest = Real(1) - q;
  return rest > Real(0) ? rest : Real(0);
}

/// The smoothing kernel W of eq. 2.14 and the gradient that goes with it.
enum class Kernel : std::uint8_t {
  wendland,     // Wendland C2: no pairing of particles up to H = 3 (the default)
  poly6_spiky,  // the thesis' pair: poly6 for the density, the spiky kernel's gradient for the force (Mueller 2003)
  cubic,        // cubic spline: its gradient vanishes at r = 0, so particles pair at H >= 2.5
};

/// W without its constant, as a function of q; zero past the support.
template <Kernel kernel = Kernel::wendland, class Real>
ABN_HD constexpr Real kernel_shape(Real q) {
  const Real a = support(q);
  if constexpr (kernel == Kernel::wendland) {  // (1-q)^4 (1+4q)
    const Real a2 = a * a;
    return a2 * a2 * (Real(1) + Real(4) * q);
  } else if constexpr (kernel == Kernel::poly6_spiky) {  // (1-q^2)^3
    const Real b = a * (Real(1) + q);
    return b * b * b;
  } else {  // 1 - 6q^2 + 6q^3 up to q = 1/2, then 2 (1-q)^3
    const Real near = Real(1) - Real(6) * q * q * (Real(1) - q);
    return q < Real(0.5) ? near : Real(2) * a * a * a;
  }
}

/// The constant that makes W integrate to 1 over the plane: 7, 4 or 40/7 over pi H^2.
template <Kernel kernel = Kernel::wendland, class Real>
ABN_HD constexpr Real kernel_constant(Real support_radius) {
  const Real numerator = kernel == Kernel::wendland ? Real(7) : kernel == Kernel::poly6_spiky ? Real(4) : Real(40) / 7;
  return numerator / (std::numbers::pi_v<Real> * support_radius * support_radius);
}

/// -(dW/dr) / r up to a constant factor: the gradient is this times (x_i - x_j). The factors make the stiffness of long
/// waves, the moment int g(q) q^3 dq, that of the Wendland kernel, so that one step length serves all kernels.
template <Kernel kernel = Kernel::wendland, class Real>
ABN_HD constexpr Real gradient_shape(Real q) {
  const Real a = support(q);
  if constexpr (kernel == Kernel::wendland) {
    return a * a * a;
  } else if constexpr (kernel == Kernel::poly6_spiky) {
    const Real direction = q > Real(1e-3) ? q : Real(1e-3);  // coincident particles have none: coincident_offset()
    return Real(3) / 14 * (a * a) / direction;
  } else {
    const Real far = Real(0.5) * (a * a) / (q > Real(0.5) ? q : Real(0.5));
    return Real(24) / 49 * (q < Real(0.5) ? Real(1) - Real(1.5) * q : far);
  }
}

/// One term of the density sum, eq. 2.15: rho_i = kernel_constant * sum over j, self included, of these.
template <Kernel kernel = Kernel::wendland, class Real>
ABN_HD inline Real density_term(Real squared_distance, Real inverse_reach) {
  return kernel_shape<kernel>(kernel_distance(squared_distance, inverse_reach));
}

/// Pressure, eqs. 2.17 and 2.18 relative to the mean: P = 1 + (rho - mean) / (Delta mean). The stiffness k and the mass
/// drop out, Delta (density difference relative to the mean) sets the profile. Not clamped, as in the thesis.
template <class Real>
ABN_HD constexpr Real pressure(Real density, Real mean_density, Real inverse_delta) {
  return Real(1) + (density - mean_density) / mean_density * inverse_delta;
}

/// One term of the pressure force, eq. 2.16: force_i = sum over j of this * (x_i - x_j) * warp. The last factor puts
/// the force into units of the local spacing. Symmetric in i and j, so that momentum is conserved. Deviation: P_i + P_j
/// without 1/rho^2 (the thesis prints P/rho, its code and Jiang have P/rho^2), because rho is 1 at equilibrium; the
/// constant of grad W is in `step`.
template <Kernel kernel = Kernel::wendland, class Real>
ABN_HD inline Real force_term(Real squared_distance, Real inverse_reach, Real pressure_i, Real pressure_j) {
  const Real gradient = gradient_shape<kernel>(kernel_distance(squared_distance, inverse_reach));
  return Real(0.5) * (pressure_i + pressure_j) * gradient;
}

/// Stands in for (x_i - x_j) where two particles coincide and no direction exists: a short vector from the two ids,
/// opposite for (j, i), so that the pair separates deterministically and keeps its momentum.
template <class Real>
ABN_HD inline void coincident_offset(std::uint32_t id_i, std::uint32_t id_j, Real& dx, Real& dy) {
  const bool swapped = id_i > id_j;
  const std::uint32_t low = swapped ? id_j : id_i;
  const std::uint32_t high = swapped ? id_i : id_j;
  const Philox4 bits = philox4x32({{low, high, 0, 0}}, 0x6E756467U, 0);
  const Real x = static_cast<Real>(unit_float(bits.word[0])) - Real(0.5);
  const Real y = static_cast<Real>(unit_float(bits.word[1])) - Real(0.5);
  // Length about 0.01 d, never zero: far above the rounding of a position, far below a spacing.
  const Real length = (swapped ? Real(-0.01) : Real(0.01)) / (std::sqrt(x * x + y * y) + Real(1e-3));
  dx = (x + Real(1e-3)) * length;
  dy = y * length;
}

/// One leapfrog step of the velocity [d per step, in units of the local spacing]: linear damping, then a cap on the
/// length. Returns the new length; a step that is not finite is dropped (velocity 0) and -1 returned, so no particle is
/// ever moved by it.
template <class Real>
ABN_HD inline Real advance(Real& vx, Real& vy, Real force_x, Real force_y, Real step, Real damping, Real cap) {
  vx = damping * vx + step * force_x;
  vy = damping * vy + step * force_y;
  const Real length = std::sqrt(vx * vx + vy * vy);
  if (length <= cap) return length;
  if (!(length < std::numeric_limits<Real>::infinity())) {
    vx = vy = Real(0);
    return Real(-1);
  }
  vx *= cap / length;
  vy *= cap / length;
  return cap;
}

/// The largest integer that is not above x; |x| < 2^63. Without a call into the mathematics library.
template <class Real>
ABN_HD constexpr std::int64_t floor_to_integer(Real x) {
  const auto truncated = static_cast<std::int64_t>(x);
  return truncated - (x < static_cast<Real>(truncated) ? 1 : 0);
}

/// The coordinate's place between two walls, in [0, length).
template <class Real>
ABN_HD inline Real keep_inside(Real x, Real length) {
  const Real largest = length * (Real(1) - std::numeric_limits<Real>::epsilon());
  return x < Real(0) ? Real(0) : x < largest ? x : largest;
}

/// The coordinate's place on the torus, in [0, length). Precondition: x finite.
template <class Real>
ABN_HD inline Real wrap(Real x, Real length) {
  if (x >= Real(0) && x < length) return x;
  x -= length * std::floor(x / length);
  return x >= Real(0) && x < length ? x : Real(0);  // -1e-9 + length rounds to length, which is 0
}

}  // namespace abn::sph
