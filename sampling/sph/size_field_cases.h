// Size fields by name: the smooth ones that the density target is stated for, and the hard ones that broke the thesis.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "sampling/grid.h"

namespace abn::sph {

/// A relative spacing s(u,v) > 0 over the unit square, between 1 and `ratio`.
struct SizeFieldCase {
  std::string name;     // as typed: letters, digits, underscores
  std::string summary;  // one sentence
  double ratio;         // default of s_max / s_min, > 1
  std::function<double(double u, double v, double ratio)> value;
};

/// The table: constant, smooth, ramp, step, disc, ring, spikes, random.
const std::vector<SizeFieldCase>& size_field_cases();

/// "NAME" or "NAME:RATIO" as a raster, sampled at cell centres. Throws ConfigError for an unknown name (listing the
/// known ones) or a ratio outside [1, 1000].
Grid<float> make_size_field(std::string_view word, Extent cells);

}  // namespace abn::sph
