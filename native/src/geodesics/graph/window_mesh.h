#pragma once
// A mesh as waves of windows want it: a record a half-edge, in the order of the graph's nodes.

#include <algorithm>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/support/large_array.h"

#include "geodesics/graph/window_batches.h"
#include "geodesics/unfolding/unfolding.h"

namespace saddleback {

/// Says about which nodes tables are laid: all of them, or those of a range with a halo.
/// Windows may enter faces of half-edges out of *open* nodes; the nodes about these are laid for them.
class LaidNodes {
 public:
  /// All nodes.
  explicit LaidNodes(Index node_count) : states_(node_count, open) {}
  /// Opens the given nodes and so many rings of neighbors about them. `nodes` of the vertices and `vertices` of the
  /// nodes. O(V), but nearly nothing for each node that is not opened.
  LaidNodes(const Mesh& mesh, std::span<const Index> nodes, std::span<const Index> vertices, std::vector<Index> inner,
            int rings);

  bool is_open(Index node) const { return states_[node] == open; }
  bool is_laid(Index node) const { return states_[node] != nothing; }

 private:
  enum State : std::uint8_t { nothing, laid, open };
  std::vector<State> states_;
};

/// The half-edges out of the laid nodes, in the order of the graph's nodes.
struct NodeEdges {
  std::vector<Index> first;     ///< per node, and the number of edges at the end; none are of nodes that are not laid
  LargeArray<Index> halfedges;  ///< of the edges; those out of one node are neighbors, counter-clockwise
  LargeArray<Index> edge_of;    ///< the halfedges' inverse; the number of edges for half-edges that are none
  /// `vertices` of the nodes. \throw Cancelled.
  NodeEdges(const Mesh& mesh, const LaidNodes& laid, std::span<const Index> vertices, int threads,
            const JobStage& stage);
};

/// Half-edges in the order of NodeEdges. Lengths are in units of the mean edge, so that
/// single-precision bounds hold at any scale.
class WindowMesh {
 public:
  /// Holds the edges out of laid nodes. \throw Cancelled.
  WindowMesh(const Unfolding& unfolding, const NodeEdges& edges, const LaidNodes& laid, std::span<const Index> nodes,
             std::span<const Index> vertices, int threads, const JobStage& stage);
  const LaidNodes& laid() const { return placed_; }
  /// Returns what stands for half-edges out of nodes that are not open: an entry behind the last.
  Index beyond() const { return edge_count(); }

  Index node_count() const { return static_cast<Index>(first_.size()) - 1; }
  Index begin(Index node) const { return first_[node]; }  ///< edges out of a node: [begin, end)
  Index end(Index node) const { return first_[node + 1]; }
  Index edge_count() const { return static_cast<Index>(targets_.size()); }
  const EdgeRecord* records() const { return records_.data(); }
  double unit() const { return unit_; }

  /// Returns the node that the edge comes from. O(log n).
  Index origin(Index edge) const {
    return static_cast<Index>(std::upper_bound(first_.begin(), first_.end(), edge) - first_.begin()) - 1;
  }
  Index target(Index edge) const { return targets_[edge]; }   ///< node that the edge leads to
  double length(Index edge) const { return lengths_[edge]; }  ///< in units
  bool is_saddle(Index node) const { return saddles_[node] != 0; }
  /// The edge's face, seen from the origin with the edge along x: its far corner in units.
  Vec2 apex(Index edge) const { return {records_[edge].a * lengths_[edge], records_[edge].b * lengths_[edge]}; }
  /// Returns the one behind the side opposite the edge's origin; -1 at the boundary.
  Index opposite(Index edge) const { return records_[edge].right; }
  bool has_left(Index edge) const { return records_[edge].left >= 0; }
  /// The edge from one node to another. O(degree).
  Index edge_between(Index from, Index to) const;

 private:
  EdgeRecord record_of(const Unfolding& unfolding, const NodeEdges& edges, std::span<const Index> nodes, Index h) const;
  void find_clearances(int threads, const JobStage& stage);

  LaidNodes placed_;
  LargeArray<EdgeRecord> records_;
  std::vector<Index> first_;
  LargeArray<Index> targets_;
  LargeArray<double> lengths_;
  std::vector<std::uint8_t> saddles_;
  double unit_ = 1;
};

/// Holds what the arcs of points are found with, and their directions back.
class FanMesh {
 public:
  /// `nodes` of the vertices and `vertices` of the nodes. \throw Cancelled.
  FanMesh(const Unfolding& unfolding, std::span<const Index> nodes, std::span<const Index> vertices, int threads,
          const JobStage& stage);
  const WindowMesh& waves() const { return waves_; }
  /// Surface angle, at the apex of an edge's face, of the way from there to the edge's origin.
  double apex_direction(Index edge) const { return apex_directions_[edge]; }

 private:
  FanMesh(const Unfolding& unfolding, const NodeEdges& edges, std::span<const Index> nodes,
          std::span<const Index> vertices, int threads, const JobStage& stage);
  WindowMesh waves_;
  LargeArray<double> apex_directions_;
};

/// Directions of a WindowMesh's edges, counted in sectors of the full angle about their vertex.
class WaveSectors {
 public:
  /// `vertices` of the nodes. \throw Cancelled.
  WaveSectors(const NodeEdges& edges, const Mesh& mesh, std::span<const Index> vertices, int threads,
              const JobStage& stage);

  float sector(Index edge) const { return sectors_[edge]; }                  ///< of the edge at its origin
  float reverse_sector(Index edge) const { return reverse_sectors_[edge]; }  ///< and at its target
  /// Returns the sector of the way from its face's apex to its origin.
  float apex_sector(Index edge) const { return apex_sectors_[edge]; }
  float per_radian(Index node) const { return per_radian_[node]; }

 private:
  LargeArray<float> sectors_, reverse_sectors_, apex_sectors_, per_radian_;
};

}  // namespace saddleback
