#include "harness/apple_analytic.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace abn::harness {

namespace {

// ---- Vectors; also used as RGB colours.
struct Vec3 {
  double x = 0, y = 0, z = 0;
};
Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec3 operator*(Vec3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
Vec3 operator*(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec3 normalized(Vec3 a) { return a * (1.0 / std::sqrt(dot(a, a))); }
Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
Vec3 mix(Vec3 a, Vec3 b, double t) { return a * (1.0 - t) + b * t; }
Vec3 reflected(Vec3 direction, Vec3 normal) { return direction - normal * (2.0 * dot(direction, normal)); }

struct Ray {
  Vec3 origin, direction;  // direction has length 1
  Vec3 at(double t) const { return origin + direction * t; }
};

// ---- Functions that a library would round in its own way.

/// The angle of (x, y) in turns, in [-½, ½], within 2.5e-4 turns. Rajan et al. 2006, "Efficient approximations for the
/// arctangent function", eq. 9.
double angle_in_turns(double y, double x) {
  const double ax = std::abs(x), ay = std::abs(y);
  const double larger = std::max(ax, ay);
  if (larger == 0.0) return 0.0;
  const double ratio = std::min(ax, ay) / larger;
  double turns = ratio * (0.125 + (1.0 - ratio) * (0.038946 + 0.010552 * ratio));  // of the first octant
  if (ay > ax) turns = 0.25 - turns;
  if (x < 0.0) turns = 0.5 - turns;
  return y < 0.0 ? -turns : turns;
}

/// A smooth wave of period 1 between 0 and 1.
double wave(double t) {
  const double fold = std::abs(2.0 * (t - std::floor(t)) - 1.0);
  return fold * fold * (3.0 - 2.0 * fold);
}

double fifth_power(double x) { return x * x * x * x * x; }

/// Schlick's approximation of the Fresnel factor (Schlick 1994) between `facing` and facing + `grazing`.
double fresnel_factor(double cosine, double facing, double grazing) {
  return facing + grazing * fifth_power(1.0 - cosine);
}

// ---- The shape, in units in which the apple is about two high; y is up, the floor is y = 0.

constexpr double ring_radius = 0.62;   // the apple is a torus whose tube is wider than its ring:
constexpr double tube_radius = 0.95;   // the overlap makes a dimple at both poles
constexpr double apple_centre = 0.95;  // height of the ring: the apple stands on the floor
constexpr double taper = 0.10;         // narrower towards the bottom

constexpr double stalk_foot = 1.55, stalk_length = 0.95;  // the foot is inside the apple
constexpr Vec3 stalk_lean{0.24, 0.0, 0.08};               // of its tip
constexpr double stalk_radius = 0.045, stalk_tip_growth = 0.03;

constexpr Vec3 bound_centre{0.0, 1.25, 0.0};  // a sphere round apple and stalk
constexpr double bound_radius = 1.90;

// The fields below are no exact distances; these factors keep a step from crossing the surface.
constexpr double apple_safety = 0.85, stalk_safety = 0.80;
constexpr double hit_distance = 1e-6;
constexpr int most_steps = 400;
constexpr double surface_offset = 2e-3;  // where a ray that leaves a surface starts
constexpr double gradient_step = 1e-4;

enum class Part { apple, stalk };

/// The apple's cross-section: coordinates of a point round the tube's centre.
struct TubePoint {
  double outward, up;
};
TubePoint tube_point(Vec3 p) {
  const double width = 1.0 + taper * (p.y - 1.0);
  return {std::sqrt(p.x * p.x + p.z * p.z) / width - ring_radius, p.y - apple_centre};
}

double apple_distance(Vec3 p) {
  const TubePoint t = tube_point(p);
  return (std::sqrt(t.outward * t.outward + t.up * t.up) - tube_radius) * apple_safety;
}

double stalk_distance(Vec3 p) {
  const double along = std::clamp((p.y - stalk_foot) / stalk_length, 0.0, 1.0);
  const Vec3 axis{stalk_lean.x * along * along, stalk_foot + stalk_length * along, stalk_lean.z * along};
  const Vec3 offset = p - axis;
  const double radius = stalk_radius + stalk_tip_growth * along * along;
  return (std::sqrt(dot(offset, offset)) - radius) * stalk_safety;
}

double distance(Vec3 p) { return std::min(apple_distance(p), stalk_distance(p)); }

Vec3 normal_at(Vec3 p) {
  const double h = gradient_step;
  return normalized({distance({p.x + h, p.y, p.z}) - distance({p.x - h, p.y, p.z}),
                     distance({p.x, p.y + h, p.z}) - distance({p.x, p.y - h, p.z}),
                     distance({p.x, p.y, p.z + h}) - distance({p.x, p.y, p.z - h})});
}

struct Hit {
  bool found = false;
  double t = 0;
};

/// The first point of apple or stalk on a ray, by sphere tracing (Hart 1996).
Hit trace_apple(const Ray& ray) {
  const Vec3 from_bound = ray.origin - bound_centre;
  const double middle = -dot(from_bound, ray.direction);
  const double chord = middle * middle - dot(from_bound, from_bound) + bound_radius * bound_radius;
  if (!(chord > 0.0)) return {};
  const double half = std::sqrt(chord);
  const double end = middle + half;
  double t = std::max(middle - half, 0.0);
  for (int step = 0; step < most_steps && t < end; ++step) {
    const double free = distance(ray.at(t));
    if (free < hit_distance) return {true, t};
    t += free;
  }
  return {};
}

// ---- Light and material. Constants are chosen so that no value exceeds 1.

const Vec3 to_sun = normalized({0.55, 0.75, -0.36});
constexpr Vec3 sun{1.12, 1.05, 0.92};
constexpr Vec3 skylight{0.22, 0.26, 0.34};
constexpr Vec3 floor_glow{0.16, 0.145, 0.13};
constexpr Vec3 sky_horizon{0.86, 0.80, 0.76}, sky_zenith{0.30, 0.44, 0.78};
constexpr double softbox_cosine = 0.985;  // a bright disc round the sun's direction, seen in mirrors only
constexpr double softbox = 4.5;

constexpr double check_size = 0.62;
constexpr Vec3 dark_check{0.020, 0.018, 0.020}, light_check{0.78, 0.76, 0.74};

constexpr Vec3 skin_green{0.37, 0.48, 0.05}, skin_yellow{0.56, 0.57, 0.12};
constexpr double streaks = 17.0;                           // round the apple
constexpr double speckle_columns = 36, speckle_rows = 22;  // round the apple, round the tube
constexpr double speckle_radius_squared = 0.012;           // [cells^2]
constexpr Vec3 speckle{0.70, 0.69, 0.46};
constexpr Vec3 bark{0.16, 0.075, 0.035};

constexpr int most_reflections = 2;

/// Sky as seen by the camera (`mirrored` false) or by a reflected ray.
Vec3 sky(Vec3 direction, bool mirrored) {
  const Vec3 colour = mix(sky_horizon, sky_zenith, std::clamp(direction.y, 0.0, 1.0));
  return mirrored && dot(direction, to_sun) > softbox_cosine ? Vec3{softbox, softbox, softbox} : colour;
}

/// Two numbers in [0.2, 0.8] from a cell's indices: the place of its speckle.
struct CellPoint {
  double u, v;
};
CellPoint speckle_centre(double column, double row) {
  auto bits = static_cast<std::uint32_t>(static_cast<std::int32_t>(column)) * 73856093U ^
              static_cast<std::uint32_t>(static_cast<std::int32_t>(row)) * 19349663U;
  bits ^= bits >> 13;
  bits *= 0x5BD1E995U;
  bits ^= bits >> 15;
  return {0.2 + 0.6 / 1023.0 * (bits & 1023U), 0.2 + 0.6 / 1023.0 * (bits >> 10 & 1023U)};
}

Vec3 apple_skin(Vec3 p) {
  const TubePoint t = tube_point(p);
  const double around = angle_in_turns(p.z, p.x), round_tube = angle_in_turns(t.up, t.outward);
  const double u = around * speckle_columns, v = round_tube * speckle_rows;
  const double column = std::floor(u), row = std::floor(v);
  const CellPoint centre = speckle_centre(column, row);
  const double du = u - column - centre.u, dv = v - row - centre.v;
  if (du * du + dv * dv < speckle_radius_squared) return speckle;
  const double streak = wave(streaks * around + 0.4 * wave(5.0 * round_tube));
  return mix(skin_green, skin_yellow, 0.35 * streak + 0.5 * wave(3.0 * around + round_tube) * wave(2.0 * around));
}

Vec3 shade(const Ray& ray, int reflections);

Vec3 shade_apple(const Ray& ray, double t, int reflections) {
  const Vec3 p = ray.at(t), n = normal_at(p);
  const Part part = apple_distance(p) < stalk_distance(p) ? Part::apple : Part::stalk;
  const Vec3 outside = p + n * surface_offset;
  double facing_sun = std::max(dot(n, to_sun), 0.0);
  if (facing_sun > 0.0 && trace_apple({outside, to_sun}).found) facing_sun = 0.0;
  const double upward = 0.5 + 0.5 * n.y;
  const Vec3 albedo = part == Part::apple ? apple_skin(p) : bark;
  const Vec3 colour = albedo * (sun * facing_sun + mix(floor_glow, skylight, upward));
  if (part == Part::stalk || reflections >= most_reflections) return colour;
  const double mirror = fresnel_factor(std::clamp(-dot(ray.direction, n), 0.0, 1.0), 0.03, 0.25);
  return colour * (1.0 - mirror) + shade({outside, reflected(ray.direction, n)}, reflections + 1) * mirror;
}

Vec3 shade_floor(const Ray& ray, double t, int reflections) {
  const Vec3 p = ray.at(t);
  const Vec3 above{p.x, 1e-4, p.z};
  // The parity of the sum of two cell numbers, exact as long as doubles hold integers.
  const double cell = std::floor(p.x / check_size) + std::floor(p.z / check_size);
  const bool light = cell - 2.0 * std::floor(cell / 2.0) == 1.0;
  const double facing_sun = trace_apple({above, to_sun}).found ? 0.0 : to_sun.y;
  const Vec3 colour = (light ? light_check : dark_check) * (sun * facing_sun + skylight);
  if (reflections >= most_reflections) return colour;
  const double mirror = fresnel_factor(-ray.direction.y, 0.02, 0.50);
  return mix(colour, shade({above, {ray.direction.x, -ray.direction.y, ray.direction.z}}, reflections + 1), mirror);
}

/// The light that comes back along a ray.
Vec3 shade(const Ray& ray, int reflections) {
  const Hit apple = trace_apple(ray);
  const bool meets_floor = ray.direction.y < -1e-9;
  const double floor_t = meets_floor ? -ray.origin.y / ray.direction.y : 0.0;
  if (apple.found && !(meets_floor && floor_t < apple.t)) return shade_apple(ray, apple.t, reflections);
  if (meets_floor) return shade_floor(ray, floor_t, reflections);
  return sky(ray.direction, reflections > 0);
}

// ---- The camera.

constexpr Vec3 eye{0.0, 3.0, -6.1}, look_at{0.0, 1.32, 0.0};
constexpr double half_view = 0.383864035;  // tangent of 21 degrees

/// Rays through points of the plane; u and v run from -1 to 1 over the plane's width.
class Camera {
 public:
  Ray through(double u, double v) const {
    return {eye, normalized(forward_ + right_ * (u * half_view) + up_ * (-v * half_view))};
  }

 private:
  Vec3 forward_ = normalized(look_at - eye);
  Vec3 right_ = normalized(cross({0.0, 1.0, 0.0}, forward_));
  Vec3 up_ = cross(forward_, right_);
};

}  // namespace

void AppleAnalytic::evaluate(std::span<const Vec2f> position, std::span<float> values) const {
  assert(values.size() == 3 * position.size());
  const Camera camera;
  const double width = plane_.width, height = plane_.height;
  const auto count = static_cast<std::ptrdiff_t>(position.size());
#pragma omp parallel for schedule(dynamic, 64) if (count > 1024)
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const Vec2f p = position[static_cast<std::size_t>(i)];
    const Vec3 colour = shade(camera.through((2.0 * p.x - width) / width, (2.0 * p.y - height) / width), 0);
    float* value = values.data() + 3 * i;
    value[0] = static_cast<float>(colour.x);
    value[1] = static_cast<float>(colour.y);
    value[2] = static_cast<float>(colour.z);
  }
}

Image render_apple_analytic(Extent size) {
  const AppleAnalytic apple(size);
  Image image(size, 3);
  std::vector<Vec2f> centre(size.width);
  const std::size_t row = std::size_t{3} * size.width;
  for (std::uint32_t y = 0; y < size.height; ++y) {
    for (std::uint32_t x = 0; x < size.width; ++x) {
      centre[x] = {static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F};
    }
    apple.evaluate(centre, std::span(image.texels).subspan(y * row, row));
  }
  return image;
}

}  // namespace abn::harness
