// Synthetic pictures with the structures that photographs and renderings have, each one kind at a time: text, thin
// lines, disks, smooth shading, noise, rings.
//
// One channel, linear light in [0, 1], point-sampled at the texel centres (no anti-aliasing). Each picture is defined
// on a sheet of 3000 x 3000 units that is stretched over any size, so a small rendering shows the same picture. Random
// choices come from the project's counter-based generator with fixed keys: the same picture everywhere.
#pragma once

#include "harness/image.h"

namespace abn::harness {

/// Rings round the top left corner: ½ + ½ cos(300 pi r^2), r in widths; at 200 pixels 1.5 cycles per pixel at the far
/// side, so the pixel means fade to grey while point samples show moiré.
Image render_zone(Extent size);

/// 260 straight bright lines of 1.4 to 4.6 units width and any direction on a dark ground: thinner than a pixel.
Image render_lines(Extent size);

/// A room with soft shading, a bright rectangle, two boxes and a soft shadow: gradients and few edges.
Image render_smooth(Extent size);

/// Black text on white in letters of 18 to 78 units: edges everywhere, none of them on the pixel grid.
Image render_text(Extent size);

/// 1400 overlapping disks of all sizes with gentle gradients: edges of every direction and contrast.
Image render_disks(Extent size);

/// Nine octaves of value noise, amplitude falling by .62 per octave: energy at every frequency, no edge.
Image render_fbm(Extent size);

/// A density for stippling (thesis fig. 2.2): .01 at the left to 1 at the right, linear; a disc of 1 in its dark half
/// and a disc of .05 in its bright half. Never 0.
Image render_stipple(Extent size);

}  // namespace abn::harness
