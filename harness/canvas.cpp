#include "harness/canvas.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace abn::harness {
namespace {

constexpr int shift = 6;  // fractional bits of OpenCV's coordinates

/// The pixels of an area as OpenCV sees them; shares the picture's memory. `area` must lie inside the picture.
cv::Mat view(Picture& picture, const CanvasArea& area) {
  const cv::Mat whole(static_cast<int>(picture.height), static_cast<int>(picture.width), CV_8UC3, picture.rgb.data());
  return whole(cv::Rect(area.left, area.top, area.width, area.height));
}

CanvasArea inside(const Picture& picture, const CanvasArea& area) {
  const int left = std::clamp(area.left, 0, static_cast<int>(picture.width));
  const int top = std::clamp(area.top, 0, static_cast<int>(picture.height));
  const int right = std::clamp(area.right(), left, static_cast<int>(picture.width));
  const int bottom = std::clamp(area.bottom(), top, static_cast<int>(picture.height));
  return {left, top, right - left, bottom - top};
}

cv::Scalar scalar(Rgb8 colour) { return {double(colour[0]), double(colour[1]), double(colour[2])}; }

/// In OpenCV's fixed point, where a whole number is a pixel's centre. Far outside is brought near: lines keep their
/// direction well enough, and nothing overflows.
cv::Point fixed(CanvasPoint point, const CanvasArea& area) {
  const auto coordinate = [](double value, int size) {
    const double margin = 16.0 * std::max(size, 64);
    return static_cast<int>(std::lround(std::clamp(value - 0.5, -margin, size + margin) * (1 << shift)));
  };
  return {coordinate(point.x - area.left, area.width), coordinate(point.y - area.top, area.height)};
}

bool finite(CanvasPoint point) { return std::isfinite(point.x) && std::isfinite(point.y); }

void blend(std::uint8_t* pixel, Rgb8 colour, double opacity) {
  for (std::size_t c = 0; c < 3; ++c)
    pixel[c] = static_cast<std::uint8_t>(std::lround(pixel[c] + (double(colour[c]) - pixel[c]) * opacity));
}

}  // namespace

CanvasArea area_of(const Picture& picture) {
  return {0, 0, static_cast<int>(picture.width), static_cast<int>(picture.height)};
}

void fill_area(Picture& picture, const CanvasArea& area, Rgb8 colour) {
  const CanvasArea clipped = inside(picture, area);
  if (clipped.width > 0 && clipped.height > 0) view(picture, clipped) = scalar(colour);
}

void draw_border(Picture& picture, const CanvasArea& area, Rgb8 colour) {
  fill_area(picture, {area.left, area.top, area.width, 1}, colour);
  fill_area(picture, {area.left, area.bottom() - 1, area.width, 1}, colour);
  fill_area(picture, {area.left, area.top, 1, area.height}, colour);
  fill_area(picture, {area.right() - 1, area.top, 1, area.height}, colour);
}

void draw_path(Picture& picture, const CanvasArea& clip, std::span<const CanvasPoint> points, int thickness,
               Rgb8 colour) {
  const CanvasArea area = inside(picture, clip);
  if (area.width == 0 || area.height == 0) return;
  cv::Mat target = view(picture, area);
  std::vector<cv::Point> run;
  const auto draw_run = [&] {
    if (run.size() > 1) cv::polylines(target, run, false, scalar(colour), thickness, cv::LINE_AA, shift);
    run.clear();
  };
  for (const CanvasPoint& point : points) {
    if (finite(point)) {
      run.push_back(fixed(point, area));
    } else {
      draw_run();
    }
  }
  draw_run();
}

void draw_dashed_path(Picture& picture, const CanvasArea& clip, std::span<const CanvasPoint> points, int thickness,
                      double dash, Rgb8 colour) {
  double walked = 0;  // along the path since its begin [px]
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const CanvasPoint a = points[i];
    const CanvasPoint b = points[i + 1];
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    if (!std::isfinite(length) || length == 0) continue;
    if (length > 1e5) {  // far beyond any picture: its dashes could not be seen one by one
      const CanvasPoint ends[] = {a, b};
      draw_path(picture, clip, ends, thickness, colour);
      continue;
    }
    const auto at = [&](double distance) {
      return CanvasPoint{a.x + (b.x - a.x) * distance / length, a.y + (b.y - a.y) * distance / length};
    };
    for (double from = 0; from < length;) {
      const double phase = std::fmod(walked + from, 2 * dash);
      const double to = std::min(length, from + std::max((phase < dash ? dash : 2 * dash) - phase, 0.01));
      const CanvasPoint ends[] = {at(from), at(to)};
      if (phase < dash) draw_path(picture, clip, ends, thickness, colour);
      from = to;
    }
    walked += length;
  }
}

