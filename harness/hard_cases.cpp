#include "harness/hard_cases.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/hard_case_constants.h"

namespace abn::harness {

namespace {

using namespace hard_case;

/// A one-channel image of value(x, y) at every texel; `value` must be a pure function, rows go to any thread.
template <class Value>
Image render(Extent size, const Value& value) {
  Image image(size, 1);
#pragma omp parallel for schedule(static)
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = 0; x < size.width; ++x) *image.texel(x, y) = static_cast<float>(value(x, y));
  }
  return image;
}

/// The signed distance of a texel centre from the image's centre [texels].
double from_centre(std::uint32_t index, std::uint32_t count) { return index + 0.5 - 0.5 * count; }

}  // namespace

Image render_constant(Extent size) {
  return render(size, [](std::uint32_t, std::uint32_t) { return background; });
}

Image render_black(Extent size) { return Image(size, 1); }

Image render_zone_plate(Extent size) {
  const double longer = std::max(size.width, size.height);
  return render(size, [&](std::uint32_t x, std::uint32_t y) {
    const double dx = from_centre(x, size.width), dy = from_centre(y, size.height);
    return 0.5 + 0.5 * std::cos(std::numbers::pi * (dx * dx + dy * dy) / longer);
  });
}

Image render_siemens_star(Extent size) {
  return render(size, [&](std::uint32_t x, std::uint32_t y) {
    const double angle = std::atan2(from_centre(y, size.height), from_centre(x, size.width)) - star_rotation;
    return std::lround(std::floor(angle / star_sector)) % 2 == 0 ? 1.0 : 0.0;
  });
}

Image render_slanted_edge(Extent size) {
  const double nx = std::cos(edge_slant), ny = std::sin(edge_slant);
  return render(size, [&](std::uint32_t x, std::uint32_t y) {
    return nx * from_centre(x, size.width) + ny * from_centre(y, size.height) >= 0.0 ? 1.0 : 0.0;
  });
}

Image render_step_1500(Extent size) {
  return render(size, [&](std::uint32_t x, std::uint32_t) { return x >= step_column(size, 0) ? 1.0 : 0.0; });
}

Image render_step_1507(Extent size) {
  return render(size, [&](std::uint32_t x, std::uint32_t) { return x >= step_column(size, late_step) ? 1.0 : 0.0; });
}

Image render_checkerboard_1texel(Extent size) {
  return render(size, [](std::uint32_t x, std::uint32_t y) { return (x + y) % 2 == 0 ? 1.0 : 0.0; });
}

Image render_lines_47(Extent size) {
  return render(size, [](std::uint32_t x, std::uint32_t) { return x % line_pitch == 0 ? 1.0 : 0.0; });
}

Image render_firefly(Extent size) {
  Image image = render_constant(size);
  if (size.area() > 0) *image.texel(size.width / 2, size.height / 2) = static_cast<float>(firefly_value);
  return image;
}

Image render_dynamic_range(Extent size) {
  return render(size, [&](std::uint32_t x, std::uint32_t) {
    return std::pow(10.0, decades * (x + 0.5) / size.width + first_decade);
  });
}

Image render_ramp(Extent size) {
  return render(size, [&](std::uint32_t x, std::uint32_t) { return (x + 0.5) / size.width; });
}

}  // namespace abn::harness
