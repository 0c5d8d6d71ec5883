#include "sampling/gbn.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "sampling/relaxation_start.h"
#include "sampling/torus_cells.h"
#include "sampling/vector_clones.h"

namespace abn {
namespace {

constexpr std::size_t lanes = 8;
constexpr std::size_t chunk_size = 1024;               // points whose statistics are summed together
constexpr std::size_t parallel_from = 4 * chunk_size;  // below, starting threads costs more than it saves
constexpr float cell_width = 0.5F;                     // [spacings]: a search is a few rows, cut close at the ends
constexpr float cell_height = 2.5F;
constexpr float largest_move = 0.5F;  // per iteration [spacings]: half a step towards a neighbour

/// Eight points, seen from one image of the plane, and their sums over others.
struct alignas(lanes * sizeof(float)) Block {
  float x[lanes], y[lanes];
};
struct alignas(lanes * sizeof(float)) Sums {
  float energy[lanes]{}, x[lanes]{}, y[lanes]{};
};

ABN_VECTOR_CLONES void add_overlaps(const float* x, const float* y, std::size_t begin, std::size_t end,
                                    const Block& block, Sums& sums) {
  Sums local = sums;
  for (std::size_t j = begin; j < end; ++j) {
    const float xj = x[j];
    const float yj = y[j];
#pragma omp simd
    for (std::size_t k = 0; k < lanes; ++k) {
      const float dx = block.x[k] - xj;
      const float dy = block.y[k] - yj;
      const float overlap = gaussian_overlap(dx * dx + dy * dy);
      local.energy[k] += overlap;
      local.x[k] += overlap * dx;
      local.y[k] += overlap * dy;
    }
  }
  sums = local;
}

float wrap(float x, float length) {
  if (x < 0 || x >= length) x -= length * std::floor(x / length);
  return x < length ? x : 0.0F;
}

/// The descent. Points live in spacings, sorted into cells; eight consecutive ones of a row of cells are summed
/// together, one in each lane, each by one thread and in the order of the search.
class Descent {
 public:
  Descent(const std::vector<Vec2f>& positions, Extent plane)
      : n_(positions.size()),
        spacing_(std::sqrt(static_cast<double>(plane.area()) / static_cast<double>(n_))),
        cells_(static_cast<float>(plane.width / spacing_), static_cast<float>(plane.height / spacing_), cell_width,
               cell_height, n_),
        now_(n_),
        next_(n_),
        place_(n_),
        chunks_((n_ + chunk_size - 1) / chunk_size) {
    for (std::size_t i = 0; i < n_; ++i) {
      now_.x[i] = wrap(static_cast<float>(double{positions[i].x} / spacing_), cells_.length_x());
      now_.y[i] = wrap(static_cast<float>(double{positions[i].y} / spacing_), cells_.length_y());
      now_.id[i] = static_cast<std::uint32_t>(i);
    }
  }

  /// One iteration; returns the energy per point before it.
  double move(const GaussianDescent& descent, GaussianReport& report) {
    const auto step = static_cast<float>(descent.step);
    const auto momentum = static_cast<float>(descent.momentum);
    sort();
    for_each_sum([&](Chunk& chunk, std::size_t i, float energy, float gx, float gy) {
      chunk.energy += static_cast<double>(energy);
      float vx = momentum * now_.vx[i] + step * gx;
      float vy = momentum * now_.vy[i] + step * gy;
      float length = std::sqrt(vx * vx + vy * vy);
      if (!std::isfinite(length)) {
        vx = vy = length = 0;
        ++chunk.non_finite;
      }
      if (length > largest_move) {
        vx *= largest_move / length;
        vy *= largest_move / length;
        length = largest_move;
      }
      now_.vx[i] = vx;
      now_.vy[i] = vy;
      next_.x[i] = wrap(now_.x[i] + vx, cells_.length_x());
      next_.y[i] = wrap(now_.y[i] + vy, cells_.length_y());
      chunk.displacement += static_cast<double>(length);
    });
    std::swap(now_.x, next_.x);
    std::swap(now_.y, next_.y);
    double displacement = 0;
    for (const Chunk& chunk : chunks_) {
      displacement += chunk.displacement;
      report.non_finite += chunk.non_finite;
    }
    report.mean_displacement = displacement / static_cast<double>(n_);
    return mean_energy();
  }

