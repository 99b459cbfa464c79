#pragma once
// Where the vertices lie in the tangent planes of the sites: the discrete logarithm map of each cell.

#include <vector>

#include "saddleback/saddle_vertex_graph.h"

#include "geodesics/arc_unfolding.h"
#include "geodesics/window_propagation.h"

namespace saddleback {

/// Labels every vertex with its nearest site by the graph and develops the path to it into the site's tangent plane.
///
/// A path in the graph may bend at a vertex where a shortest path would not (an angle below pi on one side). Developed
/// with its bends, its end lies at the straight distance and in the true direction, exactly so on flat parts; where the
/// bend is legal (a saddle vertex, a reflex boundary) the path goes straight on and the distance is the path's length.
/// Squared distances so obtained differ by affine functions inside a flat face, which makes bisectors straight there.
///
/// The plane's axes are those of the site's FaceChart or, for a site that is a vertex, of its first half-edge, with
/// angles scaled to 2 pi when it is not on the boundary.
class SiteMaps {
 public:
  /// \throw Cancelled. O(sites k log k + arcs).
  SiteMaps(const SaddleVertexGraph& graph, const SurfacePoints& sites, int threads, const JobStage& stage);

  /// Nearest site by the graph, k_none where none reaches.
  Index label(Index vertex) const { return label_[vertex]; }

  /// The vertex in the tangent plane of the site, which need not be its own. Near the site's cell that is a developed
  /// path; farther away the face of `halfedge` (whose third corner the vertex is) is laid beside the edge, whose ends
  /// must be known. What was answered once is kept.
  Vec2 log(Index vertex, Index site, Index halfedge);

  /// The same, of the vertex's own label or asked for before.
  Vec2 known_log(Index vertex, Index site) const;

 private:
  struct Place {
    Vec2 log = Vec2::Zero();
    double heading = 0;  ///< of the path where it arrives, in the site's plane
    double back = 0;     ///< direction back along the path, surface angle at the vertex
  };
  struct Known {
    Vec2 log;
    Index site, next;
  };
  struct Fan {
    std::vector<DirectArc> arcs;  ///< sorted by vertex; lengths rounded as the graph's, start angles scaled
    Index centre = k_none;        ///< the vertex that the site is
  };

  void make_fan(Index site, const SurfacePoint& point, WindowPropagator& propagator);
  void make_fan_at_vertex(Fan& fan);
  void label_vertices(const JobStage& stage, std::vector<Index>& predecessor);
  void develop(const std::vector<Index>& predecessor, const JobStage& stage);
  const DirectArc* fan_arc(Index site, Index vertex) const;
  Place place_direct(const DirectArc& arc) const;
  Place place_after(Index vertex, Index previous);
  bool pull(Index vertex, Index site, Vec2& log);
  Vec2 lay_beside(Index halfedge, Index site) const;
  const Known* find_known(Index vertex, Index site) const;

  const SaddleVertexGraph& graph_;
  const Mesh& mesh_;
  ArcUnfolder unfolder_;
  UnfoldedArc unfolded_;
  std::vector<Fan> fans_;
  std::vector<Index> label_;
  std::vector<double> distance_;
  std::vector<Place> places_;
  std::vector<Index> first_known_;  ///< per vertex, a list through known_
  std::vector<Known> known_;
};

}  // namespace saddleback
