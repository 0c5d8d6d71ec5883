#include "sampling/pixel_filter.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <mutex>
#include <numbers>
#include <utility>

#include "sampling/error.h"
#include "sampling/inverse_table.h"
#include "sampling/params.h"

namespace abn {
namespace {

constexpr double pi = std::numbers::pi;

/// What all but the disc have in common: f = g(x) g(y), g even, its integral antisymmetric around (0, 1/2).
class Separable : public PixelFilter {
 public:
  double value(double x, double y) const final { return profile(x) * profile(y); }
  double integral(double x) const final {
    if (x <= -radius()) return 0;
    if (x >= radius()) return 1;
    return x <= 0 ? left_integral(x) : 1 - left_integral(-x);
  }
  double inverse(double u) const final {
    assert(non_negative());
    if (!(u > 0)) return -radius();
    if (u >= 1) return radius();
    return u <= 0.5 ? left_inverse(u) : -left_inverse(1 - u);
  }

 protected:
  virtual double left_integral(double x) const = 0;  // x in (-radius, 0]

 private:
  virtual double left_inverse(double u) const = 0;  // u in (0, 1/2]
};

class Box final : public Separable {
 public:
  std::string words() const override { return "box"; }
  double radius() const override { return 0.5; }
  bool non_negative() const override { return true; }
  // Half open, as pixels are: every sample lies in exactly one.
  double profile(double x) const override { return x >= -0.5 && x < 0.5 ? 1 : 0; }

 private:
  double left_integral(double x) const override { return x + 0.5; }
  double left_inverse(double u) const override { return u - 0.5; }
};

class Triangle final : public Separable {
 public:
  Triangle(std::string words, double radius) : words_(std::move(words)), radius_(radius) {}
  std::string words() const override { return words_; }
  double radius() const override { return radius_; }
  bool non_negative() const override { return true; }
  double profile(double x) const override { return std::max(0.0, 1 - std::abs(x) / radius_) / radius_; }

 private:
  double left_integral(double x) const override {
    const double t = 1 + x / radius_;
    return t * t / 2;
  }
  double left_inverse(double u) const override { return radius_ * (std::sqrt(2 * u) - 1); }

  std::string words_;
  double radius_;
};

/// A filter whose inverse has no formula: a table, built when the first inverse is asked for.
class Tabulated : public Separable {
 private:
  double left_inverse(double u) const final {
    const auto integral = [this](double x) { return left_integral(x); };
    const auto density = [this](double x) { return profile(x); };
    std::call_once(built_, [&] { table_.build(radius(), integral, density); });
    return table_(u, integral, density);
  }

  mutable std::once_flag built_;
  mutable InverseTable table_;
};

class Gaussian final : public Tabulated {
 public:
  Gaussian(std::string words, double sigma, double radius)
      : words_(std::move(words)),
        radius_(radius),
        scale_(1 / (sigma * std::numbers::sqrt2)),
        whole_(std::erf(radius * scale_)),
        tail_(std::erfc(radius * scale_)),
        half_(0.5 / whole_),
        peak_(2 * half_ * scale_ * std::numbers::inv_sqrtpi) {}
  std::string words() const override { return words_; }
  double radius() const override { return radius_; }
  bool non_negative() const override { return true; }
  double profile(double x) const override {
    if (std::abs(x) > radius_) return 0;
    const double t = x * scale_;
    return peak_ * std::exp(-t * t);
  }

 private:
  // Whichever of the two keeps its digits: erfc in the tail, erf where sigma is wider than the radius.
  double left_integral(double x) const override {
    return half_ * (whole_ < 0.5 ? whole_ - std::erf(-x * scale_) : std::erfc(-x * scale_) - tail_);
  }

  std::string words_;
  double radius_, scale_, whole_, tail_, half_, peak_;
};

/// Mitchell and Netravali 1988, eq. 8: piecewise cubic, integral 1 for every B and C.
class Mitchell final : public Tabulated {
 public:
  Mitchell(std::string words, double b, double c)
      : words_(std::move(words)),
        // C > 0 makes the outer piece negative near its end; C = 0 keeps both pieces positive.
        non_negative_(c == 0),
        inner_{1 - b / 3, 0, -3 + 2 * b + c, 2 - 1.5 * b - c},
        outer_{4 * b / 3 + 4 * c, -2 * b - 8 * c, b + 5 * c, -b / 6 - c} {}
  std::string words() const override { return words_; }
  double radius() const override { return 2; }
  bool non_negative() const override { return non_negative_; }
  double profile(double x) const override {
    const double t = std::abs(x);
    if (t >= 2) return 0;
    const Cubic& p = t < 1 ? inner_ : outer_;
    const double value = p[0] + t * (p[1] + t * (p[2] + t * p[3]));
    return non_negative_ ? std::max(0.0, value) : value;
  }

