// Equal cells over a torus: points sorted into them, and the search for all images of points in a rectangle.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace abn {

/// Cells over [0,length_x) x [0,length_y), numbered row by row, and where in the sorted order the points of each begin.
/// A search for neighbours meets every periodic image in reach, so that no plane is too narrow for it.
class TorusCells {
 public:
  /// Cells of at least the given size, in number at most `points` + 1 or so. All lengths in one unit, > 0.
  TorusCells(float length_x, float length_y, float least_width, float least_height, std::size_t points)
      : length_x_(length_x), length_y_(length_y) {
    const auto most = static_cast<double>(std::max<std::size_t>(points, 1));
    rows_ = fit(std::min(static_cast<double>(length_y) / static_cast<double>(least_height), most));
    columns_ = fit(std::min(static_cast<double>(length_x) / static_cast<double>(least_width), most / rows_));
    columns_per_length_ = static_cast<float>(columns_) / length_x;
    rows_per_length_ = static_cast<float>(rows_) / length_y;
    begin_.assign(size() + 1, 0);
  }

  float length_x() const { return length_x_; }
  float length_y() const { return length_y_; }
  std::size_t columns() const { return static_cast<std::size_t>(columns_); }
  std::size_t size() const { return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_); }

  /// The cell of a point; 0 <= x < length_x, 0 <= y < length_y.
  std::size_t cell(float x, float y) const {
    // The product may round up to the border.
    const auto column = std::min(static_cast<std::int32_t>(x * columns_per_length_), columns_ - 1);
    const auto row = std::min(static_cast<std::int32_t>(y * rows_per_length_), rows_ - 1);
    return static_cast<std::size_t>(row) * columns() + static_cast<std::size_t>(column);
  }

  /// Sorts points into the cells, stable: place[i] becomes the place of point i in the sorted order.
  void sort(std::span<const float> x, std::span<const float> y, std::span<std::uint32_t> place) {
    std::fill(begin_.begin(), begin_.end(), 0U);
    for (std::size_t i = 0; i < place.size(); ++i) {
      place[i] = static_cast<std::uint32_t>(cell(x[i], y[i]));
      ++begin_[place[i] + 1];
    }
    for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
    next_.assign(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t& p : place) p = next_[p]++;
  }

  /// The first place of every cell in the sorted order, with the number of points at the end [size()+1].
  std::span<const std::uint32_t> begin() const { return begin_; }

  /// A bound on what rounding may shift a coordinate against the borders of cells: a search of radius r must look
  /// r + rounding(r) far to miss nothing.
  float rounding(float radius) const {
    return 8 * std::numeric_limits<float>::epsilon() * (std::max(length_x_, length_y_) + radius);
  }

  /// Calls f(begin, end, shift_x, shift_y) for runs of places such that every image, at point + shift, inside the
  /// rectangle [x0,x1] x [y0,y1] (not wrapped) is met exactly once, and some outside. In a fixed order: upwards in y,
  /// then in x.
  template <class F>
  void for_each_run(float x0, float x1, float y0, float y1, F&& f) const {
    const std::int64_t column0 = floor_of(x0 * columns_per_length_);
    const std::int64_t column1 = floor_of(x1 * columns_per_length_);
    const std::int64_t row1 = floor_of(y1 * rows_per_length_);
    for (std::int64_t row = floor_of(y0 * rows_per_length_); row <= row1; ++row) {
      const std::int64_t image_y = image_of(row, rows_);
      const std::uint32_t* start = begin_.data() + static_cast<std::size_t>(row - image_y * rows_) * columns();
      const float shift_y = static_cast<float>(image_y) * length_y_;
      for (std::int64_t column = column0; column <= column1;) {
        const std::int64_t image_x = image_of(column, columns_);
        const std::int64_t last = std::min(column1, image_x * columns_ + columns_ - 1);
        const std::uint32_t first = start[column - image_x * columns_];
        const std::uint32_t end = start[last - image_x * columns_ + 1];
        if (first < end) f(std::size_t{first}, std::size_t{end}, static_cast<float>(image_x) * length_x_, shift_y);
        column = last + 1;
      }
    }
  }

 private:
  static std::int32_t fit(double count) { return static_cast<std::int32_t>(std::clamp(count, 1.0, 1073741824.0)); }
  static std::int64_t floor_of(float scaled) { return static_cast<std::int64_t>(std::floor(scaled)); }
  static std::int64_t image_of(std::int64_t index, std::int32_t count) {
    return index >= 0 ? index / count : -((count - 1 - index) / count);
  }

  float length_x_, length_y_;
  float columns_per_length_ = 1, rows_per_length_ = 1;
  std::int32_t columns_ = 1, rows_ = 1;
  std::vector<std::uint32_t> begin_;
  std::vector<std::uint32_t> next_;  // scratch of the sort
};

}  // namespace abn