  double energy() {
    sort();
    for_each_sum(
        [](Chunk& chunk, std::size_t, float energy, float, float) { chunk.energy += static_cast<double>(energy); });
    return mean_energy();
  }

  void copy_out(std::vector<Vec2f>& positions, Extent plane) const {
    for (std::size_t i = 0; i < n_; ++i) {
      positions[now_.id[i]] = {wrap_to_plane(static_cast<double>(now_.x[i]) * spacing_, plane.width),
                               wrap_to_plane(static_cast<double>(now_.y[i]) * spacing_, plane.height)};
    }
  }

 private:
  /// A point per index; x and y are padded so that a block may read past the end.
  struct Points {
    explicit Points(std::size_t n) : x(n + lanes), y(n + lanes), vx(n), vy(n), id(n) {}
    std::vector<float> x, y;    // [spacings], in the box
    std::vector<float> vx, vy;  // the last move
    std::vector<std::uint32_t> id;
  };

  /// A cache line each, because threads write neighbouring chunks at the same time.
  struct alignas(64) Chunk {
    double energy = 0;
    double displacement = 0;
    std::uint64_t non_finite = 0;
  };

  void sort() {
    cells_.sort(std::span(now_.x).first(n_), std::span(now_.y).first(n_), place_);
    for (std::size_t i = 0; i < n_; ++i) {
      const std::size_t place = place_[i];
      next_.x[place] = now_.x[i];
      next_.y[place] = now_.y[i];
      next_.vx[place] = now_.vx[i];
      next_.vy[place] = now_.vy[i];
      next_.id[place] = now_.id[i];
    }
    std::swap(now_, next_);
  }

  double mean_energy() const {
    double energy = 0;
    for (const Chunk& chunk : chunks_) energy += chunk.energy;
    return energy / static_cast<double>(n_);
  }

  /// Calls f(chunk, i, energy, gradient_x, gradient_y) for every point; needs sort() first. The gradient is
  /// -d/dx_i of half the sum over all pairs.
  template <class F>
  void for_each_sum(F&& f) {
    const std::size_t columns = cells_.columns();
    const auto cell_begin = cells_.begin();
    const auto count = static_cast<std::int64_t>(chunks_.size());
    const float reach = gaussian_reach + cells_.rounding(gaussian_reach);
#pragma omp parallel for schedule(dynamic, 1) if (n_ >= parallel_from)
    for (std::int64_t c = 0; c < count; ++c) {
      const auto number = static_cast<std::size_t>(c);
      chunks_[number] = {};
      const std::size_t end = std::min(n_, (number + 1) * chunk_size);
      std::size_t row = cells_.cell(now_.x[number * chunk_size], now_.y[number * chunk_size]) / columns;
      for (std::size_t i = number * chunk_size; i < end;) {
        while (cell_begin[(row + 1) * columns] <= i) ++row;
        const std::size_t stop = std::min<std::size_t>({end, cell_begin[(row + 1) * columns], i + lanes});
        const auto [left, right] = std::minmax_element(&now_.x[i], &now_.x[i] + (stop - i));
        const auto [top, bottom] = std::minmax_element(&now_.y[i], &now_.y[i] + (stop - i));
        Sums sums;
        cells_.for_each_run(*left - reach, *right + reach, *top - reach, *bottom + reach,
                            [&](std::size_t first, std::size_t last, float shift_x, float shift_y) {
                              Block block;
                              for (std::size_t k = 0; k < lanes; ++k) {
                                block.x[k] = now_.x[i + k] - shift_x;
                                block.y[k] = now_.y[i + k] - shift_y;
                              }
                              add_overlaps(now_.x.data(), now_.y.data(), first, last, block, sums);
                            });
        for (std::size_t k = 0; i < stop; ++i, ++k) f(chunks_[number], i, sums.energy[k], sums.x[k], sums.y[k]);
      }
    }
  }

