// Voronoi cells of points on a torus, one at a time.
//
// A cell is the plane's rectangle around its point, clipped by the bisector towards every other point, near ones first.
// A point farther away than twice the cell's farthest vertex cannot touch the cell (its bisector lies beyond that
// vertex), so the search through a grid of buckets stops there: the cell is exact for any density contrast, without a
// triangulation. The method is Rycroft's (2009, "Voro++: a three-dimensional Voronoi cell library in C++") in the
// plane.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sampling/vec.h"

namespace abn {

/// A point or displacement in double [px].
struct Vec2d {
  double x = 0;
  double y = 0;
  friend constexpr bool operator==(Vec2d, Vec2d) = default;
};

/// One cell: a convex polygon around its point, counter-clockwise in axes x right, y up (clockwise on an image, whose y
/// points down). Without vertices if the cell is empty. Vertices that coincide (four points on a circle) are possible.
struct VoronoiCell {
  std::vector<double> x, y;              // vertices relative to the point [px]
  std::vector<std::uint32_t> neighbour;  // the point across the edge from vertex k to k+1; itself if that is its image

  std::size_t size() const { return x.size(); }
  bool empty() const { return x.empty(); }
  /// [px^2], >= 0 up to rounding; 0 if empty.
  double area() const;
  /// Relative to the point [px]; 0 if the cell is empty or has no area.
  Vec2d centroid() const;
  /// Distance of the farthest vertex from the point [px]; 0 if empty.
  double farthest_vertex() const;
};

/// The cells of `count` points on a torus; together they cover the plane. Positions are copied.
///
/// Of coincident points the one of the lowest index owns the cell, the others have empty ones. Points closer together
/// than the rounding of a vertex (about 1e-16 of the cell's size) may have an empty cell too. Any count is possible,
/// also points on a line, and one or two points, whose neighbours are images of each other or of themselves.
class PeriodicVoronoi {
 public:
  /// `positions` [px]; those outside the plane are wrapped onto it. Throws ConfigError for a position that is not
  /// finite, a plane without area, or 2^32 points and more.
  PeriodicVoronoi(std::span<const Vec2f> positions, Extent plane);
  /// The same on a plane of any size: width, height > 0 [px]; width = height = 1 is the unit torus.
  PeriodicVoronoi(std::span<const Vec2d> positions, double width, double height);

  std::size_t size() const { return position_.size(); }
  /// The position of point i as wrapped onto the plane [px].
  Vec2d position(std::size_t i) const { return position_[i]; }
  /// All points, ordered such that neighbours in the list are mostly neighbours on the plane: the order in which to ask
  /// for many cells, because of the caches.
  std::span<const std::uint32_t> order() const { return index_; }

  /// The cell of point i < size() into `out`, whose storage is used again. May be called from many threads, each with
  /// its own `out`; the result depends on nothing but the points.
  void cell(std::size_t i, VoronoiCell& out) const;

 private:
  struct Axis {
    double length = 1;       // [px]
    double bucket = 1;       // side of a bucket [px]
    std::int32_t count = 1;  // buckets
    std::int32_t bucket_of(double position) const;
  };

  void build();

  Axis x_;
  Axis y_;
  std::vector<Vec2d> position_;              // [count]
  std::vector<std::uint32_t> bucket_begin_;  // [buckets + 1], into the two below
  std::vector<Vec2d> sorted_;                // [count], positions bucket by bucket
  std::vector<std::uint32_t> index_;         // [count], whose they are
  std::vector<bool> owner_;                  // [count], whether it has a cell: all but later coincident points
};

}  // namespace abn
