// Label-correcting search: rows are relaxed by relax_row, nodes whose distance fell go to the queue. Nodes wait in
// buckets about an edge wide: few are expanded twice and none is compared with another. A distance falls four times
// before it is final, but mostly within one bucket, where the entry that waits already does. The rows of the next nodes
// in the bucket are fetched from memory while this one is relaxed: without, waiting is half the time.

#include "geodesics/queries/graph_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geodesics/queries/arc_scale.h"
#include "geodesics/queries/query_cache.h"

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
// The width in shortest arcs of the median node. Measured: times are flat between 1 and 3.
constexpr double k_bucket_width = 2;
constexpr double k_median = 0.5;
// How many entries ahead a row's place, and then the row itself, is fetched; of long rows the beginning, by which the
// processor sees what comes.
constexpr int k_fetch_offset = 6, k_fetch_row = 3;
constexpr std::int64_t k_most_fetched = 64;
constexpr int k_words_a_line = 8;
// Arcs between two looks at the job: about a millisecond, also where rows are very long.
constexpr std::int64_t k_arcs_a_check = 1 << 18;
constexpr std::size_t k_seeds_a_check = 1 << 14;

/// Dijkstra's queue, with the same face as the buckets.
class Heap {
 public:
  struct Entry {
    Index node;
    double key;
    bool operator<(const Entry& other) const { return key > other.key; }
  };
  void push(Index node, double key) {
    entries_.push_back({node, key});
    std::push_heap(entries_.begin(), entries_.end());
  }
  bool pop(Entry& entry) {
    if (entries_.empty()) return false;
    entry = entries_.front();
    std::pop_heap(entries_.begin(), entries_.end());
    entries_.pop_back();
    return true;
  }
  void lower(Index node, double key, double) { push(node, key); }
  static bool is_due(const Entry& entry, double key) { return entry.key == key; }
  static const Entry* ahead(int) { return nullptr; }

 private:
  std::vector<Entry> entries_;
};

Index node_of(const SaddleVertexGraph& graph, const Seed& seed) { return graph.node_of(seed.vertex); }
Index node_of(const SaddleVertexGraph&, const NodeSeed& seed) { return seed.node; }

}  // namespace

void GraphSearch::run(const SaddleVertexGraph& graph, std::span<const Seed> seeds, const QueryOptions& options,
                      SearchLabels labels, const JobStage& stage) {
  run_from(graph, seeds, options, labels, stage);
}

void GraphSearch::run(const SaddleVertexGraph& graph, std::span<const NodeSeed> seeds, const QueryOptions& options,
                      SearchLabels labels, const JobStage& stage) {
  run_from(graph, seeds, options, labels, stage);
}

template <class AnySeed>
void GraphSearch::run_from(const SaddleVertexGraph& graph, std::span<const AnySeed> seeds, const QueryOptions& options,
                           SearchLabels labels, const JobStage& stage) {
  bound_ = std::nextafter(options.limit, k_infinity);
  clear(graph, labels);
  likely_ = graph.arcs().node_count();
  if (options.method == QueryMethod::dijkstra) {
    // With the portable loop over a row: together the search that the fast one is checked against.
    Heap heap;
    propagate(heap, relax_row_portable(), graph, seeds, stage);
  } else {
    propagate_in_buckets(graph, seeds, stage);
  }
  stage.update(1);
}

void GraphSearch::clear(const SaddleVertexGraph& graph, SearchLabels labels) {
  const auto count = static_cast<std::size_t>(graph.arcs().node_count());
  distances_.assign(count, bound_);
  sources_.assign(labels == SearchLabels::none ? 0 : count, k_none);
  predecessors_.assign(labels == SearchLabels::sources_and_predecessors ? count : 0, k_none);
  first_ = 0;
  last_ = static_cast<Index>(count);
  likely_ = std::max(1.0, static_cast<double>(count));
  goes_on_ = false;
}

template <class AnySeed>
void GraphSearch::propagate_in_buckets(const SaddleVertexGraph& graph, std::span<const AnySeed> seeds,
                                       const JobStage& stage) {
  double least = k_infinity, most = 0;
  for (const AnySeed& seed : seeds) {
    least = std::min(least, seed.distance);
    most = std::max(most, seed.distance);
  }
  if (!(least <= most)) return;
  if (width_ == 0) width_ = k_bucket_width * shortest_arcs_below(graph.arcs(), k_median);
  buckets_.reset(width_, std::max(graph.arcs().longest(), most - least), least);
  propagate(buckets_, relax_row(), graph, seeds, stage);
}

void GraphSearch::begin_part(const SaddleVertexGraph& graph, Index first, Index last) {
  bound_ = k_infinity;
  clear(graph, SearchLabels::sources);
  first_ = first;
  last_ = last;
}

void GraphSearch::continue_part(const SaddleVertexGraph& graph, std::span<const NodeSeed> seeds,
                                const JobStage& stage) {
  crossed_.clear();
  propagate_in_buckets(graph, seeds, stage);
  goes_on_ = true;
}

