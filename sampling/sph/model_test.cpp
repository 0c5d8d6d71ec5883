#include "sampling/sph/model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sampling/vec.h"

namespace abn::sph {
namespace {

/// Calls f.operator()<kernel>(name) for every kernel.
template <class F>
void for_each_kernel(const F& f) {
  f.template operator()<Kernel::wendland>("wendland");
  f.template operator()<Kernel::poly6_spiky>("poly6_spiky");
  f.template operator()<Kernel::cubic>("cubic");
}

/// Integral of f over [0,1] by Simpson's rule; every kernel is a polynomial on both halves.
template <class F>
double integral(const F& f) {
  constexpr int steps = 2000;
  double sum = 0;
  for (int k = 0; k < steps; ++k) {
    const double a = static_cast<double>(k) / steps;
    const double b = static_cast<double>(k + 1) / steps;
    sum += (f(a) + 4 * f(0.5 * (a + b)) + f(b)) / 6 / steps;
  }
  return sum;
}

TEST(SphKernel, IntegratesToOneOverThePlane) {
  for_each_kernel([]<Kernel kernel>(const char* name) {
    for (const double support : {1.0, 2.0, 3.5}) {
      double sum = 0;
      const int n = 800;
      const double cell = 2 * support / n;
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
          const double x = -support + (i + 0.5) * cell;
          const double y = -support + (j + 0.5) * cell;
          sum += density_term<kernel>(x * x + y * y, 1 / support);
        }
      }
      EXPECT_NEAR(kernel_constant<kernel>(support) * sum * cell * cell, 1.0, 1e-6) << name << " H " << support;
    }
  });
}

TEST(SphKernel, IsOneAtTheCentreAndVanishesContinuouslyAtTheSupport) {
  for_each_kernel([]<Kernel kernel>(const char* name) {
    EXPECT_EQ(kernel_shape<kernel>(0.0), 1.0) << name;
    for (const double q : {1.0, 1.0 + 1e-15, 1.7, 1e9}) {
      EXPECT_EQ(kernel_shape<kernel>(q), 0.0) << name;
      EXPECT_EQ(gradient_shape<kernel>(q), 0.0) << name;
    }
    EXPECT_LT(kernel_shape<kernel>(1 - 1e-6), 1e-11) << name;
    EXPECT_LT(gradient_shape<kernel>(1 - 1e-6), 1e-11) << name;
    for (double q = 0; q < 1; q += 1.0 / 1024) {  // no jump in between, and never rising
      const double fall = kernel_shape<kernel>(q) - kernel_shape<kernel>(q + 1.0 / 1024);
      EXPECT_GE(fall, 0) << name << " q " << q;
      EXPECT_LT(fall, 0.003) << name << " q " << q;
    }
    EXPECT_TRUE(std::isfinite(gradient_shape<kernel>(0.0)) && std::isfinite(gradient_shape<kernel>(0.0F))) << name;
    EXPECT_GT(gradient_shape<kernel>(0.0), 0) << name;
    EXPECT_EQ(density_term<kernel>(4.1, 0.5), 0.0) << name;
    EXPECT_EQ(force_term<kernel>(4.1, 0.5, 1.0, 1.0), 0.0) << name;
  });
}

/// W whose gradient the force uses, without its constant: for the thesis' pair the spiky kernel (Mueller 2003).
template <Kernel kernel>
double potential(double q) {
  if (kernel == Kernel::poly6_spiky) return (1 - q) * (1 - q) * (1 - q);
  return kernel_shape<kernel>(q);
}

TEST(SphKernel, ForceIsParallelToItsGradient) {
  for_each_kernel([]<Kernel kernel>(const char* name) {
    const double h = 1e-5;
    double ratio = 0;
    for (double q = 0.05; q < 0.97; q += 0.0313) {
      const double slope = (potential<kernel>(q + h) - potential<kernel>(q - h)) / (2 * h);
      const double now = -slope / q / gradient_shape<kernel>(q);
      ratio = ratio > 0 ? ratio : now;
      EXPECT_NEAR(now, ratio, 1e-5 * ratio) << name << " q " << q;
    }
  });
}

