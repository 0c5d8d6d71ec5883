#include "sampling/adaptive/gabriel.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "sampling/adaptive/gabriel_pair.h"
#include "sampling/adaptive/nearest_samples.h"
#include "sampling/sph/fixed_sum.h"
#include "sampling/vector_clones.h"

namespace abn {
namespace {

constexpr int lanes = NearestSamples::lanes;

// Samples handled by one thread at a time.
constexpr std::size_t block_size = 2048;

// The neighbours of one sample, relative to it, filled with zeros to a multiple of 8.
struct Around {
  alignas(32) std::array<float, NearestSamples::most_neighbours> x;
  alignas(32) std::array<float, NearestSamples::most_neighbours> y;
  alignas(32) std::array<float, NearestSamples::most_neighbours> squared;  // length
  alignas(32) std::array<std::int32_t, NearestSamples::most_neighbours> blocked;
};

/// Sets `blocked` [count] for every neighbour k with another one, s, inside the circle over the sample and it. Whatever
/// is inside is nearer than k, so that the neighbours suffice.
ABN_VECTOR_CLONES
void find_blocked(Around& around, int count) {
  around.blocked.fill(0);
  const int filled = (count + 7) / 8 * 8;
  for (int s = 0; s < count; ++s) {
    const float x = around.x[static_cast<std::size_t>(s)];
    const float y = around.y[static_cast<std::size_t>(s)];
    const float squared = around.squared[static_cast<std::size_t>(s)];
#pragma omp simd
    for (int k = 0; k < filled; ++k) {
      const auto i = static_cast<std::size_t>(k);
      around.blocked[i] |= in_circle(x, y, squared, around.x[i], around.y[i], around.squared[i]) ? 1 : 0;
    }
  }
}

/// The samples in the order of cells, so that neighbours lie close in memory, and where each was before.
struct Ordered {
  std::vector<Vec2f> position;
  std::vector<float> value;  // [n * channels]
  std::uint32_t channels = 1;
  std::vector<std::uint32_t> row_begins;  // of the rows of cells, and the end
};

/// An edge of the graph, seen from `a`.
struct Edge {
  std::uint32_t a, b;
};

/// An edge that counts.
struct Pair {
  std::uint32_t a, b;
  float priority;
};

/// Of all values around the mean of their channel.
double standard_deviation(std::span<const float> value, std::uint32_t channels) {
  const std::size_t n = value.size() / channels;
  double sum = 0;
  for (std::uint32_t channel = 0; channel < channels; ++channel) {
    const auto at = [&](std::size_t i) { return double{value[i * channels + channel]}; };
    const double mean = sph::fixed_order_sum(n, at) / static_cast<double>(n);
    sum += sph::fixed_order_sum(n, [&](std::size_t i) {
      const double deviation = at(i) - mean;
      return deviation * deviation;
    });
  }
  return std::sqrt(sum / static_cast<double>(value.size()));
}

/// Edges seen from one block of samples, and what the other end must know to count each of them once.
class Graph {
 public:
  Graph(const Ordered& samples, const NearestSamples& nearest, const GabrielOptions& options)
      : samples_(samples),
        nearest_(nearest),
        neighbours_(options.neighbours),
        least_squared_(static_cast<float>(options.min_length * options.min_length)),
        last_(samples.position.size(), 0),
        activity_(options.activity > 0 ? samples.position.size() : 0, 0) {}

  /// Finds the edges of samples [begin, end), which lie in one row of cells.
  void find(std::size_t begin, std::size_t end, NearestSamples::Search& search, std::vector<Edge>& edges) {
    for (std::size_t first = begin; first < end; first += lanes) {
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const Vec2f at = samples_.position[std::min(first + lane, end - 1)];
        search.x[lane] = at.x;
        search.y[lane] = at.y;
      }
      nearest_.find(neighbours_ + 1, search);
      for (std::size_t lane = 0; lane < std::min<std::size_t>(lanes, end - first); ++lane) {
        find_of(static_cast<std::uint32_t>(first + lane), static_cast<int>(lane), search, edges);
      }
    }
  }

