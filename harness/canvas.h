// Drawing on a Picture: rectangles, lines, dots and turned text, all smooth at the edges and cut off at the border.
#pragma once

#include <span>
#include <string>

#include "harness/picture.h"

namespace abn::harness {

/// A position on a picture [px], y down; (0.5, 0.5) is the centre of the first pixel.
struct CanvasPoint {
  double x = 0;
  double y = 0;
};

/// A part of a picture, whole pixels; what falls outside it is not drawn.
struct CanvasArea {
  int left = 0, top = 0, width = 0, height = 0;
  int right() const { return left + width; }
  int bottom() const { return top + height; }
};

/// The whole picture.
CanvasArea area_of(const Picture& picture);

/// A filled rectangle.
void fill_area(Picture& picture, const CanvasArea& area, Rgb8 colour);

/// The one-pixel border just inside `area`.
void draw_border(Picture& picture, const CanvasArea& area, Rgb8 colour);

/// Straight lines through `points`, `thickness` px wide; a point that is not finite interrupts them.
void draw_path(Picture& picture, const CanvasArea& clip, std::span<const CanvasPoint> points, int thickness,
               Rgb8 colour);

/// The same as dashes of `dash` px with gaps as long; whole where a line is longer than 1e5 px.
void draw_dashed_path(Picture& picture, const CanvasArea& clip, std::span<const CanvasPoint> points, int thickness,
                      double dash, Rgb8 colour);

/// A filled polygon, mixed with what is there: opacity 0 ... 1. All points must be finite.
void fill_polygon(Picture& picture, const CanvasArea& clip, std::span<const CanvasPoint> points, double opacity,
                  Rgb8 colour);

/// Filled circles of `radius` px, each pixel covered by the share of it that lies inside (to about 1/50), so that dots
/// below one pixel keep their ink.
void draw_dots(Picture& picture, const CanvasArea& clip, std::span<const CanvasPoint> centres, double radius,
               Rgb8 colour);

/// One line of text that reads upwards, its middle at (x, y) [px].
void draw_text_upwards(Picture& picture, const std::string& text, int x, int y, double height, Rgb8 colour);

/// One line of text with its middle at x and its baseline at y [px].
void draw_text_centred(Picture& picture, const std::string& text, int x, int y, double height, Rgb8 colour);

/// Puts `source` on `target` with its left upper corner at (x, y) [px].
void paste(Picture& target, const Picture& source, int x, int y);

}  // namespace abn::harness
