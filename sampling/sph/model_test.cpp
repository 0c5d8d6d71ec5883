#include "sampling/sph/model.h"

#include <gtest/gtest.h>

#include "sampling/sph/size_field.h"
#include "sampling/sph/test_planes.h"

namespace abn::sph {
namespace {

TEST(Kernel, IntegratesToOneOverThePlane) {
  for (const double support : {1.0, 2.0, 3.5}) {
    double sum = 0;
    const int n = 800;
    const double cell = 2 * support / n;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const double x = -support + (i + 0.5) * cell;
        const double y = -support + (j + 0.5) * cell;
        sum += density_term(x * x + y * y, 1 / support);
      }
    }
    EXPECT_NEAR(kernel_constant(support) * sum * cell * cell, 1.0, 1e-6) << "H " << support;
  }
}

TEST(Kernel, VanishesFromTheSupportOn) {
  EXPECT_EQ(kernel_shape(1.0), 0.0);
  EXPECT_EQ(kernel_shape(1.7), 0.0);
  EXPECT_EQ(kernel_shape(0.0), 1.0);
  EXPECT_EQ(force_term(4.1, 0.5, 1.0, 1.0), 0.0);
}

TEST(Kernel, ForceIsParallelToItsGradient) {
  // d/dr of (1-q)^4 (1+4q) is -20 q (1-q)^3 / H, so gradient / r = -20/H^2 (1-q)^3: the force's factor.
  const double support = 2;
  for (double r = 0.1; r < 2; r += 0.17) {
    const double h = 1e-5;
    const double slope = (kernel_shape((r + h) / support) - kernel_shape((r - h) / support)) / (2 * h);
    EXPECT_NEAR(-slope / r * support * support / 20, force_term(r * r, 1 / support, 1.0, 1.0), 1e-9);
  }
}

TEST(Pressure, IsOneAtTheMeanDensityAndRisesByOneOverDelta) {
  EXPECT_DOUBLE_EQ(pressure(1.1, 1.1, 1 / 0.3), 1.0);
  EXPECT_NEAR(pressure(1.3 * 1.1, 1.1, 1 / 0.3), 2.0, 1e-12);
  EXPECT_NEAR(pressure(0.7 * 1.1, 1.1, 1 / 0.3), 0.0, 1e-12);
}

TEST(Advance, CapsTheVelocityAndDropsNonFiniteSteps) {
  double vx = 0.1, vy = 0;
  EXPECT_TRUE(advance(vx, vy, 0.05, 0.0, 1.2, 0.6, 0.3));
  EXPECT_NEAR(vx, 0.12, 1e-15);
  EXPECT_TRUE(advance(vx, vy, 3e8, -4e8, 1.2, 0.6, 0.3));
  EXPECT_NEAR(vx, 0.18, 1e-7);
  EXPECT_NEAR(vy, -0.24, 1e-7);
  EXPECT_FALSE(advance(vx, vy, std::nan(""), 0.0, 1.2, 0.6, 0.3));
  EXPECT_EQ(vx, 0);
  EXPECT_EQ(vy, 0);
  EXPECT_FALSE(advance(vx, vy, 0.0, -std::numeric_limits<double>::infinity(), 1.2, 0.6, 0.3));
  EXPECT_EQ(vy, 0);
}

TEST(Wrap, StaysInsideTheTorus) {
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

TEST(CoincidentOffset, IsShortAndOppositeForThePartner) {
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

TEST(SizeField, InverseSquareIntegratesToTheArea) {
  // Independent quadrature of the bilinear interpolant, over a smooth field and a jump of 1:100.
  for (const Grid<float>& s : {smooth_size_field({12, 9}, 10), jump_size_field({8, 8}, 100.0F)}) {
    const Grid<float> field = normalised_size_field(s, 1e9);
    const Extent size = field.size();
    double sum = 0;
    const int sub = 200;
    for (std::uint32_t j = 0; j < size.height * sub; ++j) {
      for (std::uint32_t i = 0; i < size.width * sub; ++i) {
        const double value =
            bilinear_periodic(field.cells().data(), size.width, size.height, (i + 0.5) / sub, (j + 0.5) / sub);
        sum += 1 / (value * value);
      }
    }
    EXPECT_NEAR(sum / (static_cast<double>(size.area()) * sub * sub), 1.0, 2e-4);
  }
}

TEST(SizeField, OnlyRatiosCountAndExtremesStayFinite) {
  Grid<float> s({4, 4}, 2.0F);
  s.at(1, 1) = 6.0F;
  Grid<float> scaled = s;
  for (float& value : scaled.cells()) value *= 0x1p100F;
  const auto a = normalised_size_field(s, 100);
  const auto b = normalised_size_field(scaled, 100);
  for (std::size_t i = 0; i < 16; ++i) EXPECT_FLOAT_EQ(a[i], b[i]);
  s.at(0, 0) = std::numeric_limits<float>::max();
  s.at(3, 3) = std::numeric_limits<float>::denorm_min();
  const Grid<float> extreme = normalised_size_field(s, 100);
  for (const float value : extreme.cells()) {
    EXPECT_GT(value, 0.0F);
    EXPECT_LE(value, 100.0F);
  }
}

TEST(SizeField, RefusesZeroNegativeAndNonFinite) {
  for (const float bad : {0.0F, -1.0F, std::nanf(""), std::numeric_limits<float>::infinity()}) {
    Grid<float> s({3, 3}, 1.0F);
    s.at(2, 1) = bad;
    EXPECT_THROW(normalised_size_field(s, 10), ConfigError) << bad;
  }
}

}  // namespace
}  // namespace abn::sph
