// The numbers that the pictures of hard_cases.cpp and their truths in hard_case_truths.cpp share.
#pragma once

#include <cstdint>
#include <numbers>

#include "sampling/vec.h"

namespace abn::harness::hard_case {

constexpr double background = 0.5;        // of `constant` and `firefly`
constexpr double firefly_value = 1e4;     // well inside the range of half floats
constexpr std::uint32_t late_step = 7;    // [texels] of `step_1507` behind the middle
constexpr std::uint32_t line_pitch = 47;  // [texels] of `lines_47`: coprime with the 15 texels of a pixel
constexpr double decades = 12.0;          // of `dynamic_range`
constexpr double first_decade = -6.0;
constexpr int star_sectors = 72;  // bright and dark ones alternate
constexpr double star_sector = 2.0 * std::numbers::pi / star_sectors;
constexpr double star_rotation = 0.7 * std::numbers::pi / 180.0;  // keeps edges off the axes and diagonals
constexpr double edge_slant = 5.0 * std::numbers::pi / 180.0;

/// The first bright column of a step `late` texels behind the middle.
constexpr std::uint32_t step_column(Extent size, std::uint32_t late) { return size.width / 2 + late; }

}  // namespace abn::harness::hard_case