template <class Queue, class AnySeed>
void GraphSearch::propagate(Queue& queue, RelaxRow relax, const SaddleVertexGraph& graph,
                            std::span<const AnySeed> seeds, const JobStage& stage) {
  const ArcCodec& codec = graph.arcs().codec();
  const std::uint64_t* const words = graph.arcs().words().data();
  const std::int64_t* const offsets = graph.arcs().offsets().data();
  const bool with_sources = !sources_.empty(), with_predecessors = !predecessors_.empty();

  const double of_seeds = k_cost_of_seed * static_cast<double>(seeds.size()), all = of_seeds + likely_;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    if (i % k_seeds_a_check == k_seeds_a_check - 1) stage.update(k_cost_of_seed * static_cast<double>(i) / all);
    const AnySeed& seed = seeds[i];
    const Index node = node_of(graph, seed);
    if (seed.distance > distances_[node] || seed.distance >= bound_) continue;
    if (seed.distance == distances_[node] && (!with_sources || seed.source >= sources_[node])) continue;
    distances_[node] = seed.distance;
    if (with_sources) sources_[node] = seed.source;
    queue.push(node, seed.distance);
  }

  LoweredNodes lowered;
  RowOffer offer{0, distances_.data(), with_sources ? sources_.data() : nullptr, k_none};
  std::int64_t expanded = 0, arcs_to_check = k_arcs_a_check;
  for (typename Queue::Entry entry{}; queue.pop(entry);) {
    if (const auto* next = queue.ahead(k_fetch_offset)) {
      __builtin_prefetch(offsets + next->node);
      __builtin_prefetch(distances_.data() + next->node);
    }
    if (const auto* next = queue.ahead(k_fetch_row); next && queue.is_due(*next, distances_[next->node])) {
      const std::int64_t begin = offsets[next->node], end = std::min(offsets[next->node + 1], begin + k_most_fetched);
      for (std::int64_t word = begin; word < end; word += k_words_a_line) __builtin_prefetch(words + word);
    }
    offer.distance = distances_[entry.node];
    if (!queue.is_due(entry, offer.distance)) continue;
    ++expanded;
    const std::int64_t end = offsets[entry.node + 1];
    arcs_to_check -= end - offsets[entry.node];
    if (arcs_to_check < 0) {
      arcs_to_check = k_arcs_a_check;
      stage.update((of_seeds + static_cast<double>(expanded)) / all);
    }
    if (with_sources) offer.label = sources_[entry.node];
    graph.arcs().look_at(entry.node);
    for (std::int64_t first = offsets[entry.node]; first < end; first += LoweredNodes::k_most) {
      const auto arcs = static_cast<int>(std::min<std::int64_t>(end - first, LoweredNodes::k_most));
      relax(codec, words + first, arcs, offer, lowered);
      for (int i = 0; i < lowered.count; ++i) {
        const Index node = lowered.nodes[i];
        if (node >= first_ && node < last_)
          queue.lower(node, lowered.distances[i], goes_on_ || lowered.before[i] == bound_ ? -1 : lowered.before[i]);
        else
          crossed_.push_back(node);
        if (with_sources) sources_[node] = offer.label;
        if (with_predecessors) predecessors_[node] = entry.node;
      }
    }
  }
}

void GraphSearch::write_distances(const SaddleVertexGraph& graph, std::span<double> vertices) const {
  for (std::size_t node = 0; node < distances_.size(); ++node) {
    const double distance = distances_[node];
    vertices[graph.vertex_of(static_cast<Index>(node))] = distance == bound_ ? k_infinity : distance;
  }
}

void GraphSearch::write_sources(const SaddleVertexGraph& graph, std::span<Index> vertices) const {
  for (std::size_t node = 0; node < sources_.size(); ++node)
    vertices[graph.vertex_of(static_cast<Index>(node))] = sources_[node];
}

void GraphSearch::write_predecessors(const SaddleVertexGraph& graph, std::span<Index> vertices) const {
  for (std::size_t node = 0; node < predecessors_.size(); ++node) {
    const Index before = predecessors_[node];
    vertices[graph.vertex_of(static_cast<Index>(node))] = before == k_none ? k_none : graph.vertex_of(before);
  }
}

double GraphSearch::distance(const SaddleVertexGraph& graph, Index vertex) const {
  const double distance = distances_[graph.node_of(vertex)];
  return distance == bound_ ? k_infinity : distance;
}

LabelField propagate_labels(const SaddleVertexGraph& graph, std::span<const Seed> seeds, const QueryOptions& options,
                            bool with_predecessors, const JobStage& stage) {
  const auto search = graph.query_cache().field_searches.lease();
  const SearchLabels labels = with_predecessors ? SearchLabels::sources_and_predecessors : SearchLabels::sources;
  constexpr double k_searched = 0.92;  // of the time
  search->run(graph, seeds, options, labels, stage.part(0, k_searched));
  const Index count = graph.mesh().vertex_count();
  LabelField field;
  field.distance.resize(count);
  field.source.resize(count);
  search->write_distances(graph, field.distance);
  search->write_sources(graph, field.source);
  if (with_predecessors) {
    field.predecessor.resize(count);
    search->write_predecessors(graph, field.predecessor);
  }
  stage.update(1);
  return field;
}

}  // namespace saddleback
