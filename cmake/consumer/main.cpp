// An outside program that uses the installed library: 96 multi-jittered samples on a 4 x 4 plane.
#include <cstdio>

#include "sampling/strategy.h"

int main() {
  abn::ParameterWords words;
  const auto sampler = abn::find_strategy("multijitter", words).make({.plane = {4, 4}, .budget = 96, .seed = 1}, words);
  const abn::Grid<abn::PixelStats> nothing({4, 4});
  std::size_t samples = 0;
  for (auto batch = sampler->next({nothing}); !batch.empty(); batch = sampler->next({nothing}))
    samples += batch.position.size();
  std::printf("%zu samples\n", samples);
  return samples == 96 ? 0 : 1;
}
