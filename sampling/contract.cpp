#include "sampling/contract.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace abn {
namespace {

/// Two feedbacks that differ in every number: what a sampler that must not look would be misled by.
enum class Shown { kFlat, kWild };

struct Run {
  PointSet set;
  bool empty_for_ever = true;
};

Run draw(const Strategy& strategy, const SamplingTask& task, const ParameterWords& words, Shown shown) {
  Grid<PixelStats> pixels(task.plane);
  Run run;
  std::vector<float> values;
  const auto sampler = strategy.make(task, words);
  for (;;) {
    const SampleBatch batch = sampler->next({pixels, values});
    if (batch.empty()) break;
    run.set.position.insert(run.set.position.end(), batch.position.begin(), batch.position.end());
    run.set.weight.insert(run.set.weight.end(), batch.weight.begin(), batch.weight.end());
    run.set.pixel.insert(run.set.pixel.end(), batch.pixel.begin(), batch.pixel.end());
    if (run.set.position.size() > task.budget) break;  // a strategy that never ends must not hang the check
    values.resize(batch.position.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = shown == Shown::kFlat ? 0.5F : static_cast<float>(i % 7);
    for (std::size_t i = 0; i < pixels.cells().size(); ++i) {
      pixels[i].add(shown == Shown::kFlat ? 0.5F : static_cast<float>((i * 2654435761U) % 101));
    }
  }
  if (run.set.position.size() <= task.budget) {
    run.empty_for_ever = sampler->next({pixels, values}).empty() && sampler->next({pixels, values}).empty();
  }
  return run;
}

bool same(const PointSet& a, const PointSet& b) {
  return a.position == b.position && a.weight == b.weight && a.pixel == b.pixel;
}

}  // namespace

PointSet draw_all(const Strategy& strategy, const SamplingTask& task, const ParameterWords& words) {
  return draw(strategy, task, words, Shown::kFlat).set;
}

std::vector<std::string> contract_breaches(const Strategy& strategy, const SamplingTask& task,
                                           const ParameterWords& words) {
  std::vector<std::string> breaches;
  const auto require = [&](bool kept, const std::string& sentence) {
    if (!kept) breaches.push_back(sentence);
  };
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const Run first = draw(strategy, task, words, Shown::kFlat);
  omp_set_num_threads(2);
  const Run second = draw(strategy, task, words, Shown::kFlat);
  omp_set_num_threads(threads);
  const PointSet& set = first.set;

  require(set.position.size() == task.budget,
          "emits " + std::to_string(set.position.size()) + " samples instead of " + std::to_string(task.budget));
  require(first.empty_for_ever, "emits samples after its end");
  require(set.pixel.empty() || set.pixel.size() == set.position.size(), "gives an owner pixel for some samples only");
  require(set.weight.empty() || set.weight.size() == set.position.size(), "gives a weight for some samples only");
  require(same(set, second.set), "gives other samples on 2 threads than on 1");

  const auto inside = [&](Vec2f p) {
    return p.x >= 0 && p.y >= 0 && p.x < static_cast<float>(task.plane.width) &&
           p.y < static_cast<float>(task.plane.height);
  };
  bool finite = true;
  bool contained = true;
  for (const Vec2f p : set.position) {
    finite = finite && std::isfinite(p.x) && std::isfinite(p.y);
    contained = contained && (inside(p) || !set.pixel.empty());
  }
  for (const std::uint32_t pixel : set.pixel) contained = contained && pixel < task.plane.area();
  require(finite, "emits a position that is not finite");
  require(contained, "emits a position outside the plane without an owner pixel");

  // A constant image c: sum(w c) / sum(w) must be c, so every weight must be finite and every sum positive.
  double weight_sum = 0;
  bool weights_finite = true;
  for (const float w : set.weight) {
    weights_finite = weights_finite && std::isfinite(w);
    weight_sum += static_cast<double>(w);
  }
  require(weights_finite && (set.weight.empty() || weight_sum > 0),
          "gives weights that cannot reproduce a constant image");

  if (!strategy.info.adaptive) {
    require(same(set, draw(strategy, task, words, Shown::kWild).set), "looks at feedback although it is not adaptive");
  }
  if (strategy.info.random) {
    SamplingTask other = task;
    other.seed = task.seed + 1;
    require(!same(set, draw(strategy, other, words, Shown::kFlat).set), "gives the same samples for another seed");
  }
  return breaches;
}

}  // namespace abn
