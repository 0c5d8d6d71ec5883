#include "sampling/random.h"

namespace abn {

const StrategyInfo Random::info{
    .name = "random",
    .family = "baseline",
    .summary = "Independent uniform points over the whole plane.",
    .cite = "Metropolis and Ulam 1949, The Monte Carlo method; generator Philox: Salmon et al. 2011",
    .advice = "As the worst case to compare with; its pixels differ in their number of samples.",
};

const StrategyInfo RandomPixel::info{
    .name = "random_pixel",
    .family = "baseline",
    .summary = "Independent uniform points in every pixel, the same number in each.",
    .cite = "Cook 1986, Stochastic sampling in computer graphics; generator Philox: Salmon et al. 2011",
    .advice = "As the baseline of per-pixel strategies: its error is exactly sigma / sqrt(n) of every pixel.",
};

void Random::points(std::uint64_t key, std::uint64_t first, std::uint64_t, std::span<UnitPoint> out) const {
  random_points(key, first, out);
}

void RandomPixel::points(std::uint64_t key, std::uint64_t first, std::uint64_t, std::span<UnitPoint> out) const {
  random_points(key, first, out);
}

}  // namespace abn
