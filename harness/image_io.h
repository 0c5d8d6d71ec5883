// Images from and to files: the door between the project and OpenImageIO (image_io.cpp reads, image_write.cpp writes;
// oiio_compare.cpp alone stands beside them).
//
// Common rules. Images are linear light inside the program. A load gives the whole image or throws; a save leaves
// the whole file or none. Every error is one IoError line: file, reason, remedy.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "harness/image.h"
#include "sampling/error.h"

namespace abn::harness {

/// What to do with texels that are NaN or infinite.
enum class OnNonfinite {
  refuse,  // IoError with their count and the first position
  zero,    // they become 0
  clamp,   // NaN becomes 0, +Inf and -Inf the largest and smallest finite value of that channel in this image
};

/// The policy of that name; throws ConfigError that lists the names.
OnNonfinite parse_on_nonfinite(const std::string& word);

struct LoadOptions {
  std::string channels = {};  // one or three names or 0-based indices, e.g. "R,G,B" or "3"; empty = automatic
  OnNonfinite on_nonfinite = OnNonfinite::refuse;
};

/// An image and what a person should know about how it was read.
struct LoadedImage {
  Image image;
  bool floating_point = false;  // the file holds float, half, double or RGBE: its values may exceed 1
  std::string format;           // e.g. "openexr half, 4 channels"
  std::vector<std::string> notices;
};

/// Reads any image file that OpenImageIO reads.
///
/// - Unsigned and signed integers are decoded to linear light: by the sRGB curve (IEC 61966-2-1, in double), by the
///   power the file states (oiio:Gamma), or not at all if the file says it is linear. Floating point is taken as
///   linear.
/// - One channel stays one; otherwise three: of two the first, of four or more the first three, `channels` chooses
///   others. An alpha channel is dropped; colour is used as the file stores it, neither multiplied nor divided by it.
/// - A file whose data window differs from its display window gives the data window.
/// - The orientation tag is applied, so that row 0 is the top. Of several parts or mipmap levels the first is read.
/// Each of these but the first that applies is said in `notices`.
///
/// Throws IoError (missing, empty, truncated, damaged, not an image, subsampled or deep, too large for this machine's
/// memory, non-finite texels), ConfigError for `channels` that do not exist.
LoadedImage load_image(const std::string& path, const LoadOptions& options = {});

struct SaveOptions {
  std::string depth = {};  // uint8 | uint16 | half | float; empty = the format's default
  int jpeg_quality = 95;   // 1 ... 100
};

/// Writes `image` in the format of the file's extension: exr (float, half), tif (float, half, uint16, uint8), hdr
/// (RGBE), png (uint8, uint16), jpg, bmp, tga (uint8); the first is the default. Integers are sRGB-encoded, clamped to
/// [0,1] and rounded to nearest. The same image gives the same bytes: no date is written. Atomic.
/// Throws ConfigError for an unknown extension or a depth the format lacks, IoError if the file cannot be written or a
/// value does not fit half.
void save_image(const std::string& path, const Image& image, const SaveOptions& options = {});

/// Writes bytes [width*height*3], RGB as they are to be shown (already sRGB-encoded), as png, jpg, tif, bmp or tga.
/// Throws as save_image does.
void save_rgb8(const std::string& path, Extent size, std::span<const std::uint8_t> rgb);

/// Throws ConfigError that lists the extensions unless save_image knows that of `path`.
void require_image_format(const std::string& path);

/// Version of the library behind these functions, for records.
std::string openimageio_version();

/// 16 hexadecimal digits from the size, the number of channels and the bits of every texel; the same on every machine.
/// A 64-bit multiply-xorshift chain over 32-bit words: it finds accidents, it does not resist an attack.
std::string pixel_hash(const Image& image);

}  // namespace abn::harness
