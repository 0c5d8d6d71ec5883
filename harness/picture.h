// Pictures to be looked at: 8-bit RGB as shown, with text and colour bars, and sheets of several of them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "harness/image.h"

namespace abn::harness {

using Rgb8 = std::array<std::uint8_t, 3>;

/// 8-bit RGB, sRGB-encoded, rows from the top; owns its bytes.
struct Picture {
  std::uint32_t width = 0;        // [px]
  std::uint32_t height = 0;       // [px]
  std::vector<std::uint8_t> rgb;  // [width*height*3]

  Picture() = default;
  Picture(std::uint32_t w, std::uint32_t h, Rgb8 colour = {255, 255, 255});
  Extent size() const { return {width, height}; }
  std::uint8_t* pixel(std::uint32_t x, std::uint32_t y) { return rgb.data() + (std::size_t{y} * width + x) * 3; }
  const std::uint8_t* pixel(std::uint32_t x, std::uint32_t y) const {
    return rgb.data() + (std::size_t{y} * width + x) * 3;
  }
};

/// How a linear image becomes bytes: clamped to [0,1], or first mapped by x/(1+x) (Reinhard et al. 2002) where values
/// above 1 mean something. Negative values and NaN are black.
enum class ToneMapping { none, reinhard };

/// The image as a display shows it; grey is replicated.
Picture to_picture(const Image& image, ToneMapping tone_mapping = ToneMapping::none);

/// Every pixel as a square of factor x factor; factor >= 1.
Picture enlarge(const Picture& picture, std::uint32_t factor);

/// False colour of t in [0,1], clamped: black over violet, red and orange to pale yellow. CIE lightness is linear in t,
/// so that order survives grey printing and colour blindness; hue and chroma are built in OKLCh (Ottosson 2020) after
/// the idea of Smith and van der Walt's perceptually uniform maps (2015). NaN is green, which the map does not hold.
Rgb8 false_colour(float t);

/// Draws one line of ASCII text, its capitals `height` px tall, with its left end of the baseline at (x, y); what falls
/// outside is cut off.
void draw_text(Picture& picture, const std::string& text, int x, int y, double height, Rgb8 colour);

/// Width of that text [px].
int text_width(const std::string& text, double height);

/// The scale of a false-colour picture: colour t stands for low + t (high - low).
struct ColourBar {
  double low = 0;
  double high = 1;
  bool open_above = false;  // larger values share the last colour: its tick reads ">= high"
  std::string label;        // what is measured, and its unit
};

struct MontageItem {
  std::string label;  // above the picture; further lines after '\n' are drawn smaller
  Picture picture;
};

struct MontageLayout {
  std::uint32_t columns = 1;
  std::uint32_t smallest_width = 400;   // smaller pictures are enlarged by a whole factor to at least this [px]
  std::string title;                    // above all, empty: none
  std::string note;                     // below all, lines separated by '\n', empty: none
  std::optional<ColourBar> colour_bar;  // below the pictures
};

/// Lays labelled pictures out row by row on one white sheet. All cells have the size of the largest picture; an empty
/// picture leaves its cell blank. Text grows with the cells and shrinks to fit them. Throws ConfigError when there is
/// no picture or `columns` is 0.
Picture montage(std::span<const MontageItem> items, const MontageLayout& layout);

}  // namespace abn::harness