  std::size_t n_;
  double spacing_;  // [px]
  TorusCells cells_;
  Points now_, next_;
  std::vector<std::uint32_t> place_;  // scratch of the sort
  std::vector<Chunk> chunks_;
};

}  // namespace

GaussianReport relax_gaussian(std::vector<Vec2f>& positions, Extent plane, const GaussianDescent& descent) {
  GaussianReport report;
  if (positions.empty()) return report;
  Descent state(positions, plane);
  for (int i = 0; i < descent.iterations && !report.converged; ++i) {
    const double energy = state.move(descent, report);
    if (i == 0) report.first_energy = energy;
    report.iterations = i + 1;
    report.converged = report.mean_displacement < descent.tolerance;
  }
  report.energy = state.energy();
  if (report.iterations == 0) report.first_energy = report.energy;
  state.copy_out(positions, plane);
  return report;
}

const StrategyInfo Gbn::info = {
    .name = "gbn",
    .family = "blue noise",
    .summary = "Gaussian blue noise: the least power at low frequencies, by gradient descent of a Gaussian energy.",
    .cite = "Ahmed, Ren, Wonka 2022, Gaussian blue noise",
    .advice = "Where the error of smooth parts matters most; its points lie less evenly than those of sph_blue_noise.",
};

std::vector<Field<Gbn::Params>> Gbn::fields() {
  return {
      {"iterations", &Params::iterations, "iterations, at most", 0, 1000000},
      {"step", &Params::step, "step along the gradient; above (1 + momentum) / 2.3 it overshoots", 0.0, 10.0},
      {"momentum", &Params::momentum, "share of the last move that is made again; 0 = plain descent", 0.0, 0.99},
      {"tolerance", &Params::tolerance, "stop early when the mean move is below [spacings]; 0 = never stop early", 0.0,
       1.0},
      start_field<Params>(),
  };
}

Gbn::Gbn(const SamplingTask& task, const Params& params) : task_(task), params_(params) {
  require_budget(info.name, task.budget, std::numeric_limits<std::uint32_t>::max());
}

SampleBatch Gbn::next(const Feedback&) {
  if (samples_.empty()) {
    std::vector<Vec2f> positions = relaxation_start(params_.start, task_.plane, task_.budget, task_.seed);
    report_ = relax_gaussian(positions, task_.plane,
                             {.step = params_.step,
                              .momentum = params_.momentum,
                              .iterations = params_.iterations,
                              .tolerance = params_.tolerance});
    samples_.assign(positions, task_.plane);
  }
  return samples_.next();
}

std::vector<Diagnostic> Gbn::diagnostics() const {
  if (samples_.empty()) return {};
  Diagnostic dropped{"non_finite", static_cast<double>(report_.non_finite)};
  if (report_.non_finite > 0) {
    dropped.text = "moves of points were not finite and were dropped; a smaller step is stable";
    dropped.warning = true;
  }
  Diagnostic moving{"mean_displacement", report_.mean_displacement};
  if (report_.iterations >= 10 && report_.mean_displacement > 0.1) {
    moving.text = "the points still move by more than a tenth of a spacing; a smaller step or momentum is stable";
    moving.warning = true;
  }
  return {
      {"iterations", static_cast<double>(report_.iterations)},
      moving,
      {"first_energy", report_.first_energy},
      {"energy", report_.energy},
      {"converged", report_.converged ? 1.0 : 0.0},
      dropped,
      {"backend", 0, "cpu"},
  };
}

}  // namespace abn
