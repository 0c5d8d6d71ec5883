// Close looks: named regions of a scene cut out of pictures and error maps, and the error inside them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "harness/canvas.h"
#include "harness/image.h"
#include "harness/output.h"
#include "harness/picture.h"
#include "harness/scenes.h"

namespace abn::harness {

/// The pixels of a region on a picture of `size`: its corners rounded to whole pixels, at least one pixel.
CanvasArea pixels_of(const Region& region, Extent size);

/// That part of an image, which must hold it.
Image cut_out(const Image& image, const CanvasArea& area);

/// Root mean square of test - truth over the pixels of `area` and all channels, linear light. Throws ConfigError when
/// sizes or channels differ.
double rmse_inside(const Image& test, const Image& truth, const CanvasArea& area);

/// How a sheet of crops is drawn.
struct CropLayout {
  std::string title;
  bool high_dynamic_range = false;  // shown as x/(1+x)
  double gain = 10;                 // of the error maps
  std::uint32_t zoom = 8;           // every pixel is a square of zoom x zoom
};

/// The truth and every exhibit inside `region` (thesis figs. 4.3, 4.5), below each its error map (figs. 4.4, 4.6) with
/// the RMSE inside the region.
Picture crop_sheet(const Image& truth, const std::vector<Exhibit>& exhibits, const Region& region,
                   const CropLayout& layout);

/// The regions named `names` of scene:NAME, in the order of `names`; those that it lacks are left out, and image files
/// have none. Throws IoError as regions() does.
std::vector<Region> named_regions(const std::string& scene_word, const std::vector<std::string>& names);

}  // namespace abn::harness
