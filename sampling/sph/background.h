// The background (mean-field) force of a size field, tabulated.
#pragma once

#include "sampling/grid.h"
#include "sampling/sph/size_field.h"

namespace abn::sph {

/// Fills in the pull at every cell of `field`, whose raster is `s`, and narrows its reach to what the search found.
void tabulate_background(const Grid<float>& s, const FieldOptions& options, SizeField& field);

}  // namespace abn::sph
