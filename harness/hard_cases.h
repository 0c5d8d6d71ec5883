// Images that break samplers and reconstructions, one per way of breaking, with the exact pixel means where a closed
// form exists.
//
// Every picture has one channel, linear light, and is point-sampled at the texel centres (no anti-aliasing). Two truths
// are kept apart: the mean of the texels, which an estimator of the piecewise-constant integrand must meet, and the
// mean of the continuous picture behind them, which differs wherever the texels alias.
#pragma once

#include "harness/image.h"

namespace abn::harness {

/// ½ everywhere: no variance, so any error is the estimator's own.
Image render_constant(Extent size);
Image constant_truth(Extent size, Extent to);

/// 0 everywhere: relative errors and contrast limits divide by it.
Image render_black(Extent size);
Image black_truth(Extent size, Extent to);

/// ½ + ½ cos(pi r^2 / N), r [texels] from the centre, N the longer side: 1/2 cycle per texel at the middle of that
/// side.
Image render_zone_plate(Extent size);
/// The mean of the texels, by products of one-dimensional sums.
Image zone_plate_texel_truth(Extent size, Extent to);
/// The mean of the continuous picture, by Fresnel integrals.
Image zone_plate_continuous_truth(Extent size, Extent to);

/// 36 bright and 36 dark sectors round the centre, 0 and 1.
Image render_siemens_star(Extent size);
/// The mean of the continuous picture, by clipping every pixel with the sectors.
Image siemens_star_continuous_truth(Extent size, Extent to);

/// 0 left and 1 right of an edge through the centre, 5 degrees from the vertical.
Image render_slanted_edge(Extent size);
/// The mean of the continuous picture, by clipping every pixel with the edge.
Image slanted_edge_continuous_truth(Extent size, Extent to);

/// 0, then 1 from column width/2 on (1500 of 3000: on a pixel border when 3000 texels become 200 pixels).
Image render_step_1500(Extent size);
Image step_1500_truth(Extent size, Extent to);

/// 0, then 1 from column width/2 + 7 on (1507 of 3000: one column of pixels at 8/15).
Image render_step_1507(Extent size);
Image step_1507_truth(Extent size, Extent to);

/// 1 where x + y is even [texels], else 0: pixels of 15 x 15 texels are 113/225 and 112/225, not ½.
Image render_checkerboard_1texel(Extent size);
Image checkerboard_1texel_truth(Extent size, Extent to);

/// Columns 0, 47, 94, ... are 1, the others 0.
Image render_lines_47(Extent size);
Image lines_47_truth(Extent size, Extent to);

/// ½, but 10^4 at texel (width/2, height/2), which is the corner texel of its pixel when 3000 texels become 200 pixels.
Image render_firefly(Extent size);
Image firefly_truth(Extent size, Extent to);

/// 10^(12 x / N - 6), x the texel centre, N the width: twelve decades from left to right.
Image render_dynamic_range(Extent size);
Image dynamic_range_truth(Extent size, Extent to);

/// x / N, x the texel centre, N the width: stratified strategies must win clearly.
Image render_ramp(Extent size);
Image ramp_truth(Extent size, Extent to);

}  // namespace abn::harness