 private:
  using Cubic = std::array<double, 4>;

  static double antiderivative(const Cubic& p, double t) {
    return t * (p[0] + t * (p[1] / 2 + t * (p[2] / 3 + t * p[3] / 4)));
  }
  double left_integral(double x) const override {
    if (x > -1) return 0.5 - antiderivative(inner_, -x);
    return antiderivative(outer_, 2) - antiderivative(outer_, -x);
  }

  std::string words_;
  bool non_negative_;
  Cubic inner_, outer_;  // in |x|, constant term first
};

double sinc(double x) {
  const double t = pi * x;
  return std::abs(t) < 1e-4 ? 1 - t * t / 6 : std::sin(t) / t;
}

/// Duchon 1979, Lanczos filtering in one and two dimensions: sinc(x) sinc(x/lobes). Its integral is Gauss-Legendre
/// quadrature over pieces of a quarter pixel: 8 nodes are exact to rounding there.
class Lanczos final : public Tabulated {
 public:
  Lanczos(std::string words, int lobes) : words_(std::move(words)), lobes_(lobes) {
    const auto pieces = static_cast<std::size_t>(4 * lobes);
    before_.assign(pieces + 1, 0);
    for (std::size_t i = 0; i < pieces; ++i) {
      before_[i + 1] = before_[i] + quadrature(start(i), start(i + 1));
    }
    scale_ = 0.5 / before_[pieces];
    for (double& area : before_) area *= scale_;
  }
  std::string words() const override { return words_; }
  double radius() const override { return lobes_; }
  bool non_negative() const override { return lobes_ == 1; }
  double profile(double x) const override { return std::abs(x) >= lobes_ ? 0 : scale_ * sinc(x) * sinc(x / lobes_); }

 private:
  double start(std::size_t piece) const { return 0.25 * static_cast<double>(piece) - lobes_; }
  double quadrature(double from, double to) const {
    constexpr std::array<double, 4> node = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                            0.9602898564975363};
    constexpr std::array<double, 4> weight = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                              0.1012285362903763};
    const double centre = 0.5 * (from + to);
    const double half = 0.5 * (to - from);
    double sum = 0;
    for (std::size_t i = 0; i < node.size(); ++i) {
      const double low = centre - half * node[i];
      const double high = centre + half * node[i];
      sum += weight[i] * (sinc(low) * sinc(low / lobes_) + sinc(high) * sinc(high / lobes_));
    }
    return half * sum;
  }
  double left_integral(double x) const override {
    const auto piece = std::min(static_cast<std::size_t>(4 * (x + lobes_)), before_.size() - 2);
    return before_[piece] + scale_ * quadrature(start(piece), x);
  }

  std::string words_;
  int lobes_;
  double scale_ = 1;
  std::vector<double> before_;  // integral of g up to the start of each piece
};

/// Not separable: only its value is known.
class GaussianDisc final : public PixelFilter {
 public:
  GaussianDisc(std::string words, double sigma, double radius)
      : words_(std::move(words)), radius_(radius), scale_(0.5 / (sigma * sigma)) {
    peak_ = scale_ / (pi * -std::expm1(-scale_ * radius * radius));
  }
  std::string words() const override { return words_; }
  double radius() const override { return radius_; }
  bool non_negative() const override { return true; }
  bool disc() const override { return true; }
  double value(double x, double y) const override {
    const double squared = x * x + y * y;
    return squared <= radius_ * radius_ ? peak_ * std::exp(-scale_ * squared) : 0;
  }
  double profile(double) const override { return not_separable(); }
  double integral(double) const override { return not_separable(); }
  double inverse(double) const override { return not_separable(); }

 private:
  static double not_separable() {
    assert(false && "a disc has no profile");
    return 0;
  }

  std::string words_;
  double radius_, scale_, peak_;
};

constexpr double min_length = 0.01;  // [px]; below it a pixel is a point of the image and the filter's shape is lost
constexpr double max_radius = 8;

/// The parameters of all filters; each row lists its own.
struct Parameters {
  double half_width = 1;  // of the triangle
  double sigma = 0.5;
  double radius = 1.5;  // of the Gaussian
  std::string support = "square";
  double b = 1.0 / 3;
  double c = 1.0 / 3;
  int lobes = 3;
};
using Fields = std::vector<Field<Parameters>>;

using FilterPointer = std::shared_ptr<const PixelFilter>;

/// A row and how its filter is made of its canonical words and its parameters.
struct Maker {
  std::string name, summary;
  Fields fields;
  FilterPointer (*make)(std::string, const Parameters&);
};

