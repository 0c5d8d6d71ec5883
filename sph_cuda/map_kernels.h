// The kernels of the maps that an adaptive plane follows; what each does to a cell is in map_rules.h.
#pragma once

#include <cmath>
#include <cstdint>

#include "sampling/adaptive/map_rules.h"
#include "sampling/hd.h"
#include "sampling/vec.h"
#include "sph_cuda/sum_kernels.h"

namespace abn::sph_cuda {

/// 1-2-1 along the rows of a map, mirrored at its border.
struct BlurAlong {
  const float* from;
  float* to;
  std::uint32_t width;
  ABN_HD void operator()(std::uint32_t i) const {
    const std::uint32_t x = i % width;
    to[i] = blurred(from[x > 0 ? i - 1 : i], from[i], from[x + 1 < width ? i + 1 : i]);
  }
};
/// And across them.
struct BlurAcross {
  const float* from;
  float* to;
  std::uint32_t width, cells;
  ABN_HD void operator()(std::uint32_t i) const {
    to[i] = blurred(from[i >= width ? i - width : i], from[i], from[cells - i > width ? i + width : i]);
  }
};

/// A value of a map, for sums.
struct LoadCell {
  const float* map;
  using Value = double;
  ABN_HD Value operator()(std::uint32_t i) const { return static_cast<double>(map[i]); }
};
struct LoadRoot {
  const float* map;
  using Value = double;
  ABN_HD Value operator()(std::uint32_t i) const { return std::sqrt(static_cast<double>(map[i])); }
};
struct LoadPower {
  const float* map;
  double exponent;
  using Value = double;
  ABN_HD Value operator()(std::uint32_t i) const { return driver_power(static_cast<double>(map[i]), exponent); }
};

/// Mixes two drivers into the first one. The sums are those of LoadPower over each.
struct MixDrivers {
  float* a;
  const float* b;
  const double* sum_a;
  const double* sum_b;
  double cells, share, exponent;
  ABN_HD void operator()(std::uint32_t i) const {
    a[i] = both_drivers(a[i], b[i], part(1 - share, *sum_a), part(share, *sum_b), exponent);
  }

 private:
  ABN_HD double part(double share_of_it, double sum) const { return sum > 0 ? share_of_it * cells / sum : 0; }
};

struct WeighDriver {
  const float* driver;
  const double* sum;
  double cells, floor, exponent;
  float* weight;
  ABN_HD void operator()(std::uint32_t i) const {
    weight[i] = density_weight(driver[i], floor * (*sum / cells), exponent);
  }
};

/// What is known of a map before it is filled, for sums.
struct LoadRange {
  const float* weight;
  const float* have;
  using Value = MapRange;
  ABN_HD Value operator()(std::uint32_t i) const {
    MapRange range;
    range.have = static_cast<double>(have[i]);
    range.largest = weight[i];
    if (weight[i] > 0) range.smallest = weight[i];
    return range;
  }
};
struct LoadRangeOfChunk {
  const MapRange* total;
  using Value = MapRange;
  ABN_HD Value operator()(std::uint32_t i) const { return total[i]; }
};
/// One thread.
struct BeginSearch {
  FillSearch* search;
  const MapRange* range;
  double wanted, most;
  ABN_HD void operator()(std::uint32_t) const { *search = FillSearch(*range, wanted, most); }
};
struct LoadFilled {
  const FillSearch* search;
  const float* weight;
  const float* have;
  using Value = double;
  ABN_HD Value operator()(std::uint32_t i) const {
    if (search->done) return 0;  // nobody looks at the sum
    return static_cast<double>(filled(search->scale, weight[i], have[i], search->most));
  }
};
/// One thread.
struct TakeSum {
  FillSearch* search;
  const double* sum;
  ABN_HD void operator()(std::uint32_t) const { search->take(*sum); }
};
struct FillMap {
  const FillSearch* search;
  const float* weight;
  const float* have;
  float* density;
  ABN_HD void operator()(std::uint32_t i) const {
    density[i] = filled(search->scale, weight[i], have[i], search->most);
  }
};

/// The deficits in the order in which points are dealt, for the prefix.
struct LoadDeficit {
  const float* wanted;
  const float* have;
  StripOrder order;
  std::uint32_t width;
  ABN_HD double operator()(std::uint32_t k) const {
    const StripOrder::Cell cell = order.cell(k);
    const std::uint64_t i = std::uint64_t{cell.y} * width + cell.x;
    return deficit(wanted[i], have[i]);
  }
};
struct LoadOne {
  ABN_HD double operator()(std::uint32_t) const { return 1; }
};

/// The points of one cell.
struct DealPoints {
  DeficitDraw draw;
  StripOrder order;
  const double* before;  // [cells + 1]
  Vec2f* point;          // [draw.count]
  ABN_HD void operator()(std::uint32_t k) const {
    const StripOrder::Cell cell = order.cell(k);
    const std::uint64_t end = draw.until(before[k + 1]);
    for (std::uint64_t p = draw.until(before[k]); p < end; ++p) point[p] = draw.point(p, cell);
  }
};

struct FindSpacing {
  const float* density;
  float least;
  float* spacing;
  ABN_HD void operator()(std::uint32_t i) const { spacing[i] = spacing_for(density[i], least); }
};

}  // namespace abn::sph_cuda
