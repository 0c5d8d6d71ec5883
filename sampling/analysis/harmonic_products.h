// Sums over points of products of two harmonics: what every exact spectrum of a point set is made of.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace abn::analysis {

/// The multiples 0, step, 2 step, ... (count - 1) step of a phase.
struct Harmonics {
  std::size_t count = 1;  // >= 1
  std::size_t step = 1;   // >= 1
};

/// The vector instructions of the matrix product. All give the same bits: every sum runs over the points in one order
/// and nothing is fused, the variants differ only in how many sums go on side by side.
enum class VectorUnit { baseline, avx2, avx512 };

/// Those of this processor, the best one last.
std::vector<VectorUnit> vector_units();
std::string to_string(VectorUnit unit);

/// With row harmonics a_k = k * rows.step, column harmonics b_l = l * columns.step and pairs of phases (t_j, s_j), the
/// four sums over j of
///   cos(2 pi a_k t_j) cos(2 pi b_l s_j),  sin sin,  cos sin,  sin cos
/// for all k < rows.count, l < columns.count: one real matrix product, as exp(-2 pi i (u x + v y)) separates.
///
/// In double. Every harmonic is at most 48 complex products away from a library sine of the exactly reduced phase,
/// which bounds the error of a term by about 1e-14 whatever the frequency. Points come in blocks of 128 whose tables
/// fit into a core's cache, so the memory does not grow with the number of points. Bit-identical for any number of
/// threads and any VectorUnit. The processor's fused multiply-add would be twice as fast and is not used: results would
/// depend on the processor.
class HarmonicProducts {
 public:
  HarmonicProducts(Harmonics rows, Harmonics columns, VectorUnit unit = vector_units().back());

  /// Adds points; `row_phase` and `column_phase` have equal lengths [turns], |phase| < 2^20.
  void add(std::span<const double> row_phase, std::span<const double> column_phase);

  double cos_cos(std::size_t k, std::size_t l) const { return sum(k, l); }
  double sin_sin(std::size_t k, std::size_t l) const { return sum(padded_rows_ + k, padded_columns_ + l); }
  double cos_sin(std::size_t k, std::size_t l) const { return sum(k, padded_columns_ + l); }
  double sin_cos(std::size_t k, std::size_t l) const { return sum(padded_rows_ + k, l); }

 private:
  struct alignas(64) CacheLine {  // eight numbers: one vector of the widest unit
    double value[8];
  };
  double sum(std::size_t row, std::size_t column) const {
    const std::size_t i = row * 2 * padded_columns_ + column;
    return sums_[i / 8].value[i % 8];
  }

  Harmonics rows_;
  Harmonics columns_;
  VectorUnit unit_;
  std::size_t padded_rows_;              // count rounded up to whole panels; the rest holds harmonics nobody reads
  std::size_t padded_columns_;           // likewise
  std::vector<CacheLine> row_table_;     // [2 * padded_rows][block], in panels: cosines, then sines
  std::vector<CacheLine> column_table_;  // [2 * padded_columns][block], likewise
  std::vector<CacheLine> sums_;          // [2 * padded_rows][2 * padded_columns]
};

}  // namespace abn::analysis
