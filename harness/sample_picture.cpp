#include "harness/sample_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include "harness/canvas.h"
#include "sampling/error.h"
#include "sampling/grid.h"

namespace abn::harness {
namespace {

constexpr Rgb8 kSample{255, 255, 255};
constexpr Rgb8 kGhost{86, 180, 233};
constexpr Rgb8 kBorder{120, 120, 120};
constexpr Rgb8 kPixelLine{52, 52, 52};

/// Samples per pixel in the fullest fiftieth of the region's pixels that have any; at least 1.
double dense_spp(std::span<const Vec2f> samples, Extent plane, const PlaneRegion& region) {
  Grid<std::uint32_t> counts(plane);
  for (const Vec2f at : samples) {
    const bool shown = double{at.x} >= region.left && double{at.x} < region.right && double{at.y} >= region.top &&
                       double{at.y} < region.bottom;
    const bool on_plane =
        at.x >= 0 && at.y >= 0 && at.x < static_cast<float>(plane.width) && at.y < static_cast<float>(plane.height);
    if (shown && on_plane) ++counts.at(static_cast<std::uint32_t>(at.x), static_cast<std::uint32_t>(at.y));
  }
  std::vector<std::uint32_t> full;
  for (const std::uint32_t count : counts.cells()) {
    if (count > 0) full.push_back(count);
  }
  if (full.empty()) return 1;
  const auto at = full.begin() + static_cast<std::ptrdiff_t>((full.size() - 1) * 49 / 50);
  std::nth_element(full.begin(), at, full.end());
  return *at;
}

}  // namespace

PlaneRegion parse_plane_region(const std::string& word, const std::string& what, Extent plane) {
  double corners[4] = {};
  const char* at = word.data();
  const char* end = word.data() + word.size();
  bool good = true;
  for (int i = 0; i < 4 && good; ++i) {
    const auto [rest, error] = std::from_chars(at, end, corners[i]);
    good = error == std::errc{} && std::isfinite(corners[i]) && (i < 3 ? rest != end && *rest == ',' : rest == end);
    at = rest + (i < 3 && good ? 1 : 0);
  }
  const PlaneRegion region{corners[0], corners[1], corners[2], corners[3]};
  constexpr double kWidest = 65536;
  if (good && region.left < region.right && region.top < region.bottom && region.right - region.left <= kWidest &&
      region.bottom - region.top <= kWidest && region.right > 0 && region.left < plane.width && region.bottom > 0 &&
      region.top < plane.height) {
    return region;
  }
  throw ConfigError(fmt::format("{} is '{}'; give LEFT,TOP,RIGHT,BOTTOM in pixels of the {}x{} plane, e.g. 0,0,{},{}",
                                what, word, plane.width, plane.height, std::min(plane.width, 20U),
                                std::min(plane.height, 20U)));
}

PlaneRegion region_around(Extent plane, std::span<const Vec2f> ghosts) {
  PlaneRegion region{0, 0, static_cast<double>(plane.width), static_cast<double>(plane.height)};
  for (const Vec2f ghost : ghosts) {
    region.left = std::min(region.left, double{ghost.x});
    region.top = std::min(region.top, double{ghost.y});
    region.right = std::max(region.right, double{ghost.x});
    region.bottom = std::max(region.bottom, double{ghost.y});
  }
  // A ghost lies in the middle of its room.
  constexpr double kRoom = 0.2;
  if (region.left < 0) region.left -= kRoom;
  if (region.top < 0) region.top -= kRoom;
  if (region.right > plane.width) region.right += kRoom;
  if (region.bottom > plane.height) region.bottom += kRoom;
  return region;
}

Picture draw_samples(std::span<const Vec2f> samples, std::span<const Vec2f> ghosts, Extent plane,
                     const PlaneRegion& region) {
  const double width = region.right - region.left;
  const double height = region.bottom - region.top;
  const double longer = std::max(width, height);
  const double scale = std::min(std::clamp(1000 / longer, 10.0, 400.0), 4000 / longer);
  const auto pixels = [&](double length) {
    return std::max(1U, static_cast<std::uint32_t>(std::lround(length * scale)));
  };
  Picture picture(pixels(width), pixels(height), {0, 0, 0});
  const CanvasArea whole = area_of(picture);
  const auto column = [&](double x) { return static_cast<int>(std::lround((x - region.left) * scale)); };
  const auto row = [&](double y) { return static_cast<int>(std::lround((y - region.top) * scale)); };
  const int left = column(0);
  const int top = row(0);
  const int right = column(plane.width);
  const int bottom = row(plane.height);
  if (scale >= 16) {
    for (std::uint32_t x = 1; x < plane.width; ++x)
      fill_area(picture, {column(x), std::max(top, 0), 1, std::min(bottom, whole.height) - std::max(top, 0)},
                kPixelLine);
    for (std::uint32_t y = 1; y < plane.height; ++y)
      fill_area(picture, {std::max(left, 0), row(y), std::min(right, whole.width) - std::max(left, 0), 1}, kPixelLine);
  }
  draw_border(picture, {left - 1, top - 1, right - left + 2, bottom - top + 2}, kBorder);
  // Where samples are densest their dots cover .3 of the plane: as blue noise they stay apart.
  const double spp = dense_spp(samples, plane, region);
  const double radius = std::clamp(scale * std::sqrt(0.3 / (std::numbers::pi * spp)), 0.7, 12.0);
  const auto draw = [&](std::span<const Vec2f> dots, Rgb8 colour) {
    std::vector<CanvasPoint> centres;
    centres.reserve(dots.size());
    for (const Vec2f at : dots) {
      centres.push_back({(double{at.x} - region.left) * scale, (double{at.y} - region.top) * scale});
    }
    draw_dots(picture, whole, centres, radius, colour);
  };
  draw(ghosts, kGhost);
  draw(samples, kSample);
  return picture;
}

}  // namespace abn::harness
