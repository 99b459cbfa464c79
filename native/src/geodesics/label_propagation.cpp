// One relaxation, two queues. Sums of arcs are exact (see ArcCodec), so that both queues end in
// the same bits: the least (distance, source) of each vertex does not depend on the order of the work.

#include "geodesics/label_propagation.h"

#include <algorithm>
#include <cmath>

#include "saddleback/error.h"

#include "geodesics/window_propagation.h"
#include "support/parallel.h"

namespace saddleback {
namespace {

struct Entry {
  double distance;
  Index vertex;
  bool operator<(const Entry& other) const { return distance > other.distance; }
};

class Heap {
 public:
  Heap(double, double) {}
  void push(const Entry& entry) {
    entries_.push_back(entry);
    std::push_heap(entries_.begin(), entries_.end());
  }
  bool pop(Entry& entry) {
    if (entries_.empty()) return false;
    entry = entries_.front();
    std::pop_heap(entries_.begin(), entries_.end());
    entries_.pop_back();
    return true;
  }

 private:
  std::vector<Entry> entries_;
};

/// A ring of buckets of equal width, last in first out inside each: nearly in order, with no comparison. The ring is
/// long enough for the span between the nearest entry and the farthest that it can push.
class Buckets {
 public:
  Buckets(double width, double span) {
    // A span of very many widths (arcs of wildly different lengths) gets wider buckets instead of more memory.
    const double bucket_width = std::max(width, span / k_most_buckets);
    inverse_width_ = 1 / bucket_width;
    std::size_t count = 4;
    while (static_cast<double>(count) < span / bucket_width + 3) count *= 2;
    buckets_.resize(count);
  }
  void push(const Entry& entry) {
    // Rounding in the division must not put an entry behind the bucket being emptied.
    const auto bucket = std::max(static_cast<std::int64_t>(entry.distance * inverse_width_), current_);
    buckets_[static_cast<std::size_t>(bucket) & (buckets_.size() - 1)].push_back(entry);
    ++size_;
  }
  bool pop(Entry& entry) {
    if (size_ == 0) return false;
    while (true) {
      std::vector<Entry>& bucket = buckets_[static_cast<std::size_t>(current_) & (buckets_.size() - 1)];
      if (!bucket.empty()) {
        entry = bucket.back();
        bucket.pop_back();
        --size_;
        return true;
      }
      ++current_;
    }
  }

 private:
  static constexpr double k_most_buckets = 1 << 16;
  double inverse_width_ = 1;
  std::int64_t current_ = 0;
  std::size_t size_ = 0;
  std::vector<std::vector<Entry>> buckets_;
};

template <class Queue>
void propagate(const SaddleVertexGraph& graph, const std::vector<Seed>& seeds, double limit, LabelField& field,
               const JobStage& stage) {
  double span = graph.arcs().longest();
  for (const Seed& seed : seeds) span = std::max(span, seed.distance);
  Queue queue(graph.mesh().mean_edge_length(), span);
  const ArcRows& arcs = graph.arcs();
  const bool with_predecessors = !field.predecessor.empty();
  const auto relax = [&](Index vertex, double distance, Index source, Index predecessor) {
    if (distance > field.distance[vertex] || distance > limit) return;
    if (distance == field.distance[vertex] && source >= field.source[vertex]) return;
    field.distance[vertex] = distance;
    field.source[vertex] = source;
    if (with_predecessors) field.predecessor[vertex] = predecessor;
    queue.push({distance, vertex});
  };
  for (const Seed& seed : seeds) relax(seed.vertex, seed.distance, seed.source, k_none);
  Index countdown = 1;
  for (Entry entry{}; queue.pop(entry);) {
    if (--countdown == 0) {
      countdown = 4096;
      stage.check();
    }
    if (entry.distance > field.distance[entry.vertex]) continue;
    const Index source = field.source[entry.vertex];
    const Index node = graph.node_of(entry.vertex);
    const std::int64_t end = arcs.first(node + 1);
    for (std::int64_t arc = arcs.first(node); arc < end; ++arc) {
      relax(graph.vertex_of(arcs.target(arc)), entry.distance + arcs.length(arc), source, entry.vertex);
    }
  }
}

/// Seeds of sources that are vertices (distance 0) or lie elsewhere (a window propagation each, k vertices wide).
std::vector<Seed> make_seeds(const SaddleVertexGraph& graph, const SurfacePoints& sources, const JobStage& stage) {
  const auto count = static_cast<Index>(sources.size());
  std::vector<std::vector<DirectArc>> fans(count);
  std::vector<std::unique_ptr<WindowPropagator>> propagators(thread_count(0));
  parallel_for(count, 0, 16, [&](Index i, int thread) {
    if (vertex_at(graph.mesh(), sources[i]) != k_none) return;
    stage.check();
    if (!propagators[thread]) propagators[thread] = std::make_unique<WindowPropagator>(graph.unfolding());
    graph.fan(sources[i], *propagators[thread], fans[i]);
  });
  std::vector<Seed> seeds;
  for (Index i = 0; i < count; ++i) {
    if (const Index vertex = vertex_at(graph.mesh(), sources[i]); vertex != k_none) seeds.push_back({vertex, i, 0});
    for (const DirectArc& arc : fans[i]) seeds.push_back({arc.vertex, i, graph.arcs().codec().round(arc.length)});
  }
  return seeds;
}

std::vector<Seed> checked_seeds(const SaddleVertexGraph& graph, const SurfacePoints& sources,
                                const QueryOptions& options, const JobStage& stage) {
  if (sources.empty()) throw InputError("sources: wanted at least one source, got none");
  check_surface_points(graph.mesh(), sources, "sources");
  if (std::isnan(options.limit) || options.limit < 0) {
    throw InputError(message("limit: wanted a distance of 0 or more, got ", options.limit));
  }
  return make_seeds(graph, sources, stage);
}

}  // namespace

LabelField propagate_labels(const SaddleVertexGraph& graph, const std::vector<Seed>& seeds, const QueryOptions& options,
                            bool with_predecessors, const JobStage& stage) {
  const Index count = graph.mesh().vertex_count();
  LabelField field;
  field.distance.assign(count, std::numeric_limits<double>::infinity());
  field.source.assign(count, k_none);
  if (with_predecessors) field.predecessor.assign(count, k_none);
  if (options.method == QueryMethod::dijkstra) {
    propagate<Heap>(graph, seeds, options.limit, field, stage);
  } else {
    propagate<Buckets>(graph, seeds, options.limit, field, stage);
  }
  return field;
}

std::vector<double> SaddleVertexGraph::distances(const SurfacePoints& sources, const QueryOptions& options,
                                                 Job* job) const {
  const JobStage stage(job, "Measuring distances");
  return propagate_labels(*this, checked_seeds(*this, sources, options, stage), options, false, stage).distance;
}

NearestField SaddleVertexGraph::nearest(const SurfacePoints& sources, const QueryOptions& options, Job* job) const {
  const JobStage stage(job, "Finding nearest sources");
  LabelField field = propagate_labels(*this, checked_seeds(*this, sources, options, stage), options, false, stage);
  return {std::move(field.distance), std::move(field.source)};
}

}  // namespace saddleback
