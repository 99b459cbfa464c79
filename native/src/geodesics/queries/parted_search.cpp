// Each thread has a stretch of nodes, which lie together on the surface, and a search of its own that ends beyond it.
// In rounds, what a search found of others' nodes becomes seeds of theirs, until nothing is nearer. Cells are small
// against stretches: the first round does nearly all, and there are three or four.

#include "geodesics/queries/parted_search.h"

#include <algorithm>

#include "geodesics/queries/query_cache.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

// Nodes: threads with less to do wait for each other.
constexpr Index k_least_part = 4096;

class PartedSearch {
 public:
  PartedSearch(const SaddleVertexGraph& graph, int threads) : graph_(graph), threads_(threads) {
    const Index count = graph.mesh().vertex_count();
    const Index parts = std::clamp<Index>(count / k_least_part, 1, thread_count(threads));
    for (Index part = 0; part <= parts; ++part)
      ends_.push_back(static_cast<Index>(static_cast<std::int64_t>(count) * part / parts));
    for (Index part = 0; part < parts; ++part) searches_.push_back(graph.query_cache().field_searches.lease());
    seeds_.resize(parts);
  }
  void begin(const SeedsOfPart& seeds_of, const JobStage& stage) {
    for_each_part([&](Index part) {
      search(part).begin_part(graph_, ends_[part], ends_[part + 1]);
      seeds_of(ends_[part], ends_[part + 1], seeds_[part]);
      search(part).continue_part(graph_, seeds_[part], stage);
    });
  }
  /// Returns false when no search has found anything nearer for another.
  bool go_on(const JobStage& stage) {
    for_each_part([&](Index part) { collect(part); });
    if (std::ranges::all_of(seeds_, [](const auto& seeds) { return seeds.empty(); })) return false;
    for_each_part([&](Index part) { search(part).continue_part(graph_, seeds_[part], stage); });
    return true;
  }
  void write(std::vector<double>& distances, std::vector<Index>& sources) {
    distances.resize(ends_.back());
    sources.resize(ends_.back());
    for_each_part([&](Index part) {
      const Index first = ends_[part], count = ends_[part + 1] - first;
      std::ranges::copy(search(part).node_distances().subspan(first, count), distances.begin() + first);
      std::ranges::copy(search(part).node_sources().subspan(first, count), sources.begin() + first);
    });
  }

 private:
  GraphSearch& search(Index part) { return *searches_[part]; }
  template <class Body>
  void for_each_part(Body&& body) {
    parallel_for(static_cast<Index>(searches_.size()), threads_, 1, [&](Index part, int) { body(part); });
  }
  /// Collects what others have found of a part's nodes and is nearer than what it knows.
  void collect(Index part) {
    seeds_[part].clear();
    const auto distances = search(part).node_distances();
    const auto sources = search(part).node_sources();
    for (Index other = 0; other < static_cast<Index>(searches_.size()); ++other) {
      if (other == part) continue;
      for (const Index node : search(other).crossed()) {
        if (node < ends_[part] || node >= ends_[part + 1]) continue;
        const double distance = search(other).node_distances()[node];
        const Index source = search(other).node_sources()[node];
        if (distance < distances[node] || (distance == distances[node] && source < sources[node]))
          seeds_[part].push_back({node, source, distance});
      }
    }
  }

  const SaddleVertexGraph& graph_;
  const int threads_;
  std::vector<Index> ends_;  ///< of the parts, after a 0
  std::vector<ScratchPool<GraphSearch>::Lease> searches_;
  std::vector<std::vector<NodeSeed>> seeds_;
};

}  // namespace

void nearest_sources(const SaddleVertexGraph& graph, const SeedsOfPart& seeds_of, int threads, const JobStage& stage,
                     std::vector<double>& distances, std::vector<Index>& sources) {
  PartedSearch search(graph, threads);
  search.begin(seeds_of, stage);
  while (search.go_on(stage)) {}
  search.write(distances, sources);
  stage.update(1);
}

}  // namespace saddleback
