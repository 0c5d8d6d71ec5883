// Runs a libFuzzer entry point without libFuzzer (which needs clang): mutates seed inputs for some seconds. Coverage
// does not guide it; the preset `fuzz` does that. Under the sanitizer preset it finds what a reader of bytes does
// wrong. Usage: driver SECONDS SEED_FILE....
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <vector>

#include "sampling/rng.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;

/// One to eight edits: flip, overwrite, insert, remove, repeat or cut.
Bytes mutated(Bytes bytes, abn::Rng& rng) {
  static const char kTelling[] = "0123456789.-+eEnaNiINF#,() \n\rxyweightpixel";
  for (std::uint32_t edits = 1 + rng.below(8); edits > 0; --edits) {
    const auto size = static_cast<std::uint32_t>(bytes.size());
    const auto at = static_cast<std::ptrdiff_t>(size == 0 ? 0 : rng.below(size));
    const auto value = static_cast<std::uint8_t>(
        rng.below(2) == 0 ? rng.below(256) : static_cast<std::uint32_t>(kTelling[rng.below(sizeof kTelling - 1)]));
    switch (rng.below(6)) {
      case 0:
        if (size > 0) bytes[static_cast<std::size_t>(at)] ^= static_cast<std::uint8_t>(1U << rng.below(8));
        break;
      case 1:
        if (size > 0) bytes[static_cast<std::size_t>(at)] = value;
        break;
      case 2:
        bytes.insert(bytes.begin() + at, value);
        break;
      case 3:
        if (size > 0) bytes.erase(bytes.begin() + at);
        break;
      case 4:
        if (size > 0 && size < 4096) {
          const Bytes copy(bytes.begin() + at,
                           bytes.begin() + at + std::min<std::ptrdiff_t>(16, static_cast<std::ptrdiff_t>(size) - at));
          bytes.insert(bytes.begin() + at, copy.begin(), copy.end());
        }
        break;
      default:
        bytes.resize(static_cast<std::size_t>(at));
        break;
    }
  }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s SECONDS SEED_FILE...\n", argv[0]);
    return 2;
  }
  std::vector<Bytes> seeds;
  for (int i = 2; i < argc; ++i) {
    std::ifstream file(argv[i], std::ios::binary);
    seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    if (seeds.back().empty()) {
      std::fprintf(stderr, "%s: cannot be read or is empty\n", argv[i]);
      return 2;
    }
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(std::atof(argv[1]));
  std::uint64_t runs = 0;
  for (; runs % 256 != 0 || std::chrono::steady_clock::now() < end; ++runs) {
    abn::Rng rng(1, abn::stream_id("fuzz"), runs);
    const Bytes input = mutated(seeds[rng.below(static_cast<std::uint32_t>(seeds.size()))], rng);
    LLVMFuzzerTestOneInput(input.data(), input.size());
  }
  std::printf("%llu inputs, none failed\n", static_cast<unsigned long long>(runs));
  return 0;
}
