#include "sampling/analysis/harmonic_products.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "sampling/vector_clones.h"

namespace abn::analysis {
namespace {

// Panels: the widths of the largest register tile (8 rows x three vectors of 8), which the smaller tiles divide.
constexpr std::size_t kRowPanel = 8;
constexpr std::size_t kColumnPanel = 24;
constexpr std::size_t kBlock = 128;   // points: a row and a column panel together are 32 kB, a core's first cache
constexpr std::size_t kRestart = 48;  // harmonics between two library sines; both panels divide it

struct Rotation {
  double c, s;
};

// exp(2 pi i k phase) of the exactly reduced phase: the rounding of the product is put back.
Rotation rotation(double k, double phase) {
  const double turns = k * phase;
  const double lost = std::fma(k, phase, -turns);
  const double angle = 2 * std::numbers::pi * ((turns - std::nearbyint(turns)) + lost);
  return {std::cos(angle), std::sin(angle)};
}

// out[0..count) = a * b[0..count)
[[gnu::always_inline]] inline void rotate(Rotation a, const double* b_cos, const double* b_sin, std::size_t count,
                                          double* out_cos, double* out_sin) {
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i) {
    out_cos[i] = a.c * b_cos[i] - a.s * b_sin[i];
    out_sin[i] = a.c * b_sin[i] + a.s * b_cos[i];
  }
}

// The padded harmonics of `points` phases in panels of kPanel: cosines to table[panel][point][kPanel], sines likewise
// behind them. `padded` is a multiple of kPanel.
template <std::size_t kPanel>
[[gnu::always_inline]] inline void fill(const double* phase, std::size_t first, std::size_t end, std::size_t step,
                                        std::size_t padded, double* table) {
  static_assert(kRestart % kPanel == 0);
  double power_cos[kRestart];  // of the 0th, 1st, ... harmonic, by doubling
  double power_sin[kRestart];
  for (std::size_t j = first; j < end; ++j) {
    const auto one_step = static_cast<double>(step);
    const Rotation w = rotation(one_step, phase[j]);
    power_cos[0] = 1;
    power_sin[0] = 0;
    power_cos[1] = w.c;
    power_sin[1] = w.s;
    for (std::size_t known = 2; known < kRestart; known *= 2) {
      const std::size_t half = known / 2;
      const Rotation next = {power_cos[half] * power_cos[half] - power_sin[half] * power_sin[half],
                             2 * power_cos[half] * power_sin[half]};
      rotate(next, power_cos, power_sin, std::min(known, kRestart - known), power_cos + known, power_sin + known);
    }
    for (std::size_t start = 0; start < padded; start += kRestart) {
      const Rotation origin = start == 0 ? Rotation{1, 0} : rotation(one_step * static_cast<double>(start), phase[j]);
      for (std::size_t k = 0; k < kRestart && start + k < padded; k += kPanel) {
        double* cosines = table + (start + k) * kBlock + j * kPanel;
        rotate(origin, power_cos + k, power_sin + k, kPanel, cosines, cosines + padded * kBlock);
      }
    }
  }
}

ABN_VECTOR_CLONES
void fill_rows(const double* phase, std::size_t first, std::size_t end, std::size_t step, std::size_t padded,
               double* table) {
  fill<kRowPanel>(phase, first, end, step, padded, table);
}

ABN_VECTOR_CLONES
void fill_columns(const double* phase, std::size_t first, std::size_t end, std::size_t step, std::size_t padded,
                  double* table) {
  fill<kColumnPanel>(phase, first, end, step, padded, table);
}

// sums[kRows][kVectors * kWidth] += rows^T * columns over the points of a block, held in registers meanwhile.
template <std::size_t kWidth, std::size_t kRows, std::size_t kVectors>
[[gnu::always_inline]] inline void multiply_tile(const double* rows, const double* columns, std::size_t points,
                                                 double* sums, std::size_t stride) {
  typedef double Vector __attribute__((vector_size(kWidth * sizeof(double))));
  typedef double Unaligned __attribute__((vector_size(kWidth * sizeof(double)), aligned(8), may_alias));
  Vector sum[kRows][kVectors] = {};
  for (std::size_t j = 0; j < points; ++j) {
    Vector column[kVectors];
#pragma GCC unroll 8
    for (std::size_t v = 0; v < kVectors; ++v) {
      column[v] = *reinterpret_cast<const Unaligned*>(columns + j * kColumnPanel + v * kWidth);
    }
#pragma GCC unroll 8
    for (std::size_t r = 0; r < kRows; ++r) {
      const double row = rows[j * kRowPanel + r];
#pragma GCC unroll 8
      for (std::size_t v = 0; v < kVectors; ++v) sum[r][v] += row * column[v];
    }
  }
#pragma GCC unroll 8
  for (std::size_t r = 0; r < kRows; ++r) {
#pragma GCC unroll 8
    for (std::size_t v = 0; v < kVectors; ++v) {
      *reinterpret_cast<Unaligned*>(sums + r * stride + v * kWidth) += sum[r][v];
    }
  }
}

// One row panel times all column panels.
template <std::size_t kWidth, std::size_t kRows, std::size_t kVectors>
[[gnu::always_inline]] inline void multiply_panel(const double* rows, const double* columns, std::size_t points,
                                                  double* sums, std::size_t stride) {
  static_assert(kRowPanel % kRows == 0 && kColumnPanel % (kVectors * kWidth) == 0);
  for (std::size_t c = 0; c < stride; c += kColumnPanel) {
    for (std::size_t part = 0; part < kColumnPanel; part += kVectors * kWidth) {
      for (std::size_t r = 0; r < kRowPanel; r += kRows) {
        multiply_tile<kWidth, kRows, kVectors>(rows + r, columns + c * kBlock + part, points,
                                               sums + r * stride + c + part, stride);
      }
    }
  }
}

void multiply_baseline(const double* rows, const double* columns, std::size_t points, double* sums,
                       std::size_t stride) {
  multiply_panel<2, 4, 2>(rows, columns, points, sums, stride);
}

#if defined(__x86_64__) && defined(__GNUC__)
[[gnu::target("avx2")]] void multiply_avx2(const double* rows, const double* columns, std::size_t points, double* sums,
                                           std::size_t stride) {
  multiply_panel<4, 4, 2>(rows, columns, points, sums, stride);
}
[[gnu::target("avx512f")]] void multiply_avx512(const double* rows, const double* columns, std::size_t points,
                                                double* sums, std::size_t stride) {
  multiply_panel<8, 8, 3>(rows, columns, points, sums, stride);
}
#endif

using MultiplyPanel = void (*)(const double*, const double*, std::size_t, double*, std::size_t);

MultiplyPanel multiply_with(VectorUnit unit) {
  switch (unit) {
#if defined(__x86_64__) && defined(__GNUC__)
    case VectorUnit::avx512:
      return multiply_avx512;
    case VectorUnit::avx2:
      return multiply_avx2;
#endif
    default:
      return multiply_baseline;
  }
}

constexpr std::size_t round_up(std::size_t n, std::size_t panel) { return (n + panel - 1) / panel * panel; }

}  // namespace

