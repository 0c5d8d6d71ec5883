// A bitmap alphabet, drawn for this project: capitals, digits and the three marks that the text picture uses.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace abn::harness {

constexpr std::size_t letter_columns = 5, letter_rows = 7;

/// The rows of a letter from the top; '#' is ink.
using Letter = std::array<std::string_view, letter_rows>;

/// The letter of an upper-case character, a digit or one of ".,:"; any other character is blank.
const Letter& letter_of(char character);

}  // namespace abn::harness
