#include "sampling/vec.h"

#include <gtest/gtest.h>

#include <cmath>

namespace abn {
namespace {

TEST(JustBelow, IsThePreviousFloat) {
  for (const float limit : {1.0F, 200.0F, 0x1p-30F, 16777216.0F}) {
    EXPECT_LT(just_below(limit), limit);
    EXPECT_EQ(std::nextafter(just_below(limit), limit), limit);
  }
}

TEST(Place, NeverReachesTheFarBorder) {
  const float largest = just_below(1.0F);
  EXPECT_EQ(4095.0F + largest, 4096.0F);  // what it is for
  for (const float origin : {0.0F, 1.0F, 199.0F, 4095.0F, 65535.0F}) {
    EXPECT_EQ(std::floor(place(origin, largest, 1.0F)), origin);
    EXPECT_EQ(place(origin, 0.0F, 1.0F), origin);
  }
}

TEST(ToPlane, KeepsTheUnitSquareInsideThePlane) {
  const float largest = just_below(1.0F);
  for (const Extent plane : {Extent{1, 1}, Extent{200, 100}, Extent{3, 100000}}) {
    const Vec2f far = to_plane({largest, largest}, plane);
    EXPECT_LT(far.x, static_cast<float>(plane.width));
    EXPECT_LT(far.y, static_cast<float>(plane.height));
    EXPECT_EQ(to_plane({0, 0}, plane), (Vec2f{0, 0}));
  }
  EXPECT_EQ(to_plane({0.5F, 0.25F}, {200, 100}), (Vec2f{100, 25}));
}

TEST(ToPixel, StaysInItsPixel) {
  const float largest = just_below(1.0F);
  const Vec2f p = to_pixel({largest, 0.5F}, 60000, 3);
  EXPECT_EQ(std::floor(p.x), 60000.0F);
  EXPECT_EQ(p.y, 3.5F);
}

TEST(Extent, AreaDoesNotOverflow) { EXPECT_EQ((Extent{100000, 100000}).area(), 10000000000U); }

}  // namespace
}  // namespace abn
