// The one raster type.
#pragma once

#include <cassert>
#include <cstddef>
#include <span>
#include <vector>

#include "sampling/vec.h"

namespace abn {

/// A raster of T, row by row from the top; owns its cells.
template <class T>
class Grid {
 public:
  Grid() = default;
  explicit Grid(Extent size, const T& value = T{}) : size_(size), cells_(size.area(), value) {}

  Extent size() const { return size_; }
  std::size_t index(std::uint32_t x, std::uint32_t y) const {
    assert(x < size_.width && y < size_.height);
    return std::size_t{y} * size_.width + x;
  }
  T& at(std::uint32_t x, std::uint32_t y) { return cells_[index(x, y)]; }
  const T& at(std::uint32_t x, std::uint32_t y) const { return cells_[index(x, y)]; }
  T& operator[](std::size_t i) { return cells_[i]; }
  const T& operator[](std::size_t i) const { return cells_[i]; }
  std::span<T> cells() { return cells_; }              // [width*height]
  std::span<const T> cells() const { return cells_; }  // [width*height]

 private:
  Extent size_;
  std::vector<T> cells_;
};

}  // namespace abn
