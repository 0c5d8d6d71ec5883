// The samples of a run as a picture (thesis fig. 4.1).
#pragma once

#include <span>
#include <string>

#include "harness/picture.h"
#include "sampling/vec.h"

namespace abn::harness {

/// A part of the plane [px]; it may reach beyond the plane, where ghost particles are.
struct PlaneRegion {
  double left = 0, top = 0, right = 0, bottom = 0;
};

/// "LEFT,TOP,RIGHT,BOTTOM" in pixels. Throws ConfigError naming `what` unless left < right, top < bottom, both at most
/// 65536 px apart, and the region meets the plane.
PlaneRegion parse_plane_region(const std::string& word, const std::string& what, Extent plane);

/// The whole plane with as much around it as the ghosts need.
PlaneRegion region_around(Extent plane, std::span<const Vec2f> ghosts);

/// White dots on black, ghosts in blue, a grey line round the plane, and the lines between pixels where a pixel is
/// drawn at least 16 wide. The picture is about 1000 px wide for small regions and never above 4000; between these a
/// pixel of the plane is 10 wide. Dots are as large as leaves them apart in the fullest fiftieth of the pixels.
Picture draw_samples(std::span<const Vec2f> samples, std::span<const Vec2f> ghosts, Extent plane,
                     const PlaneRegion& region);

}  // namespace abn::harness
