// make_ghost_ring() on a device of relaxation.h.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sampling/hd.h"
#include "sampling/sph/draw.h"
#include "sampling/sph/ghost_band.h"
#include "sampling/sph/stepping_solver.h"
#include "sph_cuda/kernels.h"
#include "sph_cuda/prefix.h"
#include "sph_cuda/relaxation.h"
#include "sph_cuda/sum_in_turn.h"

namespace abn::sph_cuda {

/// The densities of every segment of every row of the grid, added up.
struct SumSegments {
  sph::GhostBand band;
  sph::BandGrid grid;
  double* sum;  // [rows * segments]
  ABN_HD void operator()(std::uint32_t i) const {
    const std::uint32_t row = i / grid.segments();
    const std::uint32_t begin = i % grid.segments() * sph::BandGrid::segment;
    double total = 0;
    for (std::uint32_t column = begin; column < begin + sph::BandGrid::segment && column < grid.columns; ++column) {
      total += grid.density(band, column, row);
    }
    sum[i] = total;
  }
};
struct SumSegmentsOfRow {
  const double* segment;
  std::uint32_t segments;
  double* sum;  // [rows]
  ABN_HD void operator()(std::uint32_t row) const {
    double total = 0;
    for (std::uint32_t k = 0; k < segments; ++k) total += segment[std::size_t{row} * segments + k];
    sum[row] = total;
  }
};
/// SumInTurn with one block.
struct RowsOfBand {
  const double* row;
  std::uint32_t rows;
  double* sum;
  ABN_HD std::uint32_t count(std::uint32_t) const { return rows; }
  ABN_HD double value(std::uint32_t, std::uint32_t i) const { return row[i]; }
  ABN_HD void store(std::uint32_t, double total) const { *sum = total; }
};

/// What the cells of the drawing hold, in the order of their curve.
struct FindMasses {
  sph::GhostBand band;
  sph::DrawCells cells;
  double* mass;
  ABN_HD void operator()(std::uint32_t i) const {
    const sph::UnitPosition centre = cells.centre(cells.corner(i));
    mass[i] = band.density(centre.x, centre.y);
  }
};
struct MassOfCell {
  const double* mass;
  ABN_HD double operator()(std::uint32_t i) const { return mass[i]; }
};

/// draw_by_density() with one point a piece; and whether a point is held.
struct DrawBand {
  sph::GhostBand band;
  sph::DrawCells cells;
  std::uint32_t cell_count;
  const double* before;  // [cells + 1]
  std::uint32_t count;   // points
  std::uint64_t seed;
  float* x;  // [count] each, on the torus
  float* y;
  std::uint8_t* fixed;
  std::uint32_t* held;  // how many; 0 before
  ABN_HD void operator()(std::uint32_t i) const {
    const double scale = before[cell_count] / static_cast<double>(count);
    const double mass = sph::drawn_mass(seed, i, i, 1, scale);
    const std::uint64_t cell = sph::cell_of_mass(before, cell_count, mass, 0);
    const sph::UnitPosition unit = cells.place(cells.corner(cell).rounded(), seed, i);
    const double at_x = unit.x * band.length_x;
    const double at_y = unit.y * band.length_y;
    x[i] = sph::wrap(static_cast<float>(at_x), static_cast<float>(band.length_x));
    y[i] = sph::wrap(static_cast<float>(at_y), static_cast<float>(band.length_y));
    const bool stays = band.held(at_x, at_y);
    fixed[i] = stays ? 1 : 0;
    if (stays) add_atomically(held, 1);
  }
};

/// 1 for what lies outside of the plane; and those places.
struct FlagRing {
  sph::GhostBand band;
  const float* x;
  const float* y;
  std::uint32_t count;
  std::uint32_t* outside;  // [count + 1]
  ABN_HD void operator()(std::uint32_t i) const {
    outside[i] = i < count && !band.in_plane(static_cast<double>(x[i]), static_cast<double>(y[i])) ? 1 : 0;
  }
};
struct GatherRing {
  const float* x;
  const float* y;
  const std::uint32_t* place;  // [count + 1]
  float* ring_x;
  float* ring_y;
  ABN_HD void operator()(std::uint32_t i) const {
    if (place[i + 1] == place[i]) return;
    ring_x[place[i]] = x[i];
    ring_y[place[i]] = y[i];
  }
};

template <class Device>
class GhostEngine {
 public:
  explicit GhostEngine(Device& device) : device_(device) {}