/// The parameters of a row after `start`, in the order of its fields: KEY=VALUE, `separator`, KEY=VALUE.
std::string spelled_out(const Fields& fields, const Parameters& parameters, std::string start, char separator) {
  ParameterWords words = echo_parameters(fields, parameters);
  bool first = true;
  for (const auto& field : fields) {
    if (!first) start += separator;
    first = false;
    start += field.name + "=" + words[field.name];
  }
  return start;
}

FilterPointer make_box(std::string, const Parameters&) { return std::make_shared<Box>(); }
FilterPointer make_triangle(std::string words, const Parameters& p) {
  return std::make_shared<Triangle>(std::move(words), p.half_width);
}
FilterPointer make_gaussian(std::string words, const Parameters& p) {
  if (p.support == "disc") return std::make_shared<GaussianDisc>(std::move(words), p.sigma, p.radius);
  return std::make_shared<Gaussian>(std::move(words), p.sigma, p.radius);
}
FilterPointer make_mitchell(std::string words, const Parameters& p) {
  return std::make_shared<Mitchell>(std::move(words), p.b, p.c);
}
FilterPointer make_lanczos(std::string words, const Parameters& p) {
  return std::make_shared<Lanczos>(std::move(words), p.lobes);
}

const std::vector<Maker>& makers() {
  static const std::vector<Maker> table = {
      {"box", "the plain average over the pixel's own square", {}, make_box},
      {"triangle",
       "a tent: weights fall linearly to 0 at the radius",
       {{"radius", &Parameters::half_width, "half its width [px]", min_length, max_radius, {}}},
       make_triangle},
      {"gaussian",
       "exp(-r^2 / 2 sigma^2), cut off at the radius of a square or a disc",
       {{"sigma", &Parameters::sigma, "standard deviation [px]", min_length, 100, {}},
        {"radius", &Parameters::radius, "where it is cut off [px]", min_length, max_radius, {}},
        {"support", &Parameters::support, "what it is cut off by", 0, 0, {"square", "disc"}}},
       make_gaussian},
      {"mitchell",
       "piecewise cubic of radius 2, sharpens a little (Mitchell and Netravali 1988)",
       {{"b", &Parameters::b, "blur; 1 with c=0: cubic B-spline", 0, 1, {}},
        {"c", &Parameters::c, "ringing; 0.5 with b=0: Catmull-Rom", 0, 1, {}}},
       make_mitchell},
      {"lanczos",
       "windowed sinc, the sharpest of them, with negative lobes (Duchon 1979)",
       {{"lobes", &Parameters::lobes, "its radius [px]", 1, max_radius, {}}},
       make_lanczos},
  };
  return table;
}

/// "KEY=VALUE,KEY=VALUE" of the filter `name`.
ParameterWords split_parameters(std::string_view name, std::string_view text) {
  const std::string owner = "filter '" + std::string(name) + "'";
  ParameterWords words;
  for (bool more = true; more;) {
    const auto comma = text.find(',');
    const std::string_view item = text.substr(0, comma);
    const auto equals = item.find('=');
    if (equals == std::string_view::npos || equals == 0 || equals + 1 == item.size()) {
      throw ConfigError(owner + " is followed by '" + std::string(item) + "'; write " + std::string(name) +
                        ":KEY=VALUE,KEY=VALUE");
    }
    const std::string key(item.substr(0, equals));
    if (!words.emplace(key, item.substr(equals + 1)).second) {
      throw ConfigError("parameter '" + key + "' of " + owner + " is given twice; give it once");
    }
    more = comma != std::string_view::npos;
    if (more) text.remove_prefix(comma + 1);
  }
  return words;
}

}  // namespace

const std::vector<FilterRow>& filters() {
  static const std::vector<FilterRow> rows = [] {
    std::vector<FilterRow> list;
    for (const Maker& maker : makers())
      list.push_back({maker.name, maker.summary, spelled_out(maker.fields, {}, "", ' ')});
    return list;
  }();
  return rows;
}

std::shared_ptr<const PixelFilter> make_filter(std::string_view words) {
  const auto colon = words.find(':');
  const std::string_view name = words.substr(0, colon);
  std::string known;
  for (const Maker& maker : makers()) {
    if (maker.name == name) {
      ParameterWords given;
      if (colon != std::string_view::npos) given = split_parameters(name, words.substr(colon + 1));
      const auto parameters = parse_parameters<Parameters>("filter " + maker.name, maker.fields, given);
      const std::string start = maker.fields.empty() ? maker.name : maker.name + ":";
      return maker.make(spelled_out(maker.fields, parameters, start, ','), parameters);
    }
    known += (known.empty() ? "" : ", ") + maker.name;
  }
  throw ConfigError("filter '" + std::string(name) + "' is unknown; known: " + known);
}

}  // namespace abn
