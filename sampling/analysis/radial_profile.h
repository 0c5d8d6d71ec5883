// What a spectrum looks like regardless of direction, and the numbers blue noise is ranked by.
#pragma once

#include <cstddef>
#include <vector>

#include "sampling/analysis/periodogram.h"

namespace abn::analysis {

/// Statistics over rings of width 1: ring k holds the frequencies whose length rounds to k, k = 1..reach; index 0, the
/// constant, holds zeros. P(-f) = P(f), so each pair counts once.
struct RadialProfile {
  std::size_t count = 0;                 // N, points per set
  int sets = 0;                          // K
  std::vector<std::size_t> frequencies;  // [reach + 1] pairs of the ring
  std::vector<double> mean;              // [reach + 1] mean power over ring and sets; white noise: 1
  std::vector<double> standard_error;    // [reach + 1] of `mean`, from the spread of the sets' ring means; NaN if K = 1
  std::vector<double> anisotropy_db;     // [reach + 1] 10 log10(variance / mean^2) over the ring of the power averaged
                                         // over the sets (Ulichney 1987); -infinity for a constant, NaN for no power
  double isotropic_db = 0;               // -10 log10 K, the anisotropy of a set without preferred directions
  double low_power = 0;                  // mean power over 0 < |f| < sqrt(N)/2; NaN if there is no such frequency
  double low_power_error = 0;            // its standard error over the sets; NaN if K = 1

  int reach() const { return static_cast<int>(mean.size()) - 1; }
};

/// Collects sets one by one: the memory does not grow with their number.
class RadialAverage {
 public:
  /// Throws ConfigError as PeriodogramMean::add does.
  void add(const Periodogram& set);
  /// At least one set.
  RadialProfile profile() const;
  /// The average itself, for pictures.
  const PeriodogramMean& periodogram() const { return average_; }

 private:
  struct Spread {  // Welford 1962
    double mean = 0;
    double squares = 0;
    void add(double value, int n);
    double standard_error(int n) const;
  };
  PeriodogramMean average_;
  std::vector<Spread> rings_;
  Spread low_;
};

/// The highest frequency that still has next to no power beneath it, relative to sqrt(N)/2, the Nyquist frequency of
/// the square lattice of N points (Heck, Schloesser, Deussen 2013, "Blue noise sampling with controlled aliasing").
/// With C(nu) = (1/nu^2) integral_0^nu 2 P(f) f df, the mean power inside a disc, by the trapezoidal rule over the
/// rings: from sqrt(N)/2 upwards to the first C > 0.5, from there back to the first C < 0.1 at nu*; the result is
/// (nu*/2) / (sqrt(N)/2). 0 if there is none (white noise); steps of 1/sqrt(N). Step blue noise cannot exceed 0.564.
/// Throws ConfigError if the reach is below 1.5 sqrt(N), where C of any set has come near 1.
double effective_nyquist(const RadialProfile& profile);

/// Omega = 10 sqrt(mean of (P - 1)^2 over the ring area from nu0 to nu1) (Heck et al. 2013): how much the spectrum
/// rings above nu0, the lowest frequency with P >= 0.98 (the highest peak if there is none). nu1 = nu0 + 5 sqrt(N), cut
/// at the reach: take a reach of 6 sqrt(N), and compare values of equal reach / sqrt(N) only. White noise over K sets
/// has not 0 but about 10 / sqrt(K pi nu1 / 2). Throws ConfigError if the reach is below 1.5 sqrt(N).
double oscillation(const RadialProfile& profile);

/// The ring with the largest mean power: its power and its frequency relative to sqrt(N).
struct Peak {
  double power = 0;
  double frequency = 0;
};
Peak spectral_peak(const RadialProfile& profile);

/// Mean of anisotropy_db over the rings 2..reach that have one [dB].
double mean_anisotropy_db(const RadialProfile& profile);

}  // namespace abn::analysis