std::vector<VectorUnit> vector_units() {
  std::vector<VectorUnit> units = {VectorUnit::baseline};
#if defined(__x86_64__) && defined(__GNUC__)
  if (__builtin_cpu_supports("avx2")) units.push_back(VectorUnit::avx2);
  if (__builtin_cpu_supports("avx512f")) units.push_back(VectorUnit::avx512);
#endif
  return units;
}

std::string to_string(VectorUnit unit) {
  return unit == VectorUnit::avx512 ? "avx512" : unit == VectorUnit::avx2 ? "avx2" : "baseline";
}

HarmonicProducts::HarmonicProducts(Harmonics rows, Harmonics columns, VectorUnit unit)
    : rows_(rows),
      columns_(columns),
      unit_(unit),
      padded_rows_(round_up(rows.count, kRowPanel)),
      padded_columns_(round_up(columns.count, kColumnPanel)),
      row_table_(2 * padded_rows_ * kBlock / 8),
      column_table_(2 * padded_columns_ * kBlock / 8),
      sums_(4 * padded_rows_ * padded_columns_ / 8) {
  assert(rows.count >= 1 && rows.step >= 1 && columns.count >= 1 && columns.step >= 1);
}

void HarmonicProducts::add(std::span<const double> row_phase, std::span<const double> column_phase) {
  assert(row_phase.size() == column_phase.size());
  const MultiplyPanel multiply = multiply_with(unit_);
  const std::size_t stride = 2 * padded_columns_;
  double* row_table = row_table_[0].value;  // the lines are one array
  double* column_table = column_table_[0].value;
  double* sums = sums_[0].value;
  const auto panels = static_cast<std::int64_t>(2 * padded_rows_ / kRowPanel);
  constexpr std::size_t kFillAtOnce = 16;  // points
#pragma omp parallel
  for (std::size_t first = 0; first < row_phase.size(); first += kBlock) {
    const std::size_t points = std::min(kBlock, row_phase.size() - first);
    const auto fills = static_cast<std::int64_t>((points + kFillAtOnce - 1) / kFillAtOnce);
#pragma omp for schedule(static)
    for (std::int64_t f = 0; f < fills; ++f) {
      const std::size_t begin = static_cast<std::size_t>(f) * kFillAtOnce;
      const std::size_t end = std::min(begin + kFillAtOnce, points);
      fill_rows(&row_phase[first], begin, end, rows_.step, padded_rows_, row_table);
      fill_columns(&column_phase[first], begin, end, columns_.step, padded_columns_, column_table);
    }
#pragma omp for schedule(static)
    for (std::int64_t p = 0; p < panels; ++p) {
      const std::size_t row = static_cast<std::size_t>(p) * kRowPanel;
      multiply(row_table + row * kBlock, column_table, points, sums + row * stride, stride);
    }
  }
}

}  // namespace abn::analysis