  /// Whether this end of the pair is the one that counts. After all blocks.
  bool counts(Edge edge) const { return counts_from(edge.a, edge.b, squared_length(edge), last_[edge.b]); }

  float squared_length(Edge edge) const {
    const Vec2f d = samples_.position[edge.a] - samples_.position[edge.b];
    return d.x * d.x + d.y * d.y;
  }

  float difference(Edge edge) const { return difference_of(samples_.value.data(), samples_.channels, edge.a, edge.b); }

  /// The largest difference along an edge of a sample; 0 unless asked for.
  float activity(std::uint32_t sample) const { return activity_.empty() ? 0 : activity_[sample]; }

 private:
  void find_of(std::uint32_t sample, int lane, const NearestSamples::Search& search, std::vector<Edge>& edges) {
    std::array<std::uint32_t, NearestSamples::most_neighbours> index;
    Around around;
    around.x.fill(0);
    around.y.fill(0);
    around.squared.fill(0);
    const Vec2f here = samples_.position[sample];
    int count = 0;
    for (int k = 0; k < search.count() && count < neighbours_; ++k) {
      const std::uint32_t other = search.index(lane, k);
      if (other == sample) continue;
      const Vec2f d = samples_.position[other] - here;
      const auto i = static_cast<std::size_t>(count++);
      index[i] = other;
      around.x[i] = d.x;
      around.y[i] = d.y;
      around.squared[i] = search.distance_squared(lane, k);
    }
    if (count == 0) return;
    const auto last = static_cast<std::size_t>(count) - 1;
    last_[sample] = neighbour_key(around.squared[last], index[last]);
    find_blocked(around, count);
    for (std::size_t k = 0; k <= last; ++k) {
      if (around.blocked[k] != 0) continue;
      if (around.squared[k] >= least_squared_ && around.squared[k] > 0) edges.push_back({sample, index[k]});
      if (!activity_.empty()) activity_[sample] = std::max(activity_[sample], difference({sample, index[k]}));
    }
  }

  const Ordered& samples_;
  const NearestSamples& nearest_;
  int neighbours_;
  float least_squared_;
  std::vector<std::uint64_t> last_;  // key of each sample's farthest neighbour
  std::vector<float> activity_;
};

/// Blocks of samples [first, second), none across the rows of cells.
std::vector<std::pair<std::size_t, std::size_t>> blocks_of(const std::vector<std::uint32_t>& row_begins) {
  std::vector<std::pair<std::size_t, std::size_t>> blocks;
  for (std::size_t row = 0; row + 1 < row_begins.size(); ++row) {
    for (std::size_t begin = row_begins[row]; begin < row_begins[row + 1]; begin += block_size) {
      blocks.emplace_back(begin, std::min<std::size_t>(begin + block_size, row_begins[row + 1]));
    }
  }
  return blocks;
}

/// The edges that count, with their priorities.
std::vector<Pair> prioritise(const std::vector<Edge>& edges, const Graph& graph, const GabrielOptions& options,
                             double floor) {
  std::vector<Pair> pairs;
  pairs.reserve(edges.size() * 5 / 8);
  for (const Edge edge : edges) {
    if (!graph.counts(edge)) continue;
    double contrast = double{graph.difference(edge)};
    if (options.activity > 0) {
      const float activity = std::min(graph.activity(edge.a), graph.activity(edge.b));
      contrast = std::max(contrast, options.activity * double{activity});
    }
    pairs.push_back(
        {edge.a, edge.b, pair_priority(contrast, floor, graph.squared_length(edge), options.length_exponent)});
  }
  return pairs;
}

/// The `wanted` pairs of highest priority, highest first; fewer if there are no more.
std::vector<Pair> best_of(const std::vector<std::vector<Pair>>& blocks, std::size_t wanted, std::uint64_t seed) {
  std::vector<std::size_t> in_class(priority_classes, 0);
  for (const auto& pairs : blocks) {
    for (const Pair& pair : pairs) ++in_class[priority_class(pair.priority)];
  }
  std::size_t lowest = priority_classes;
  for (std::size_t above = 0; lowest > 0 && above < wanted;) above += in_class[--lowest];
  struct Ranked {
    Pair pair;
    std::uint64_t lot;
  };
  std::vector<Ranked> ranked;
  for (const auto& pairs : blocks) {
    for (const Pair& pair : pairs) {
      if (priority_class(pair.priority) < lowest) continue;
      ranked.push_back({pair, lot_of(pair.a, pair.b, seed)});
    }
  }
  const auto before = [](const Ranked& a, const Ranked& b) {
    if (a.pair.priority != b.pair.priority) return a.pair.priority > b.pair.priority;
    return a.lot < b.lot;
  };
  wanted = std::min(wanted, ranked.size());
  const auto end = ranked.begin() + static_cast<std::ptrdiff_t>(wanted);
  if (end != ranked.end()) std::nth_element(ranked.begin(), end, ranked.end(), before);
  std::sort(ranked.begin(), end, before);
  std::vector<Pair> best(wanted);
  std::transform(ranked.begin(), end, best.begin(), [](const Ranked& r) { return r.pair; });
  return best;
}

}  // namespace

