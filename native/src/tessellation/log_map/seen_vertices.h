#pragma once
// What sites see straight: the vertices that arcs of their own lead to.

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "geodesics/queries/point_arcs.h"
#include "tessellation/log_map/packed_vector.h"
#include "tessellation/log_map/vertex_rings.h"

namespace saddleback {

/// Place of a vertex, seen from a site.
struct SiteVector {
  PackedVec2 log = PackedVec2::Zero();  ///< in the site's tangent plane; as long as the distance, to rounding
  double distance = 0;
};

/// The nodes that one site sees, as SeenNodes. What is no arc is where it is seen, but labels are the graph's. What is
/// looked at of all nodes lies apart from what few are asked for.
struct SeenVertices {
  std::vector<Index> nodes;
  std::vector<double> rounded;     ///< lengths as the graph's arcs are, for labels
  std::vector<PackedVec2> places;  ///< not rounded: that depends on the scale, which must not show in the cells
  std::size_t arc_count = 0;       ///< those are the first
  struct Across {
    PackedVec2 from;
    Index edge;
  };
  std::vector<Across> across;    ///< SeenNode::edge and its start
  Index center = k_none;         ///< the node that the site is
  std::array<Index, 3> corners;  ///< of its face
  Index first = 0, last = -1;    ///< the least and the greatest of the nodes
  void resize(std::size_t count);
  void set(std::size_t i, const SeenNode& node, double length_rounded);
  /// The first `count` are arcs.
  void set_arcs(std::ptrdiff_t count);
  /// The number among them that a node has; k_none for none. O(nodes).
  Index find(Index node) const;
};

/// The nodes that each of several sites sees.
class SeenFromSites {
 public:
  SeenFromSites(const SaddleVertexGraph& graph, const VertexRings& rings) : graph_(graph), rings_(rings) {}

  /// Sites, and how far to look about each.
  struct Request {
    const SurfacePoints& sites;
    std::span<const Index> order;           ///< of the sites
    std::span<const std::uint8_t> is_kept;  ///< by site: what it sees is known
    bool keeps_any;
    /// Radii by site: how far it is asked for arcs of its own, or somewhat farther; empty: without end.
    std::span<const double> reaches;
  };
  /// Finds those of the sites that are not kept. \throw Cancelled. O(sites k log k).
  void find(const Request& request, int threads, const JobStage& stage);
  /// Renumbers as SiteLabels::renumber does.
  void renumber(std::span<const Index> before);

  const SeenVertices& of(Index site) const { return seen_[site]; }
  /// The radius within which a site was asked for arcs.
  double limit(Index site) const { return limits_[site]; }
  /// Surface angle at a node that the site sees straight, the `seen`-th of them, towards the site.
  double direction_back(Index site, Index seen) const;
  /// Asks memory for the first that are looked up.
  void fetch(Index site) const;

 private:
  void find_from_vertex(SeenVertices& seen) const;

  const SaddleVertexGraph& graph_;
  const VertexRings& rings_;
  std::vector<SeenVertices> seen_;
  std::vector<double> limits_;  ///< of the arcs' lengths
};

}  // namespace saddleback
