// The kernel that solves the kriging systems, a block per pixel: element by element the operations of
// harness/kriging_solve.cpp in their order, for a single lane.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "sampling/hd.h"
#include "sampling/kriging/kriging_rules.h"
#include "sph_cuda/kriging_gather.h"

namespace abn::sph_cuda {

/// A system in shared memory: the lower triangle, column by column, with five more rows for the right sides. The
/// factorisation makes each element what solving forward makes of it; the diagonal of the factor is kept inverted.
struct SharedSystem {
  enum Right : std::uint32_t { pixel, ones, values, trend_x, trend_y, rights };

  double *gap, *gap_weight;      // [points]
  float *x, *y, *light, *pivot;  // [points]; pivot: sill + nugget
  float* product;                // [products]
  float* ratio;                  // [1], at gaps
  float* element;                // [column + column + ...]
  std::uint32_t n;

  static constexpr std::uint32_t products = 14;
  static constexpr std::size_t bytes(std::size_t points) {
    return 2 * points * sizeof(double) +
           (4 * points + products + 1 + points * (points + 1) / 2 + rights * points) * sizeof(float);
  }
  ABN_HD SharedSystem(void* memory, std::uint32_t points) : n(points) {
    gap = static_cast<double*>(memory);
    gap_weight = gap + n;
    x = static_cast<float*>(static_cast<void*>(gap_weight + n));
    y = x + n;
    light = y + n;
    pivot = light + n;
    product = pivot + n;
    ratio = product + products;
    element = ratio + 1;
  }
  /// column(k)[r] is the element of row r >= k; rows n, n + 1, … are the right sides.
  ABN_HD float* column(std::uint32_t k) const { return element + (k * (n + rights) - k * (k + 1) / 2); }
  ABN_HD float& right(Right side, std::uint32_t k) const { return column(k)[n + side]; }
};

struct SolvePixels {
  static constexpr std::uint32_t threads = 32;

  PixelSystems systems;
  const std::uint32_t* number;  // [blocks]: of the pixels
  SystemPoints points;
  std::uint32_t channels;
  std::uint32_t most_points;  // of these pixels
  EstimateArrays out;

  // Loading, right sides, a column each, scalar products, multiplier, a row each backwards, the estimate.
  ABN_HD int phases(std::uint32_t block) const { return 5 + 2 * static_cast<int>(systems.count[number[block]]); }
  std::size_t shared_bytes() const { return SharedSystem::bytes(most_points); }

  ABN_HD void operator()(int phase, std::uint32_t block, std::uint32_t thread, void* memory) const {
    const std::uint32_t k = number[block];
    const SharedSystem system(memory, systems.count[k]);
    const std::uint32_t first = systems.start[k];
    const std::uint32_t pixel = systems.first_pixel + k;
    const float sill = kriging_rules::sill_for(systems.margin[k]);
    const auto n = static_cast<int>(system.n);
    if (phase == 0) {
      load(system, first, sill, thread);
    } else if (phase == 1) {
      set_right_sides(system, sill, thread);
    } else if (phase < n + 2) {
      factorise(system, static_cast<std::uint32_t>(phase - 2), sill, thread);
    } else if (phase == n + 2) {
      multiply(system, thread);
    } else if (phase == n + 3) {
      finish(system, sill, pixel, thread);
    } else if (phase < 2 * n + 4) {
      solve_backward(system, static_cast<std::uint32_t>(2 * n + 3 - phase), thread);
    } else {
      estimate(system, first, pixel, thread);
    }
  }

 private:
  using System = SharedSystem;

  ABN_HD void load(const System& system, std::uint32_t first, float sill, std::uint32_t thread) const {
    for (std::uint32_t a = thread; a < system.n; a += threads) {
      system.x[a] = points.x[first + a];
      system.y[a] = points.y[first + a];
      system.light[a] = points.luminance[first + a];
      system.pivot[a] = sill + points.nugget[first + a];
    }
  }

  ABN_HD void set_right_sides(const System& system, float sill, std::uint32_t thread) const {
    double mean = 0;
    for (std::uint32_t a = 0; a < system.n; ++a) mean += static_cast<double>(system.light[a]);
    mean /= system.n;
    for (std::uint32_t a = thread; a < system.n; a += threads) {
      system.right(System::pixel, a) = sill - kriging_rules::mean_distance(system.x[a], system.y[a]);
      system.right(System::ones, a) = 1;
      system.right(System::values, a) = static_cast<float>(static_cast<double>(system.light[a]) - mean);
      system.right(System::trend_x, a) = system.x[a] - 0.5F;
      system.right(System::trend_y, a) = system.y[a] - 0.5F;
      const kriging_rules::GapScale own = kriging_rules::gap_scale(system.x, system.y, system.light, system.n, a);
      system.gap[a] = own.scale;
      system.gap_weight[a] = own.weight;
    }
  }

  // Every thread works out the pivot for itself, which saves a barrier.
  ABN_HD void factorise(const System& system, std::uint32_t b, float sill, std::uint32_t thread) const {
    const std::uint32_t rows = system.n + System::rights;
    const std::uint32_t own = b + 1 + thread;  // < rows in any thread that has a row
    float* const column = system.column(b);
    float pivot = system.pivot[b];
    float s = own < rows ? start(system, own, b, sill) : 0.0F;
    for (std::uint32_t k = 0; k < b; ++k) {
      const float* const before = system.column(k);
      const float factor = before[b];
      pivot -= factor * factor;
      if (own < rows) s -= before[own] * factor;
    }
    const float inverse = 1.0F / std::sqrt(pivot > kriging_rules::least_pivot ? pivot : kriging_rules::least_pivot);
    if (thread == 0) column[b] = inverse;
    if (own < rows) column[own] = s * inverse;
    for (std::uint32_t row = own + threads; row < rows; row += threads) {
      s = start(system, row, b, sill);
      for (std::uint32_t k = 0; k < b; ++k) {
        const float* const before = system.column(k);
        s -= before[row] * before[b];
      }
      column[row] = s * inverse;
    }
  }

