#include "harness/image_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <new>
#include <string_view>

#include "harness/one_line.h"

namespace abn::harness {
namespace {

/// Keeps the process' standard error shut while it lives: libpng prints its own lines there, and a damaged file shall
/// give one line, ours. Only around calls of OpenImageIO that print nothing a person needs.
class QuietStandardError {
 public:
  QuietStandardError() : kept_(::dup(STDERR_FILENO)) {
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (kept_ >= 0 && nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
    if (nowhere >= 0) ::close(nowhere);
  }
  ~QuietStandardError() {
    if (kept_ < 0) return;
    ::dup2(kept_, STDERR_FILENO);
    ::close(kept_);
  }
  QuietStandardError(const QuietStandardError&) = delete;
  QuietStandardError& operator=(const QuietStandardError&) = delete;

 private:
  int kept_;
};

[[noreturn]] void fail_to_read(const std::string& path, const std::string& reason, const std::string& remedy) {
  throw IoError("cannot read image '" + path + "': " + reason + "; " + remedy);
}

constexpr const char* truncated_remedy = "the file is truncated or damaged: create or copy it again";

std::string join(const std::vector<std::string>& words) {
  std::string line;
  for (const auto& word : words) line += (line.empty() ? "" : ", ") + word;
  return line;
}

void check_is_nonempty_file(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    fail_to_read(path, "there is no such file", "check the path");
  }
  if (error) fail_to_read(path, error.message(), "check the path and its permissions");
  if (std::filesystem::is_directory(status)) fail_to_read(path, "it is a directory", "name an image file");
  if (!std::filesystem::is_regular_file(status)) {
    fail_to_read(path, "it is not a regular file", "name an image file");
  }
  const auto size = std::filesystem::file_size(path, error);
  if (error) fail_to_read(path, error.message(), "check the path and its permissions");
  if (size == 0) fail_to_read(path, "the file is empty (0 bytes)", "create or copy it again");
  if (access(path.c_str(), R_OK) != 0) fail_to_read(path, "permission denied", "make the file readable");
}

// Walks the chunks of a PNG file up to IEND; nothing for other files. libpng would notice a missing end too, but only
// where pixels are missing, and it prints on stderr by itself.
void check_png_is_complete(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 8> head{};
  file.read(head.data(), 8);
  if (!file || std::string_view(head.data(), 8) != std::string_view("\x89PNG\r\n\x1a\n", 8)) return;
  for (;;) {
    file.read(head.data(), 8);  // length, big-endian, and type
    if (!file) break;
    std::uint32_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | static_cast<unsigned char>(head[i]);
    file.seekg(std::streamoff{length} + 3, std::ios::cur);  // data and all but the last byte of the checksum
    if (file.get() == std::ifstream::traits_type::eof()) break;
    if (std::string_view(&head[4], 4) == "IEND") return;
  }
  fail_to_read(path, "the PNG data ends too early", truncated_remedy);
}

bool is_alpha(const OIIO::ImageSpec& spec, int channel) {
  if (spec.alpha_channel == channel) return true;
  const std::string& name = spec.channelnames[static_cast<std::size_t>(channel)];  // GIF sets the name only
  return name == "A" || name == "a" || name == "Alpha" || name == "alpha";
}

// Which channels of the file become the image's.
std::vector<int> choose_channels(const std::string& path, const OIIO::ImageSpec& spec, const std::string& wanted,
                                 std::vector<std::string>& notices) {
  const int available = spec.nchannels;
  if (wanted.empty()) {
    if (available == 1) return {0};
    const int kept = available == 2 ? 1 : 3;
    if (available == kept + 1 && is_alpha(spec, kept)) {
      notices.emplace_back("the alpha channel is dropped; colour is used as stored");
    } else if (available != kept) {
      notices.push_back("of " + std::to_string(available) + " channels (" + join(spec.channelnames) + ") the first " +
                        (kept == 1 ? "one is" : "three are") + " used; --channels chooses others");
    }
    return kept == 1 ? std::vector<int>{0} : std::vector<int>{0, 1, 2};
  }
  std::vector<int> chosen;
  for (std::size_t begin = 0; begin <= wanted.size();) {
    const std::size_t end = std::min(wanted.find(',', begin), wanted.size());
    const std::string word = wanted.substr(begin, end - begin);
    begin = end + 1;
    const auto name = std::find(spec.channelnames.begin(), spec.channelnames.end(), word);
    const bool number = !word.empty() && word.size() < 7 &&
                        std::all_of(word.begin(), word.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (name != spec.channelnames.end()) {
      chosen.push_back(static_cast<int>(name - spec.channelnames.begin()));
    } else if (number && std::stoi(word) < available) {
      chosen.push_back(std::stoi(word));
    } else {
      throw ConfigError("--channels " + wanted + ": '" + path + "' has no channel '" + word +
                        "'; it has: " + join(spec.channelnames) + " (or 0 to " + std::to_string(available - 1) + ")");
    }
  }
  if (chosen.size() != 1 && chosen.size() != 3) {
    throw ConfigError("--channels " + wanted + ": " + std::to_string(chosen.size()) +
                      " channels named; name one or three");
  }
  return chosen;
}

// Throws before the allocation that the operating system might grant now and punish later.
void check_size(const std::string& path, const OIIO::ImageSpec& spec, int channels_read) {
  if (spec.width < 1 || spec.height < 1) fail_to_read(path, "it has no pixels", "create or copy it again");
  if (spec.depth > 1) fail_to_read(path, "it is a volume", "give a plane image");
  if (spec.deep) fail_to_read(path, "it holds deep samples", "flatten it first");
  const double bytes = double{4} * spec.width * spec.height * channels_read;
  const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  if (bytes > 0.5 * memory) {
    std::array<char, 160> text{};
    std::snprintf(text.data(), text.size(), "its %d x %d texels need %.1f GiB and this machine has %.1f GiB of memory",
                  spec.width, spec.height, bytes * 0x1p-30, memory * 0x1p-30);
    fail_to_read(path, text.data(), "crop or shrink it first, or choose one channel by --channels");
  }
}

// Integers to linear light.
class Decoder {
 public:
  Decoder(const OIIO::ImageSpec& spec, std::vector<std::string>& notices) {
    const std::string space = spec.get_string_attribute("oiio:ColorSpace");
    std::string lower = space;
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const float power = spec.get_float_attribute("oiio:Gamma", 0.0F);
    if (lower == "linear" || lower == "scene_linear" || lower == "lin_srgb" || power == 1.0F) {
      exponent_ = 1.0;
      notices.emplace_back("the file says that its integers are linear light: taken as they are");
    } else if (lower.starts_with("gamma") && std::isfinite(power) && power > 0) {
      exponent_ = double{power};
      notices.push_back("decoded by the power " + std::to_string(power) + " that the file states");
    }
  }
  float operator()(double encoded) const {
    if (exponent_ != 0) return static_cast<float>(std::pow(std::max(encoded, 0.0), exponent_));
    // IEC 61966-2-1; in double, so that a table holds the curve rounded once.
    return static_cast<float>(encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4));
  }

 private:
  double exponent_ = 0;  // 0 = the sRGB curve
};

// Reads channels [first, first + count) of the first part as T. Throws IoError unless every pixel was read.
template <class T>
void read_pixels(const std::string& path, OIIO::ImageInput& input, int first, int count, OIIO::TypeDesc type, T* to,
                 std::vector<std::string>& notices) {
  const bool complete = input.read_image(0, 0, first, first + count, type, to);
  // Some readers fill a truncated image with grey and only leave a message (JPEG, IFF): a message is a failure too.
  const std::string message = one_line(input.geterror());
  if (complete && message.empty()) return;
  if (complete && message.find("extraneous bytes before marker") != std::string::npos &&
      message.find("Premature") == std::string::npos) {
    notices.push_back("harmless damage: " + message);
    return;
  }
  fail_to_read(path, message.empty() ? "the pixel data is incomplete" : message, truncated_remedy);
}

// `source` holds `stride` channels per texel; the image takes chosen[k] - first of them, through `convert`.
template <class T, class Convert>
void gather(const std::vector<T>& source, std::size_t stride, const std::vector<int>& chosen, int first, Image& image,
            const Convert& convert) {
  const std::size_t texels = image.size.area();
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const T* from = source.data() + (chosen[k] - first);
    float* to = image.texels.data() + k;
    for (std::size_t i = 0; i < texels; ++i) to[i * chosen.size()] = convert(from[i * stride]);
  }
}

template <class T>
void read_integers(const std::string& path, OIIO::ImageInput& input, const std::vector<int>& chosen, int first,
                   int count, OIIO::TypeDesc type, const Decoder& decode, LoadedImage& loaded) {
  std::vector<T> stored(loaded.image.size.area() * static_cast<std::size_t>(count));
  read_pixels(path, input, first, count, type, stored.data(), loaded.notices);
  constexpr std::size_t levels = std::size_t{std::numeric_limits<T>::max()} + 1;
  std::vector<float> table(levels);
  for (std::size_t i = 0; i < levels; ++i) table[i] = decode(static_cast<double>(i) / static_cast<double>(levels - 1));
  gather(stored, static_cast<std::size_t>(count), chosen, first, loaded.image, [&](T value) { return table[value]; });
}

void apply_on_nonfinite(const std::string& path, OnNonfinite policy, LoadedImage& loaded) {
  Image& image = loaded.image;
  std::uint64_t bad = 0;
  std::size_t first = 0;
  std::array<float, 3> lowest{};
  std::array<float, 3> highest{};
  std::array<bool, 3> seen{};
  for (std::size_t i = 0; i < image.texels.size(); ++i) {
    const float value = image.texels[i];
    if (std::isfinite(value)) continue;
    if (bad++ == 0) first = i;
  }
  if (bad == 0) return;
  const std::size_t texel = first / image.channels;
  const std::string where = "(" + std::to_string(texel % image.size.width) + ", " +
                            std::to_string(texel / image.size.width) + ") channel " +
                            std::to_string(first % image.channels);
  if (policy == OnNonfinite::refuse) {
    fail_to_read(path, std::to_string(bad) + " values are NaN or infinite, the first at " + where,
                 "repair it, or give --on-nonfinite zero or --on-nonfinite clamp");
  }
  if (policy == OnNonfinite::clamp) {
    for (std::size_t i = 0; i < image.texels.size(); ++i) {
      const float value = image.texels[i];
      const std::size_t c = i % image.channels;
      if (!std::isfinite(value)) continue;
      lowest[c] = seen[c] ? std::min(lowest[c], value) : value;
      highest[c] = seen[c] ? std::max(highest[c], value) : value;
      seen[c] = true;
    }
  }
  for (std::size_t i = 0; i < image.texels.size(); ++i) {
    float& value = image.texels[i];
    const std::size_t c = i % image.channels;
    if (std::isfinite(value)) continue;
    if (policy == OnNonfinite::zero || std::isnan(value)) {
      value = 0;
    } else {
      value = value > 0 ? highest[c] : lowest[c];
    }
  }
  loaded.notices.push_back(std::to_string(bad) + " NaN or infinite values, the first at " + where + ", set to " +
                           (policy == OnNonfinite::zero ? "0" : "0 (NaN) or the channel's finite extremes"));
}

// Turns the stored raster upright: EXIF/TIFF orientation 2 ... 8.
Image apply_orientation(const Image& stored, int orientation) {
  const bool transposed = orientation >= 5;
  const std::uint32_t w = stored.size.width;
  const std::uint32_t h = stored.size.height;
  Image upright(transposed ? Extent{h, w} : stored.size, stored.channels);
  const bool mirror_x = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
  const bool mirror_y = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
  for (std::uint32_t y = 0; y < upright.size.height; ++y) {
    for (std::uint32_t x = 0; x < upright.size.width; ++x) {
      const std::uint32_t u = transposed ? y : x;
      const std::uint32_t v = transposed ? x : y;
      const float* from = stored.texel(mirror_x ? w - 1 - u : u, mirror_y ? h - 1 - v : v);
      std::copy_n(from, stored.channels, upright.texel(x, y));
    }
  }
  return upright;
}

LoadedImage load_unguarded(const std::string& path, const LoadOptions& options) {
  check_is_nonempty_file(path);
  check_png_is_complete(path);
  OIIO::ImageSpec hints;
  hints["oiio:UnassociatedAlpha"] = 1;  // colour as stored: OpenImageIO would multiply it by alpha
  const auto input = OIIO::ImageInput::open(path, &hints);
  const std::string open_message = one_line(OIIO::geterror());
  if (!input) {
    fail_to_read(path, open_message.empty() ? "it cannot be opened" : open_message,
                 "give a complete image file of a common format such as EXR, PNG, JPEG or TIFF");
  }
  const OIIO::ImageSpec spec = input->spec();

  LoadedImage loaded;
  std::vector<std::string>& notices = loaded.notices;
  const std::vector<int> chosen = choose_channels(path, spec, options.channels, notices);
  const auto [low, high] = std::minmax_element(chosen.begin(), chosen.end());
  const int first = *low;
  const int count = *high - first + 1;
  check_size(path, spec, count);
  loaded.format = std::string(input->format_name()) + " " + spec.format.c_str() + ", " +
                  std::to_string(spec.nchannels) + (spec.nchannels == 1 ? " channel" : " channels");
  loaded.floating_point = spec.format.is_floating_point();
  loaded.image = Image({static_cast<std::uint32_t>(spec.width), static_cast<std::uint32_t>(spec.height)},
                       static_cast<std::uint32_t>(chosen.size()));

  if (loaded.floating_point) {
    bool in_place = true;
    for (std::size_t k = 0; k < chosen.size(); ++k) in_place = in_place && chosen[k] == first + static_cast<int>(k);
    if (in_place) {
      read_pixels(path, *input, first, count, OIIO::TypeDesc::FLOAT, loaded.image.texels.data(), notices);
    } else {
      std::vector<float> stored(loaded.image.size.area() * static_cast<std::size_t>(count));
      read_pixels(path, *input, first, count, OIIO::TypeDesc::FLOAT, stored.data(), notices);
      gather(stored, static_cast<std::size_t>(count), chosen, first, loaded.image, [](float value) { return value; });
    }
  } else {
    const Decoder decode(spec, notices);
    if (spec.format == OIIO::TypeDesc::UINT8) {
      read_integers<std::uint8_t>(path, *input, chosen, first, count, spec.format, decode, loaded);
    } else if (spec.format == OIIO::TypeDesc::UINT16) {
      read_integers<std::uint16_t>(path, *input, chosen, first, count, spec.format, decode, loaded);
    } else {  // 32-bit and signed integers: OpenImageIO scales their range to 1
      std::vector<float> stored(loaded.image.size.area() * static_cast<std::size_t>(count));
      read_pixels(path, *input, first, count, OIIO::TypeDesc::FLOAT, stored.data(), notices);
      gather(stored, static_cast<std::size_t>(count), chosen, first, loaded.image,
             [&](float value) { return decode(double{value}); });
    }
  }

  if (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
      spec.height != spec.full_height) {
    notices.push_back("the data window is the image: " + std::to_string(spec.width) + " x " +
                      std::to_string(spec.height) + " at (" + std::to_string(spec.x) + ", " + std::to_string(spec.y) +
                      ") in a display window of " + std::to_string(spec.full_width) + " x " +
                      std::to_string(spec.full_height));
  }
  const bool several = input->seek_subimage(1, 0);
  (void)input->geterror();  // seeking past the last part leaves a message
  if (several) notices.emplace_back("the file has several parts: the first is used");
  input->close();
  (void)input->geterror();

  apply_on_nonfinite(path, options.on_nonfinite, loaded);
  const int orientation = spec.get_int_attribute("Orientation", 1);
  if (orientation >= 2 && orientation <= 8) {
    loaded.image = apply_orientation(loaded.image, orientation);
    notices.push_back("turned upright as the file's orientation tag " + std::to_string(orientation) + " says");
  }
  return loaded;
}

}  // namespace

OnNonfinite parse_on_nonfinite(const std::string& word) {
  if (word == "refuse") return OnNonfinite::refuse;
  if (word == "zero") return OnNonfinite::zero;
  if (word == "clamp") return OnNonfinite::clamp;
  throw ConfigError("--on-nonfinite " + word + ": unknown; known: refuse, zero, clamp");
}

LoadedImage load_image(const std::string& path, const LoadOptions& options) {
  try {
    std::fflush(stderr);
    const QuietStandardError quiet;
    return load_unguarded(path, options);
  } catch (const IoError&) {
    throw;
  } catch (const ConfigError&) {
    throw;
  } catch (const std::bad_alloc&) {
    fail_to_read(path, "not enough memory", "crop or shrink it first, or choose one channel by --channels");
  } catch (const std::exception& error) {
    fail_to_read(path, one_line(error.what()), "create or copy it again");
  }
}

}  // namespace abn::harness
