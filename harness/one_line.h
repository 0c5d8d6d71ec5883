// Messages of libraries as one line.
#pragma once

#include <cctype>
#include <string>
#include <string_view>

namespace abn::harness {

/// OpenImageIO's messages span lines and repeat themselves: one line, no control characters, bounded.
inline std::string one_line(std::string_view text) {
  std::string line;
  for (const char c : text) {
    const bool blank = std::iscntrl(static_cast<unsigned char>(c)) != 0 || c == ' ';
    if (!blank) {
      line += c;
    } else if (!line.empty() && line.back() != ' ') {
      line += ' ';
    }
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  constexpr std::size_t longest = 300;
  if (line.size() > longest) line = line.substr(0, longest) + "...";
  return line;
}

}  // namespace abn::harness