void fill_polygon(Picture& picture, const CanvasArea& clip, std::span<const CanvasPoint> points, double opacity,
                  Rgb8 colour) {
  const CanvasArea area = inside(picture, clip);
  if (area.width == 0 || area.height == 0 || points.size() < 3) return;
  std::vector<std::vector<cv::Point>> outline(1);
  for (const CanvasPoint& point : points) outline[0].push_back(fixed(point, area));
  cv::Mat1b coverage(area.height, area.width, std::uint8_t{0});
  cv::fillPoly(coverage, outline, cv::Scalar(255), cv::LINE_AA, shift);
  for (int y = 0; y < area.height; ++y) {
    for (int x = 0; x < area.width; ++x) {
      if (coverage(y, x) == 0) continue;
      blend(picture.pixel(static_cast<std::uint32_t>(area.left + x), static_cast<std::uint32_t>(area.top + y)), colour,
            opacity * coverage(y, x) / 255.0);
    }
  }
}

void draw_dots(Picture& picture, const CanvasArea& clip, std::span<const CanvasPoint> centres, double radius,
               Rgb8 colour) {
  const CanvasArea area = inside(picture, clip);
  constexpr int grid = 7;  // sub-samples of a pixel, a side
  for (const CanvasPoint& centre : centres) {
    if (!finite(centre)) continue;
    const auto low = [&](double value, int bound) { return std::max(bound, static_cast<int>(std::floor(value))); };
    const auto high = [&](double value, int bound) { return std::min(bound, static_cast<int>(std::ceil(value))); };
    if (!(std::abs(centre.x) < 1e6 && std::abs(centre.y) < 1e6)) continue;
    for (int y = low(centre.y - radius, area.top); y < high(centre.y + radius, area.bottom()); ++y) {
      for (int x = low(centre.x - radius, area.left); x < high(centre.x + radius, area.right()); ++x) {
        const double distance = std::hypot(x + 0.5 - centre.x, y + 0.5 - centre.y);
        int hits = 0;
        if (distance + 0.7072 <= radius) {
          hits = grid * grid;
        } else {
          for (int k = 0; k < grid * grid; ++k) {
            const int column = k % grid;
            const int row = k / grid;
            const double dx = x + (column + 0.5) / grid - centre.x;
            const double dy = y + (row + 0.5) / grid - centre.y;
            hits += dx * dx + dy * dy <= radius * radius ? 1 : 0;
          }
        }
        if (hits == 0) continue;
        blend(picture.pixel(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)), colour,
              double(hits) / (grid * grid));
      }
    }
  }
}

void draw_text_upwards(Picture& picture, const std::string& text, int x, int y, double height, Rgb8 colour) {
  // Written across a strip of the background, then turned; ink is what differs from white.
  const int width = text_width(text, height) + 4;
  const int strip = static_cast<int>(std::ceil(2.2 * height));
  Picture written(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(strip));
  draw_text(written, text, 2, static_cast<int>(std::lround(1.5 * height)), height, {0, 0, 0});
  for (int v = 0; v < strip; ++v) {
    for (int u = 0; u < width; ++u) {
      const int px = x - strip / 2 + v;
      const int py = y + width / 2 - u;
      if (px < 0 || py < 0 || px >= static_cast<int>(picture.width) || py >= static_cast<int>(picture.height)) continue;
      const double ink = 1 - written.pixel(static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v))[0] / 255.0;
      if (ink > 0) blend(picture.pixel(static_cast<std::uint32_t>(px), static_cast<std::uint32_t>(py)), colour, ink);
    }
  }
}

void draw_text_centred(Picture& picture, const std::string& text, int x, int y, double height, Rgb8 colour) {
  draw_text(picture, text, x - text_width(text, height) / 2, y, height, colour);
}

void paste(Picture& target, const Picture& source, int x, int y) {
  for (int row = 0; row < static_cast<int>(source.height); ++row) {
    const int v = y + row;
    if (v < 0 || v >= static_cast<int>(target.height)) continue;
    const int first = std::max(0, -x);
    const int last = std::min(static_cast<int>(source.width), static_cast<int>(target.width) - x);
    if (first >= last) continue;
    std::copy_n(source.pixel(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(row)),
                std::size_t(last - first) * 3,
                target.pixel(static_cast<std::uint32_t>(x + first), static_cast<std::uint32_t>(v)));
  }
}

}  // namespace abn::harness
