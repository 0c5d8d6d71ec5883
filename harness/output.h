// Pictures and error maps as files, for people and for programs.
#pragma once

#include <string>
#include <vector>

#include "harness/image.h"
#include "harness/picture.h"
#include "sampling/grid.h"

namespace abn::harness {

/// True if the format of `path` holds linear values (.exr, .hdr): nothing is encoded, clamped or tone-mapped.
bool is_linear_format(const std::string& path);

/// Throws ConfigError (format) or IoError (folder) if an image could not be written to `path`: asked before the work,
/// so that a wrong name does not cost minutes.
void require_writable_image(const std::string& path);

/// The same for any file. Devices and pipes pass: what they take shows when it is written.
void require_writable(const std::string& path);

/// Writes a picture: linear formats keep its values, others are sRGB-encoded, and high dynamic range is tone-mapped by
/// x/(1+x) first, so that it can be seen. Throws ConfigError, IoError.
void write_picture(const std::string& path, const Image& image, bool high_dynamic_range);

/// Writes how two images differ: .exr the signed difference test - reference, float; otherwise |difference| x gain in
/// false colour with a colour bar. Throws ConfigError, IoError.
void write_error_map(const std::string& path, const Image& test, const Image& reference, double gain);

/// Writes errors that were estimated without the truth: .exr as float, otherwise x gain in false colour with a colour
/// bar, labelled as an estimate. Throws ConfigError, IoError.
void write_estimated_error(const std::string& path, const Grid<float>& standard_error, double gain);

/// One column of an overview.
struct Exhibit {
  std::string label;
  Image image;
  double rmse = 0;
};

/// A sheet that shows the truth and every exhibit, and below each its error map with a common scale.
Picture overview(const std::string& title, const Image& truth, const std::vector<Exhibit>& exhibits,
                 bool high_dynamic_range, double gain);

}  // namespace abn::harness
