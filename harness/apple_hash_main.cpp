// apple_hash SIZE: prints the pixel hash of the procedural apple at SIZE x SIZE texels. Built at two optimisation
// levels by the test suite, which compares the two lines: the picture must not depend on the compiler's effort.
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "harness/apple_analytic.h"
#include "harness/image_io.h"

int main(int argc, char** argv) {
  std::uint32_t size = 0;
  constexpr std::uint32_t largest = 1U << 14;
  if (argc == 2) {
    const char* end = argv[1] + std::strlen(argv[1]);
    if (const auto [last, error] = std::from_chars(argv[1], end, size); last != end || error != std::errc{}) size = 0;
  }
  if (size < 1 || size > largest) {
    std::fprintf(stderr, "apple_hash: give one size from 1 to %u texels, such as: apple_hash 300\n", largest);
    return 2;
  }
  const abn::harness::Image image = abn::harness::render_apple_analytic({size, size});
  std::printf("%s\n", abn::harness::pixel_hash(image).c_str());
}
