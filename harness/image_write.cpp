// The writing half of image_io.h.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <string_view>

#include "harness/image_io.h"
#include "harness/one_line.h"
#include "sampling/atomic_file.h"

namespace abn::harness {
namespace {

struct FileFormat {
  std::string_view extension;
  std::vector<std::string_view> depths;  // the first is the default
};

const std::vector<FileFormat>& file_formats() {
  static const std::vector<FileFormat> formats = {
      {"exr", {"float", "half"}},
      {"tif", {"float", "half", "uint16", "uint8"}},
      {"tiff", {"float", "half", "uint16", "uint8"}},
      {"hdr", {"float"}},
      {"png", {"uint8", "uint16"}},
      {"jpg", {"uint8"}},
      {"jpeg", {"uint8"}},
      {"bmp", {"uint8"}},
      {"tga", {"uint8"}},
  };
  return formats;
}

const FileFormat& format_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  std::string known;
  for (const auto& format : file_formats()) {
    if (format.extension == extension) return format;
    known += (known.empty() ? "." : ", .") + std::string(format.extension);
  }
  throw ConfigError("cannot write '" + path + "': " +
                    (extension.empty() ? "the name has no extension" : "unknown extension '." + extension + "'") +
                    "; known: " + known);
}

std::string choose_depth(const std::string& path, const FileFormat& format, const std::string& wanted) {
  if (wanted.empty()) return std::string(format.depths.front());
  std::string known;
  for (const auto depth : format.depths) {
    if (depth == wanted) return wanted;
    known += (known.empty() ? "" : ", ") + std::string(depth);
  }
  throw ConfigError("cannot write '" + path + "' with depth '" + wanted + "'; ." + std::string(format.extension) +
                    " files take: " + known);
}

// One whole file from one buffer of `type`. It is encoded in memory, because on a full disk OpenImageIO's PNG writer
// reports success and its JPEG writer ends the process.
void write_file(const std::string& path, const OIIO::ImageSpec& spec, OIIO::TypeDesc type, const void* pixels) {
  const auto fail = [&](const std::string& message) {
    const std::string reason = one_line(message);
    throw IoError("cannot write image '" + path + "': " + (reason.empty() ? "encoding failed" : reason) +
                  "; try another format");
  };
  OIIO::Filesystem::IOVecOutput encoded;
  const auto output = OIIO::ImageOutput::create(path, &encoded);
  if (!output) fail(OIIO::geterror());
  bool complete = false;
  std::string message;
  try {
    complete = output->open(path, spec) && output->write_image(type, pixels);
    complete = output->close() && complete;
  } catch (const std::exception& error) {
    message = error.what();
  }
  // Only the return values count: TIFF leaves a message about metadata after a good write.
  message += output->geterror();
  if (!complete) fail(message);
  const std::vector<unsigned char>& bytes = encoded.buffer();
  write_atomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

OIIO::ImageSpec file_spec(Extent size, std::uint32_t channels, OIIO::TypeDesc type, const SaveOptions& options) {
  OIIO::ImageSpec spec(static_cast<int>(size.width), static_cast<int>(size.height), static_cast<int>(channels), type);
  const bool integer = !type.is_floating_point();
  spec.attribute("oiio:ColorSpace", integer ? "sRGB" : "Linear");
  // The EXR and TIFF writers add today's date unless there is one: equal images must be equal files.
  spec.attribute("DateTime", "1970:01:01 00:00:00");
  spec.attribute("CompressionQuality", options.jpeg_quality);
  return spec;
}

void check_half_range(const std::string& path, const Image& image) {
  constexpr float largest = 65504.0F;
  for (const float value : image.texels) {
    if (std::abs(value) <= largest) continue;
    throw IoError("cannot write image '" + path + "': the value " + std::to_string(value) +
                  " does not fit half precision (65504); use depth float");
  }
}

template <class T>
std::vector<T> encode_srgb(const Image& image) {
  constexpr float top = static_cast<float>(std::numeric_limits<T>::max());
  std::vector<T> encoded(image.texels.size());
  for (std::size_t i = 0; i < encoded.size(); ++i) {
    const double linear = std::clamp(double{image.texels[i]}, 0.0, 1.0);
    const double value = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    // A NaN survives clamp() and fails this comparison: it becomes black, not an undefined conversion.
    encoded[i] = value > 0 ? static_cast<T>(std::lround(value * double{top})) : T{0};
  }
  return encoded;
}

}  // namespace

void save_image(const std::string& path, const Image& image, const SaveOptions& options) {
  assert(image.size.area() > 0 && (image.channels == 1 || image.channels == 3));
  const FileFormat& format = format_of(path);
  const std::string depth = choose_depth(path, format, options.depth);
  if (format.extension == "hdr" && image.channels == 1) {  // RGBE has three channels
    Image grey(image.size, 3);
    for (std::size_t i = 0; i < image.texels.size(); ++i) std::fill_n(&grey.texels[3 * i], 3, image.texels[i]);
    return save_image(path, grey, options);
  }
  if (depth == "uint8") {
    const auto bytes = encode_srgb<std::uint8_t>(image);
    write_file(path, file_spec(image.size, image.channels, OIIO::TypeDesc::UINT8, options), OIIO::TypeDesc::UINT8,
               bytes.data());
  } else if (depth == "uint16") {
    const auto words = encode_srgb<std::uint16_t>(image);
    write_file(path, file_spec(image.size, image.channels, OIIO::TypeDesc::UINT16, options), OIIO::TypeDesc::UINT16,
               words.data());
  } else {
    if (depth == "half") check_half_range(path, image);
    const auto type = depth == "half" ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT;
    write_file(path, file_spec(image.size, image.channels, type, options), OIIO::TypeDesc::FLOAT, image.texels.data());
  }
}

void save_rgb8(const std::string& path, Extent size, std::span<const std::uint8_t> rgb) {
  assert(size.area() > 0 && rgb.size() == size.area() * 3);
  choose_depth(path, format_of(path), "uint8");
  write_file(path, file_spec(size, 3, OIIO::TypeDesc::UINT8, {}), OIIO::TypeDesc::UINT8, rgb.data());
}

void require_image_format(const std::string& path) { static_cast<void>(format_of(path)); }

std::string openimageio_version() {
  return std::to_string(OIIO_VERSION_MAJOR) + "." + std::to_string(OIIO_VERSION_MINOR) + "." +
         std::to_string(OIIO_VERSION_PATCH);
}

std::string pixel_hash(const Image& image) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  const auto mix = [&hash](std::uint32_t word) {
    hash = (hash ^ word) * 0x9E3779B97F4A7C15U;
    hash ^= hash >> 32;
  };
  mix(image.size.width);
  mix(image.size.height);
  mix(image.channels);
  for (const float value : image.texels) mix(std::bit_cast<std::uint32_t>(value));
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(hash));
  return text.data();
}

}  // namespace abn::harness