  // What stands in the matrix, or on its right.
  ABN_HD float start(const System& system, std::uint32_t row, std::uint32_t b, float sill) const {
    if (row >= system.n) return system.column(b)[row];
    const float dx = system.x[row] - system.x[b];
    const float dy = system.y[row] - system.y[b];
    return sill - std::sqrt(dx * dx + dy * dy);
  }

  enum Product : std::uint32_t { pp, po, px, py, oo, ox, oy, xx, xy, yy, zz, zo, zx, zy };

  // The right sides of a product: 3 bits each, p = 0, o = 1, z = 2, x = 3, y = 4.
  ABN_HD static std::uint32_t side(std::uint32_t product, bool second) {
    constexpr std::uint64_t first_sides = 022224331110000ULL;  // octal, from the last product to the first
    constexpr std::uint64_t second_sides = 043124434314310ULL;
    return static_cast<std::uint32_t>((second ? second_sides : first_sides) >> (3 * product)) & 7U;
  }

  ABN_HD void multiply(const System& system, std::uint32_t thread) const {
    if (thread < System::products) {
      const std::uint32_t a = system.n + side(thread, false);
      const std::uint32_t b = system.n + side(thread, true);
      float sum = 0;
      for (std::uint32_t k = 0; k < system.n; ++k) {
        const float* const column = system.column(k);
        sum += column[a] * column[b];
      }
      system.product[thread] = sum;
    } else if (thread == System::products) {
      kriging_rules::GapMean mean;
      for (std::uint32_t k = 0; k < system.n; ++k) mean.add({system.gap[k], system.gap_weight[k]});
      *system.ratio = system.n < kriging_rules::fewest_for_gaps ? 1.0F : mean.ratio(system.n);
    }
  }

  ABN_HD void finish(const System& system, float sill, std::uint32_t pixel, std::uint32_t thread) const {
    const float* const of = system.product;
    const float norm = of[oo] > 0 ? of[oo] : 1.0F;
    const float rest = 1.0F - of[po];
    const float multiplier = rest / norm;  // Lagrange's
    for (std::uint32_t a = thread; a < system.n; a += threads) {
      float* const column = system.column(a);
      column[system.n + System::pixel] += multiplier * column[system.n + System::ones];
    }
    if (thread != 0) return;
    const float variance = sill - kriging_rules::mean_square_distance - of[pp] + rest * rest / norm;
    // Generalised least squares of values on x and y, all freed of their means.
    const float about_xx = of[xx] - of[ox] * of[ox] / norm;
    const float about_xy = of[xy] - of[ox] * of[oy] / norm;
    const float about_yy = of[yy] - of[oy] * of[oy] / norm;
    const float about_zz = of[zz] - of[zo] * of[zo] / norm;
    const float about_zx = of[zx] - of[zo] * of[ox] / norm;
    const float about_zy = of[zy] - of[zo] * of[oy] / norm;
    const auto count = static_cast<float>(system.n);
    const float determinant = about_xx * about_yy - about_xy * about_xy;
    const bool fitted =
        count >= kriging_rules::fewest_for_trend && determinant > kriging_rules::collinear * about_xx * about_yy;
    const float scale = fitted ? 1.0F / determinant : 0.0F;
    const float slope_x = (about_zx * about_yy - about_zy * about_xy) * scale;
    const float slope_y = (about_zy * about_xx - about_zx * about_xy) * scale;
    const float squares = about_zz - slope_x * about_zx - slope_y * about_zy;
    PixelScale known;
    known.unit_variance = variance > kriging_rules::least_variance ? variance : kriging_rules::least_variance;
    known.squares = squares > 0 ? squares : 0.0F;
    known.degrees = count - (fitted ? 3.0F : 1.0F);
    known.trend = slope_x * (of[px] + multiplier * of[ox]) + slope_y * (of[py] + multiplier * of[oy]);
    known.at_gaps = *system.ratio;
    out.scale[pixel] = known;
  }

  // The weight of point a, which then stands in the place of its right side of ones; what comes before it is freed of
  // it.
  ABN_HD void solve_backward(const System& system, std::uint32_t a, std::uint32_t thread) const {
    const float weight = system.right(System::pixel, a) * system.column(a)[a];
    if (thread == 0) system.right(System::ones, a) = weight;
    for (std::uint32_t k = thread; k < a; k += threads) system.right(System::pixel, k) -= system.column(k)[a] * weight;
  }

  // Deviations from the mean are what is weighted, as on the host.
  ABN_HD void estimate(const System& system, std::uint32_t first, std::uint32_t pixel, std::uint32_t thread) const {
    if (thread >= channels) return;
    const float* value = points.value + std::size_t{first} * channels + thread;
    double mean = 0;
    for (std::uint32_t k = 0; k < system.n; ++k) mean += static_cast<double>(value[std::size_t{k} * channels]);
    mean /= system.n;
    double sum = 0;
    for (std::uint32_t k = 0; k < system.n; ++k) {
      sum += static_cast<double>(system.right(System::ones, k)) *
             (static_cast<double>(value[std::size_t{k} * channels]) - mean);
    }
    sum += mean;
    if (const PixelStep* step = step_of(out, pixel); step != nullptr) {
      sum += static_cast<double>(step->share) * static_cast<double>(step->jump[thread]);
    }
    out.value[std::size_t{pixel} * channels + thread] = static_cast<float>(sum);
  }
};

}  // namespace abn::sph_cuda
