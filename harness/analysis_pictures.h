// The pictures of an analysis.
#pragma once

#include <string>
#include <vector>

#include "harness/analysis.h"
#include "harness/picture.h"

namespace abn::harness {

/// The first set as dots, on the extent of its density if it has one.
Picture draw_points(const Analysis& analysis, std::uint32_t width = 480, const std::string& title = {});

/// The averaged power spectrum in grey, DC in the middle, up to 2 sqrt(N) where it reaches so far. Empty without
/// spectrum.
Picture draw_spectrum(const Analysis& analysis, std::uint32_t width = 480);

/// The radial mean of several analyses with the band of its 95 % interval over the sets, and the anisotropy below it.
/// Those without a spectrum are left out; empty if none has one.
Picture draw_radial(const std::vector<const Analysis*>& analyses, std::uint32_t width = 640);

/// The pair correlation of several analyses. Empty if none has one.
Picture draw_pair_correlation(const std::vector<const Analysis*>& analyses, std::uint32_t width = 640);

/// All of it on one page.
Picture draw_sheet(const Analysis& analysis);

/// Stippling: dots on paper, of the size at which the fullest fiftieth of `density` nearly closes (without one: at
/// which all cover half of it). Bright = many points, so that dots are white on black. Ghost particles, outside the
/// unit square, are blue around it (thesis fig. 4.1), and the picture shows them too.
Picture draw_stipples(const std::vector<analysis::Point>& points, const Grid<float>* density, std::uint32_t width,
                      const std::vector<analysis::Point>& ghosts = {});

}  // namespace abn::harness
