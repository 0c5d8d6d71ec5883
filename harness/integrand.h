// What is sampled: a function of position on the plane.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "harness/image.h"
#include "sampling/vec.h"

namespace abn::harness {

/// A function on the plane with 1 or 3 channels of linear light.
class Integrand {
 public:
  virtual ~Integrand() = default;
  /// values[i * channels() + c] = channel c at position[i] [px]; values.size() == position.size() * channels().
  /// Positions outside the plane are defined too: an image continues with its border texels. Thread-safe; each value
  /// depends on its own position only.
  virtual void evaluate(std::span<const Vec2f> position, std::span<float> values) const = 0;
  virtual std::uint32_t channels() const = 0;  // 1 or 3
  virtual Extent plane() const = 0;            // [px]
};

/// How an image becomes a function between its texel centres.
enum class Interpolation {
  nearest,   // piecewise constant: texel (i, j) covers [i, i+1) x [j, j+1) texels
  bilinear,  // linear between texel centres (i + 1/2, j + 1/2), constant beyond the outermost ones
};

/// The interpolation of that name; throws ConfigError that lists the names.
Interpolation parse_interpolation(const std::string& word);

/// An image stretched over the plane, whatever the two sizes are.
///
/// Nearest: the texel of position x is floor(x * image width / plane width), exactly, also on texel borders and for
/// ratios that are no integers. Refers to `image`, which must outlive it. Evaluates large batches on all OpenMP
/// threads.
class ImageIntegrand final : public Integrand {
 public:
  ImageIntegrand(const Image& image, Extent plane, Interpolation interpolation = Interpolation::nearest);

  void evaluate(std::span<const Vec2f> position, std::span<float> values) const override;
  std::uint32_t channels() const override { return image_.channels; }
  Extent plane() const override { return plane_; }

 private:
  const Image& image_;
  Extent plane_;
  Interpolation interpolation_;
};

}  // namespace abn::harness