  /// The number of ghosts. The problem has walls and its field, whose raster is `cells`, on the device (null if it is
  /// uniform); it has no ring yet. Throws DeviceError as Relaxation does.
  std::uint32_t find(const sph::Setup& setup, const sph::Problem& problem, const sph::FieldCell* cells) {
    const sph::GhostBand around = sph::ghost_band(problem, cells);
    sph::Problem band = sph::problem_of_band(problem);
    band.particles = expected_particles(problem.field, around);
    const sph::Setup relaxation = sph::setup_of_band(setup, problem);
    relaxation_.reset(relaxation, band, band.particles, cells);  // throws if there are too many
    const auto count = static_cast<std::uint32_t>(band.particles);
    const std::uint32_t held = draw(around, count, setup.seed);
    sph::RelaxControl control =
        sph::relax_control(relaxation, band.terms.classed, count - held, setup.ghost_steps, false);
    relaxation_.run(control);

    for (auto* buffer : {&all_x_, &all_y_, &x_, &y_}) buffer->reset(count);
    relaxation_.store(all_x_.data(), all_y_.data());
    for (auto* buffer : {&outside_, &place_}) buffer->reset(std::size_t{count} + 1);
    device_.prepare_sums(count + 1);
    device_.launch(count + 1, FlagRing{around, all_x_.data(), all_y_.data(), count, outside_.data()});
    device_.exclusive_sum(outside_.data(), place_.data(), count + 1);
    device_.launch(count, GatherRing{all_x_.data(), all_y_.data(), place_.data(), x_.data(), y_.data()});
    return place_.download_at(count, 1)[0];
  }

  /// Where they are [d] on the torus, on the device, in the order of the host's ring; until the next call.
  const float* x() const { return x_.data(); }
  const float* y() const { return y_.data(); }

 private:
  template <class T>
  using Buffer = typename Device::template Buffer<T>;

  std::uint64_t expected_particles(const sph::SizeField& field, const sph::GhostBand& around) {
    const sph::BandGrid grid(field);
    const std::uint32_t segments = grid.rows * grid.segments();
    segment_.reset(segments);
    row_.reset(grid.rows);
    sum_.reset(1);
    device_.launch(segments, SumSegments{around, grid, segment_.data()});
    device_.launch(grid.rows, SumSegmentsOfRow{segment_.data(), grid.segments(), row_.data()});
    device_.launch_blocks(1, SumInTurn<RowsOfBand>{{row_.data(), grid.rows, sum_.data()}});
    return grid.particles(field, sum_.download(1)[0]);
  }

  /// Into the relaxation; returns how many are held.
  std::uint32_t draw(const sph::GhostBand& around, std::uint32_t count, std::uint64_t seed) {
    const sph::DrawCells cells(around.length_x / around.length_y, count);
    const auto cell_count = static_cast<std::uint32_t>(cells.size());
    mass_.reset(cell_count);
    device_.launch(cell_count, FindMasses{around, cells, mass_.data()});
    prefix_.find(device_, cell_count, MassOfCell{mass_.data()});
    held_.reset(1);
    device_.launch(1, Fill<std::uint32_t>{held_.data(), 0});
    device_.launch(count, DrawBand{around, cells, cell_count, prefix_.before(), count, seed, relaxation_.x(),
                                   relaxation_.y(), relaxation_.fixed(), held_.data()});
    return held_.download(1)[0];
  }

  Device& device_;
  Relaxation<Device> relaxation_{device_};
  Prefix<Device> prefix_;
  Buffer<double> segment_, row_, sum_, mass_;
  Buffer<float> all_x_, all_y_, x_, y_;
  Buffer<std::uint32_t> held_, outside_, place_;
};

}  // namespace abn::sph_cuda
