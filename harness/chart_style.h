// What all charts have in common: sizes [px] and colours.
#pragma once

#include "harness/picture.h"

namespace abn::harness::chart_style {

constexpr Rgb8 ink{34, 34, 40};
constexpr Rgb8 grey_ink{90, 90, 98};
constexpr Rgb8 frame{150, 150, 156};
constexpr Rgb8 grid_line{228, 228, 232};

constexpr double title_height = 10;  // of capitals
constexpr double label_height = 9;
constexpr double tick_height = 8;
constexpr int title_line = 24;  // from one line of text to the next
constexpr int legend_line = 18;
constexpr int margin = 10;  // around everything

/// Text no wider than `room`: smaller if it must be.
inline void draw_fitted(Picture& picture, const std::string& text, int x, int y, double height, int room, Rgb8 colour) {
  const int width = text_width(text, height);
  draw_text(picture, text, x, y, width > room ? height * room / width : height, colour);
}

}  // namespace abn::harness::chart_style
