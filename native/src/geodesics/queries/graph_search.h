#pragma once
// Shortest paths in the graph from many seeds at once, in the order of its nodes.

#include <span>
#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "geodesics/queries/relax_row.h"
#include "support/bucket_queue.h"

namespace saddleback {

/// A vertex that a source reaches by an arc of its own.
struct Seed {
  Index vertex;
  Index source;
  double distance;
};

/// Holds the same in the graph's own numbering.
struct NodeSeed {
  Index node;
  Index source;
  double distance;
};

/// Measures what a seed takes, in nodes that are expanded in the time.
inline constexpr double k_cost_of_seed = 0.1;

/// Says what a search keeps beside the distances.
enum class SearchLabels { none, sources, sources_and_predecessors };

/// Least distance and, if asked for, among equals the least source of every node. Sums of arcs are exact (see
/// ArcCodec), so that neither the queue nor the order of the work shows in the result. Holds its memory for the next
/// run; one a thread and graph.
class GraphSearch {
 public:
  /// \throw Cancelled. O(arcs) with
  /// buckets, O(arcs + V log V) with Dijkstra's heap.
  void run(const SaddleVertexGraph& graph, std::span<const Seed> seeds, const QueryOptions& options,
           SearchLabels labels, const JobStage& stage);
  void run(const SaddleVertexGraph& graph, std::span<const NodeSeed> seeds, const QueryOptions& options,
           SearchLabels labels, const JobStage& stage);

  // A part of a search: expands only the nodes from `first` up to `last`. What lies beyond is reached, but goes no
  // farther; the search of that part goes on from there.
  void begin_part(const SaddleVertexGraph& graph, Index first, Index last);
  /// Goes on from more seeds of the part. \throw Cancelled.
  void continue_part(const SaddleVertexGraph& graph, std::span<const NodeSeed> seeds, const JobStage& stage);
  /// Nodes beyond the part that were reached, or better than before; some more than once. Until it goes on.
  std::span<const Index> crossed() const { return crossed_; }

  // Of the last run. Distances are in the order of the vertices, infinity where nothing reached within the limit.
  void write_distances(const SaddleVertexGraph& graph, std::span<double> vertices) const;
  /// Sources, k_none where nothing reached.
  void write_sources(const SaddleVertexGraph& graph, std::span<Index> vertices) const;
  /// Vertices before, k_none straight from a source. Where several would do, which one it is may depend on the method.
  void write_predecessors(const SaddleVertexGraph& graph, std::span<Index> vertices) const;
  /// Returns the same in the order of the nodes; with no limit, and all reached.
  std::span<const double> node_distances() const { return distances_; }
  std::span<const Index> node_sources() const { return sources_; }
  /// Returns that of a vertex.
  double distance(const SaddleVertexGraph& graph, Index vertex) const;

 private:
  template <class AnySeed>
  void run_from(const SaddleVertexGraph& graph, std::span<const AnySeed> seeds, const QueryOptions& options,
                SearchLabels labels, const JobStage& stage);
  void clear(const SaddleVertexGraph& graph, SearchLabels labels);
  template <class AnySeed>
  void propagate_in_buckets(const SaddleVertexGraph& graph, std::span<const AnySeed> seeds, const JobStage& stage);
  template <class Queue, class AnySeed>
  void propagate(Queue& queue, RelaxRow relax, const SaddleVertexGraph& graph, std::span<const AnySeed> seeds,
                 const JobStage& stage);

  double width_ = 0;  ///< of the buckets; 0: not known yet
  double bound_ = 0;  ///< what unreached nodes hold: the first number that is beyond the limit
  std::vector<double> distances_;
  std::vector<Index> sources_, predecessors_;
  Index first_ = 0, last_ = 0;  ///< the nodes that may be expanded
  double likely_ = 1;           ///< how many will be
  bool goes_on_ = false;        ///< nodes have been expanded at distances that may still fall
  std::vector<Index> crossed_;
  BucketQueue buckets_;
};

/// Fields over the vertices.
struct LabelField {
  std::vector<double> distance;  ///< infinity where nothing reaches
  std::vector<Index> source;     ///< k_none where nothing reaches; ties: the smaller source
  std::vector<Index>
      predecessor;  ///< vertex before on the path; k_none: straight from the source. Empty unless asked for
};

/// Runs one of the graph's searches (see GraphSearch) from seeds at vertices and returns what it found.
LabelField propagate_labels(const SaddleVertexGraph& graph, std::span<const Seed> seeds, const QueryOptions& options,
                            bool with_predecessors, const JobStage& stage);

}  // namespace saddleback
