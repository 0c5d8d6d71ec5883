// The table of pixel filters: what a pixel's value is a weighted average of.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sampling/vec.h"

namespace abn {

/// A filter f(x,y) around the centre of a pixel, normalised to integral 1; lengths in [px]. Immutable, thread-safe.
/// Separable, f = g(x) g(y) on the square |x|,|y| <= radius, unless it is a disc: f = c exp(-r^2 / 2 sigma^2) for
/// r <= radius.
class PixelFilter {
 public:
  virtual ~PixelFilter() = default;
  /// Canonical, every parameter spelled out: "gaussian:sigma=0.5,radius=1.5,support=square". make_filter() reads it.
  virtual std::string words() const = 0;
  virtual double radius() const = 0;      // half the side of the square it covers [px]; at most 8
  virtual bool non_negative() const = 0;  // false: no density to draw samples from
  virtual bool disc() const { return false; }
  /// f at (x,y) from the pixel's centre [px]; 0 beyond the radius.
  virtual double value(double x, double y) const = 0;
  /// g at x, integral 1 over [-radius,radius]; even, except that the box is half open as pixels are. Precondition for
  /// these three: not disc().
  virtual double profile(double x) const = 0;
  /// Integral of g from -radius to x, to 1e-14; 0 and 1 beyond.
  virtual double integral(double x) const = 0;
  /// x with integral(x) = u in [0,1], to 1e-8; monotone. Precondition: non_negative().
  virtual double inverse(double u) const = 0;
};

/// A row of the table.
struct FilterRow {
  std::string name;        // as typed after --filter
  std::string summary;     // one sentence
  std::string parameters;  // "sigma=0.5 radius=1.5", defaults; empty if it has none
};

/// The table, in the order of `abn list filters`: box, triangle, gaussian, mitchell, lanczos.
const std::vector<FilterRow>& filters();

/// The filter of "NAME" or "NAME:KEY=VALUE,KEY=VALUE". Throws ConfigError that names key, value and remedy.
std::shared_ptr<const PixelFilter> make_filter(std::string_view words);

}  // namespace abn
