#pragma once
// Places the vertices of cells in the planes of their sites.

#include <optional>

#include "geodesics/unfolding/arc_unfolding.h"
#include "tessellation/log_map/cell_log_maps.h"

namespace saddleback {

/// A thread's own, for vertices of cells; the ways are listed with CellLogMaps.
class CellPlacer {
 public:
  /// The maps must outlive it.
  explicit CellPlacer(CellLogMaps& maps);
  /// Places the nodes of a label, once.
  void place(Index site);
  /// Asks memory for what `place` looks up: cells have few nodes, so that while one is placed the next is fetched.
  void fetch(Index site) const;

  /// Places after a node of a cell that is placed: its bend developed, or as seen from there.
  VertexPlace place_after(Index node, Index previous);
  /// Does the same after a node at another place; `back` leads to the anchor of that.
  VertexPlace place_after(Index node, Index previous, const VertexPlace& before, double back);
  /// Places beyond an edge; at an infinite distance unless that is known to be the straight one.
  VertexPlace place_beyond(const EdgeSight& sight, const VertexRings::Wedge& wedge, const VertexPlace& from,
                           const VertexPlace& to) const;

 private:
  void place_straight(Index site);
  std::optional<Vec2> seen_truly(Index site, Index node, const Vec2& place) const;
  bool place_across(Index node, Index site, VertexPlace& place) const;
  std::optional<double> line_to_anchor(const VertexRings::Wedge& wedge, const EdgeSight& sight, Index anchor,
                                       Index site) const;
  Index node_before(Index node, Index site) const;
  double direction_back(Index node);

  CellLogMaps& maps_;
  const SaddleVertexGraph& graph_;
  const Mesh& mesh_;
  const VertexRings& rings_;
  const SiteLabels& labels_;
  ArcUnfolder unfolder_;
  UnfoldedArc unfolded_;
};

}  // namespace saddleback