TEST(SphKernel, StiffnessOfLongWavesIsTheSameForAll) {
  for_each_kernel([]<Kernel kernel>(const char* name) {
    const double moment = integral([](double q) { return gradient_shape<kernel>(q) * q * q * q; });
    EXPECT_NEAR(moment * 140, 1.0, 1e-6) << name;  // B(4,4) = 1/140
  });
}

TEST(SphPressure, IsOneAtTheMeanDensityAndRisesByOneOverDelta) {
  EXPECT_DOUBLE_EQ(pressure(1.1, 1.1, 1 / 0.3), 1.0);
  EXPECT_NEAR(pressure(1.3 * 1.1, 1.1, 1 / 0.3), 2.0, 1e-12);
  EXPECT_NEAR(pressure(0.7 * 1.1, 1.1, 1 / 0.3), 0.0, 1e-12);
}

TEST(SphAdvance, CapsTheVelocityAndDropsNonFiniteSteps) {
  double vx = 0.1, vy = 0;
  const double length = advance(vx, vy, 0.05, 0.0, 1.2, 0.6, 0.3);
  EXPECT_DOUBLE_EQ(length, std::hypot(vx, vy));
  EXPECT_NEAR(vx, 0.12, 1e-15);
  EXPECT_EQ(advance(vx, vy, 3e8, -4e8, 1.2, 0.6, 0.3), 0.3);
  EXPECT_NEAR(vx, 0.18, 1e-7);
  EXPECT_NEAR(vy, -0.24, 1e-7);
  EXPECT_EQ(advance(vx, vy, std::nan(""), 0.0, 1.2, 0.6, 0.3), -1);
  EXPECT_EQ(vx, 0);
  EXPECT_EQ(vy, 0);
  EXPECT_EQ(advance(vx, vy, 0.0, -std::numeric_limits<double>::infinity(), 1.2, 0.6, 0.3), -1);
  EXPECT_EQ(vy, 0);
}

TEST(SphWrap, StaysInsideTheTorus) {
  for (const float length : {0.003F, 1.0F, 490.0F}) {
    for (const float x : {-1e-12F, -0.3F, 0.0F, 0.3F, -1000.0F, 1000.0F, just_below(length), length}) {
      const float w = wrap(x, length);
      EXPECT_GE(w, 0.0F) << x << " in " << length;
      EXPECT_LT(w, length) << x << " in " << length;
    }
  }
  EXPECT_EQ(wrap(-0.25F, 1.0F), 0.75F);
  EXPECT_EQ(wrap(2.25F, 1.0F), 0.25F);
}

TEST(SphKeepInside, StopsAtTheWalls) {
  for (const float length : {0.003F, 1.0F, 490.0F}) {
    for (const float x : {-1e-12F, -3.0F, 0.0F, 0.3F, 1000.0F, just_below(length), length}) {
      const float w = keep_inside(x, length);
      EXPECT_GE(w, 0.0F) << x << " in " << length;
      EXPECT_LT(w, length) << x << " in " << length;
    }
  }
  EXPECT_EQ(keep_inside(0.25F, 1.0F), 0.25F);
}

TEST(SphCoincidentOffset, IsShortAndOppositeForThePartner) {
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const std::uint32_t j = i * 7 + 1;
    double ax, ay, bx, by;
    coincident_offset(i, j, ax, ay);
    coincident_offset(j, i, bx, by);
    EXPECT_EQ(ax, -bx);
    EXPECT_EQ(ay, -by);
    EXPECT_GT(std::hypot(ax, ay), 1e-5);
    EXPECT_LT(std::hypot(ax, ay), 0.02);
  }
}

}  // namespace
}  // namespace abn::sph
