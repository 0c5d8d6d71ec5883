#include "sampling/analysis/periodogram.h"

#include <cassert>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "sampling/error.h"

namespace abn::analysis {
namespace {

constexpr int kMaxReach = 4096;  // 2 GB of sums

// Where the power at (u, v) or its mirror image (-u, -v) lies in [reach + 1][2 reach + 1].
std::size_t half_plane_index(int u, int v, int reach) {
  assert(std::abs(u) <= reach && std::abs(v) <= reach);
  const int row = v < 0 ? -v : v;
  const int column = reach + (v < 0 ? -u : u);
  return static_cast<std::size_t>(row) * (2 * static_cast<std::size_t>(reach) + 1) + static_cast<std::size_t>(column);
}

}  // namespace

Periodogram::Periodogram(Points points, int reach, VectorUnit unit) : reach_(reach), count_(points.size()) {
  if (points.empty()) throw ConfigError("periodogram: the set has no points; give at least 1");
  if (reach < 1 || reach > kMaxReach) {
    throw ConfigError("periodogram: reach " + std::to_string(reach) + " is outside [1, " + std::to_string(kMaxReach) +
                      "]; give a highest frequency in cycles per side");
  }
  std::vector<double> x;
  std::vector<double> y;
  x.reserve(count_);
  y.reserve(count_);
  for (const Point p : points) {
    x.push_back(p.x);
    y.push_back(p.y);
  }
  const auto side = static_cast<std::size_t>(reach) + 1;
  HarmonicProducts sums({side, 1}, {side, 1}, unit);  // rows: v, columns: u
  sums.add(y, x);

  power_.resize(side * (2 * side - 1));
  const auto n = static_cast<double>(count_);
#pragma omp parallel for schedule(static)
  for (std::int64_t row = 0; row < static_cast<std::int64_t>(side); ++row) {
    const auto v = static_cast<std::size_t>(row);
    double* same = &power_[v * (2 * side - 1) + side - 1];  // u >= 0; the mirrored signs lie before it
    for (std::size_t u = 0; u < side; ++u) {
      const double cc = sums.cos_cos(v, u);
      const double ss = sums.sin_sin(v, u);
      const double cs = sums.cos_sin(v, u);
      const double sc = sums.sin_cos(v, u);
      // sum of cos and sin of 2 pi (v y + u x), and of 2 pi (v y - u x)
      same[u] = ((cc - ss) * (cc - ss) + (sc + cs) * (sc + cs)) / n;
      *(same - u) = ((cc + ss) * (cc + ss) + (sc - cs) * (sc - cs)) / n;
    }
  }
}

double Periodogram::power(int u, int v) const { return power_[half_plane_index(u, v, reach_)]; }

void PeriodogramMean::add(const Periodogram& set) {
  if (sets_ == 0) {
    reach_ = set.reach_;
    count_ = set.count_;
    sum_.assign(set.power_.size(), 0.0);
  }
  if (set.reach_ != reach_ || set.count_ != count_) {
    throw ConfigError("periodogram: a set of " + std::to_string(set.count_) + " points with reach " +
                      std::to_string(set.reach_) + " cannot be averaged with sets of " + std::to_string(count_) +
                      " points with reach " + std::to_string(reach_) + "; give sets of equal size");
  }
  ++sets_;
  for (std::size_t i = 0; i < sum_.size(); ++i) sum_[i] += set.power_[i];
}

double PeriodogramMean::power(int u, int v) const {
  assert(sets_ >= 1);
  return sum_[half_plane_index(u, v, reach_)] / sets_;
}

}  // namespace abn::analysis
