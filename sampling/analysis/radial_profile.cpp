#include "sampling/analysis/radial_profile.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>

#include "sampling/error.h"

namespace abn::analysis {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Calls visit(ring, u, v) for one of every two mirrored frequencies inside the outermost ring, without the constant.
template <class Visit>
void for_each_frequency(int reach, Visit visit) {
  for (int v = 0; v <= reach; ++v) {
    for (int u = -reach; u <= reach; ++u) {
      if (v == 0 && u <= 0) continue;
      const auto ring = std::lround(std::sqrt(static_cast<double>(u) * u + static_cast<double>(v) * v));
      if (ring <= reach) visit(static_cast<std::size_t>(ring), u, v);
    }
  }
}

bool is_low(int u, int v, std::size_t count) {  // |f| < sqrt(N) / 2
  return 4 * (static_cast<double>(u) * u + static_cast<double>(v) * v) < static_cast<double>(count);
}

void require_reach(const RadialProfile& profile, const char* what) {
  const double needed = 1.5 * std::sqrt(static_cast<double>(profile.count));
  if (profile.reach() < needed) {
    throw ConfigError(std::string(what) + ": a spectrum up to frequency " + std::to_string(profile.reach()) + " of " +
                      std::to_string(profile.count) + " points ends too early; take a reach of at least " +
                      std::to_string(static_cast<int>(std::ceil(needed))));
  }
}

}  // namespace

void RadialAverage::Spread::add(double value, int n) {
  const double delta = value - mean;
  mean += delta / n;
  squares += delta * (value - mean);
}

double RadialAverage::Spread::standard_error(int n) const { return n < 2 ? kNone : std::sqrt(squares / (n - 1) / n); }

void RadialAverage::add(const Periodogram& set) {
  average_.add(set);
  const auto rings = static_cast<std::size_t>(set.reach()) + 1;
  rings_.resize(rings);
  std::vector<double> sum(rings);
  std::vector<std::size_t> frequencies(rings);
  double low = 0;
  std::size_t low_frequencies = 0;
  for_each_frequency(set.reach(), [&](std::size_t ring, int u, int v) {
    const double power = set.power(u, v);
    sum[ring] += power;
    ++frequencies[ring];
    if (is_low(u, v, set.count())) {
      low += power;
      ++low_frequencies;
    }
  });
  const int n = average_.sets();
  for (std::size_t k = 1; k < rings; ++k) rings_[k].add(sum[k] / static_cast<double>(frequencies[k]), n);
  low_.add(low_frequencies > 0 ? low / static_cast<double>(low_frequencies) : kNone, n);
}

RadialProfile RadialAverage::profile() const {
  assert(average_.sets() >= 1);
  RadialProfile profile;
  profile.count = average_.count();
  profile.sets = average_.sets();
  profile.isotropic_db = -10 * std::log10(profile.sets);
  profile.low_power = low_.mean;
  profile.low_power_error = low_.standard_error(profile.sets);
  const std::size_t rings = rings_.size();
  profile.mean.resize(rings);
  profile.standard_error.resize(rings);
  profile.anisotropy_db.resize(rings);
  profile.frequencies.resize(rings);
  for (std::size_t k = 1; k < rings; ++k) {
    profile.mean[k] = rings_[k].mean;
    profile.standard_error[k] = rings_[k].standard_error(profile.sets);
  }
  std::vector<double> squares(rings);
  for_each_frequency(average_.reach(), [&](std::size_t ring, int u, int v) {
    const double deviation = average_.power(u, v) - profile.mean[ring];
    squares[ring] += deviation * deviation;
    ++profile.frequencies[ring];
  });
  for (std::size_t k = 1; k < rings; ++k) {
    const double variance = squares[k] / static_cast<double>(profile.frequencies[k] - 1);  // ring 1 has four
    const double mean = profile.mean[k];
    profile.anisotropy_db[k] = mean > 0 ? 10 * std::log10(variance / (mean * mean)) : kNone;
  }
  return profile;
}

double effective_nyquist(const RadialProfile& profile) {
  require_reach(profile, "effective Nyquist frequency");
  const double root = std::sqrt(static_cast<double>(profile.count));
  const int reach = profile.reach();
  std::vector<double> disc(static_cast<std::size_t>(reach) + 1);  // C(nu) at nu = 0, 1, ...
  double integral = 0;                                            // of 2 P(f) f; P(0) f = 0
  for (int nu = 1; nu <= reach; ++nu) {
    const auto k = static_cast<std::size_t>(nu);
    integral += profile.mean[k - 1] * (nu - 1) + profile.mean[k] * nu;
    disc[k] = integral / (static_cast<double>(nu) * nu);
  }
  int nu = std::max(1, static_cast<int>(std::ceil(root / 2)));
  while (nu < reach && disc[static_cast<std::size_t>(nu)] <= 0.5) ++nu;
  while (nu > 0 && disc[static_cast<std::size_t>(nu)] >= 0.1) --nu;
  return nu / root;
}

double oscillation(const RadialProfile& profile) {
  require_reach(profile, "oscillation");
  const double root = std::sqrt(static_cast<double>(profile.count));
  const auto begin = profile.mean.begin() + 1;
  auto start = std::find_if(begin, profile.mean.end(), [](double power) { return power >= 0.98; });
  if (start == profile.mean.end()) start = std::max_element(begin, profile.mean.end());
  const auto nu0 = start - profile.mean.begin();
  const auto nu1 = std::min<std::ptrdiff_t>(profile.reach(), nu0 + std::lround(5 * root));
  double sum = 0;
  double area = 0;
  for (std::ptrdiff_t nu = nu0; nu <= nu1; ++nu) {
    const double excess = profile.mean[static_cast<std::size_t>(nu)] - 1;
    sum += excess * excess * static_cast<double>(nu);
    area += static_cast<double>(nu);
  }
  return 10 * std::sqrt(sum / area);
}

Peak spectral_peak(const RadialProfile& profile) {
  const auto peak = std::max_element(profile.mean.begin() + 1, profile.mean.end());
  return {*peak, static_cast<double>(peak - profile.mean.begin()) / std::sqrt(static_cast<double>(profile.count))};
}

double mean_anisotropy_db(const RadialProfile& profile) {
  double sum = 0;
  int rings = 0;
  for (std::size_t k = 2; k < profile.anisotropy_db.size(); ++k) {
    if (!std::isfinite(profile.anisotropy_db[k])) continue;
    sum += profile.anisotropy_db[k];
    ++rings;
  }
  return rings > 0 ? sum / rings : kNone;
}

}  // namespace abn::analysis