GabrielMidpoints gabriel_midpoints(std::span<const Vec2f> position, std::span<const float> value,
                                   std::uint32_t channels, Extent plane, std::size_t wanted, std::uint64_t seed,
                                   const GabrielOptions& options) {
  assert(channels >= 1 && value.size() == position.size() * channels);
  assert(std::all_of(value.begin(), value.end(), [](float v) { return std::isfinite(v); }));
  assert(options.neighbours >= 1 && options.neighbours < NearestSamples::most_neighbours);
  assert(options.floor >= 0 && options.min_length >= 0 && options.jitter >= 0 && options.activity >= 0);

  GabrielMidpoints midpoints;
  midpoints.position.reserve(wanted);
  if (position.size() >= 2 && wanted > 0) {
    Ordered samples;
    samples.channels = channels;
    samples.position.resize(position.size());
    samples.value.resize(value.size());
    {
      NearestSamples cells(position, plane, pair_samples_per_cell);
      if (const double per_cell = pair_samples_per_cell_of(cells.crowd()); per_cell < pair_samples_per_cell) {
        cells = NearestSamples(position, plane, per_cell);
      }
      samples.row_begins = cells.row_begins();
      const auto order = cells.order();
      for (std::size_t k = 0; k < order.size(); ++k) {
        samples.position[k] = position[order[k]];
        for (std::uint32_t c = 0; c < channels; ++c) {
          samples.value[k * channels + c] = value[std::size_t{order[k]} * channels + c];
        }
      }
      cells.renumber();
      Graph graph(samples, cells, options);
      const auto blocks = blocks_of(samples.row_begins);
      std::vector<std::vector<Edge>> edges(blocks.size());
      std::vector<std::vector<Pair>> pairs(blocks.size());
      const double deviation = standard_deviation(samples.value, channels);
      const double floor = deviation > 0 ? options.floor * deviation : 1;
      const auto count = static_cast<std::int64_t>(blocks.size());
#pragma omp parallel
      {
        NearestSamples::Search search;
#pragma omp for schedule(dynamic, 4)
        for (std::int64_t b = 0; b < count; ++b) {
          const auto block = static_cast<std::size_t>(b);
          edges[block].reserve(6 * (blocks[block].second - blocks[block].first));
          graph.find(blocks[block].first, blocks[block].second, search, edges[block]);
        }
#pragma omp for schedule(static)
        for (std::int64_t b = 0; b < count; ++b) {
          const auto block = static_cast<std::size_t>(b);
          pairs[block] = prioritise(edges[block], graph, options, floor);
        }
      }
      const auto jitter = static_cast<float>(options.jitter);
      for (const Pair& pair : best_of(pairs, wanted, seed)) {
        midpoints.position.push_back(jittered_midpoint(samples.position[pair.a], samples.position[pair.b],
                                                       midpoints.position.size(), jitter, plane, seed));
      }
    }
  }
  midpoints.pairs = midpoints.position.size();
  for (std::size_t k = midpoints.pairs; k < wanted; ++k) {
    midpoints.position.push_back(random_midpoint(k, plane, seed));
  }
  return midpoints;
}

}  // namespace abn
