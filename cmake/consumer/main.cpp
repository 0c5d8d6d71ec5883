// An outside program that uses the installed libraries: 96 multi-jittered samples on a 4 x 4 plane, and their
// distances.
#include <cstdio>
#include <vector>

#include "sampling/analysis/spacing.h"
#include "sampling/strategy.h"

int main() {
  abn::ParameterWords words;
  const auto sampler = abn::find_strategy("multijitter", words).make({.plane = {4, 4}, .budget = 96, .seed = 1}, words);
  const abn::Grid<abn::PixelStats> nothing({4, 4});
  std::vector<abn::Vec2f> samples;
  for (auto batch = sampler->next({nothing}); !batch.empty(); batch = sampler->next({nothing}))
    samples.insert(samples.end(), batch.position.begin(), batch.position.end());
  const auto spacing = abn::analysis::spacing(abn::analysis::to_unit(samples, {4, 4}));
  std::printf("%zu samples, mean nearest neighbour %.3f of the hexagonal lattice's\n", samples.size(), spacing.mean);
  return samples.size() == 96 && spacing.mean > 0.2 && spacing.mean < 1 ? 0 : 1;
}
