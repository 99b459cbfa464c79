#pragma once
// Where vertices lie in the tangent planes of the sites: the discrete logarithm map of each cell.

#include <optional>
#include <span>
#include <vector>

#include "tessellation/log_map/edge_sight.h"
#include "tessellation/log_map/seen_vertices.h"
#include "tessellation/log_map/site_labels.h"

namespace saddleback {

/// Lengths that stand for a site's distances to vertices that it does not see: lengths of ways in the graph, which are
/// never too short but leap a little where sites move; or, for a relaxation, lengths in its own plane, which do not
/// leap and differ from those by less than the graph's error, on either side.
enum class CellLengths { of_ways, smooth };

/// Labels every vertex with its nearest site by the graph and places it in that site's tangent plane.
///
/// A path in the graph may bend at a vertex where a shortest path would not (an angle below pi on one side). Vertices
/// are therefore placed one after another, by distance, so that the distance is the straight one, exactly so on flat
/// parts. Where a bend is legal at a vertex with much excess of angle (a saddle, a reflex boundary), that vertex
/// becomes the anchor of what lies behind: distances go on from it, and directions at the site are its own.
///
/// The plane's axes are those of the site's FaceChart or, for a site that is a vertex, of its first half-edge, with
/// angles scaled to 2 pi when it is not on the boundary.
///
/// A vertex of the site's own cell (CellPlacer) is placed by the first of these that applies:
///   1. straight        an arc of the site's own leads there, no longer than the way in the graph
///   2. truly seen      the waves see it past another vertex, and a straight line is traced to it; with smooth lengths
///                      without a trace: a relaxation may be off by the graph's error
///   3. center          it is the site
///   4. across an edge  beyond an edge whose ends are placed, in one plane, if that is as long as the way in the graph;
///                      straight where the line to the anchor is traced
///   5. detour          the same, longer than the way in the graph by less than the slack: shortened to it
///   6. after another   after the vertex before on the shortest way, its bend developed; or that vertex is its anchor
///   7. end of the way  no vertex of the cell is nearer, since an arc is shorter than the rounding of the whole way: at
///                      its distance, in any direction
/// A vertex beside the cell (VerticesBeside), whose label is another, by the first of these:
///   1. center          it is the site: two sites on one vertex
///   2. seen            an arc of the site's own leads there, as one does to each corner of its face, and no way over a
///                      node that it owns or sees is shorter
///   3. across an edge  beyond an edge of the cell, the one across which the site is seen best
///   4. beside an edge  beyond an edge with one end in the cell, the other placed by 3
///   5. after an arc    after the cell's vertex before on the shortest way: a direction where 3 and 4 have none, and
///                      the length, unless the straight one is known
///   6. after a seen    the same after a vertex that the site sees, where the cell has hardly a vertex beside it
/// By 3 to 6 as far as the graph's way over vertices of any label, where that over the cell's does not fit the place.
/// Each of them is taken in tests/native/tessellation; the seventh in test_cells_of_few_sites.py, on edges of 1e-17.
/// What is left, corners of long faces that cells without vertices cross, is extrapolated (ExtrapolatedCorners).
class CellLogMaps {
 public:
  /// Nothing is known before label_nodes. Both must outlive the maps. `cuda_device` as for SiteLabels.
  CellLogMaps(const SaddleVertexGraph& graph, const VertexRings& rings, CellLengths lengths, int cuda_device);
  const SaddleVertexGraph& graph() const { return graph_; }
  const VertexRings& rings() const { return rings_; }
  bool is_smooth() const { return lengths_ == CellLengths::smooth; }
  /// The share by which a distance may be below the graph's.
  double slack() const { return slack_; }
  /// Tells whether the mesh is a flat disk, however it is rolled: whatever fits a plane there is in it.
  bool is_flat_disk() const { return is_flat_disk_; }

  /// Begins with new sites. `reaches` as for SeenFromSites: most of the work where cells are small; what lies beyond is
  /// placed as what is hidden from the site. `others` as for SiteLabels, since when all cells were placed. \throw
  /// Cancelled, DeviceError, and then holds nothing to keep. O(sites k log k + arcs), of the cells that are made anew.
  void label_nodes(const SurfacePoints& sites, std::span<const double> reaches,
                   const std::optional<std::vector<Index>>& others, int threads, const JobStage& stage);
  /// Renumbers as SiteLabels::renumber does.
  void renumber(std::span<const Index> before);
  const SiteLabels& labels() const { return labels_; }
  const SeenFromSites& seen() const { return seen_; }

  // Vertices are the graph's nodes. Cells that are not kept are placed by a CellPlacer before they are asked for.
  const VertexPlace& place(Index node) const { return places_[node]; }
  bool is_placed(Index node) const { return places_[node].found_by != VertexPlace::k_unplaced; }
  void mark_unplaced(Index node) { places_[node].found_by = VertexPlace::k_unplaced; }
  void set_place(Index node, const VertexPlace& place) { places_[node] = place; }
  /// The nodes of a label in the order in which they are placed. Safe for several sites at once.
  std::span<const Index> sort_nodes(Index site) { return labels_.sort_by_distance(site); }
  /// Places as seen from the site of its label.
  SiteVector own(Index node) const { return vector_of(places_[node]); }
  double own_distance(Index node) const { return places_[node].distance; }
  /// The vector to a place; what lies behind an anchor is seen in the anchor's direction.
  SiteVector vector_of(const VertexPlace& place) const;
  /// The anchor's distance from the site.
  double anchor_distance(const VertexPlace& place) const {
    return place.anchor == k_none ? 0 : places_[place.anchor].distance;
  }
  /// Asks memory for the place of a node that is looked at soon.
  void fetch(Index node) const { __builtin_prefetch(&places_[node]); }

 private:
  const SaddleVertexGraph& graph_;
  const VertexRings& rings_;
  const CellLengths lengths_;
  const double slack_;
  const bool is_flat_disk_;
  SeenFromSites seen_;
  SiteLabels labels_;
  LargeArray<VertexPlace> places_;
};

}  // namespace saddleback
