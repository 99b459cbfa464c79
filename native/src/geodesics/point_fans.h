#pragma once
// From points of the surface to vertices of the graph.

#include <memory>
#include <span>
#include <vector>

#include "geodesics/graph_search.h"
#include "geodesics/window_propagation.h"

namespace saddleback {

/// The arcs between a point and vertices, rounded as the graph's arcs are; a point that is a vertex has one of length
/// 0.
struct PointFan {
  struct Arc {
    Index vertex;
    double length;
  };
  std::vector<Arc> arcs;  ///< by vertex
  double reach = 0;       ///< the longest
  bool is_vertex = false;
};

/// Finds fans one after the other; one a thread, made when first needed.
class FanFinder {
 public:
  PointFan find(const SaddleVertexGraph& graph, const SurfacePoint& point);

 private:
  std::unique_ptr<WindowPropagator> propagator_;
  std::vector<DirectArc> arcs_;
};

/// The fans of many points, by all cores. \throw Cancelled.
std::vector<PointFan> find_fans(const SaddleVertexGraph& graph, const SurfacePoints& points, const JobStage& stage);

/// Each fan's arcs as seeds of its own source.
std::vector<Seed> seeds_of(std::span<const PointFan> fans);

}  // namespace saddleback
