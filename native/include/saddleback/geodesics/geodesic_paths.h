#pragma once
// Shortest paths in the graph as polylines on the surface.

#include <span>
#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"
#include "saddleback/mesh/trace.h"

namespace saddleback {

struct PathOptions {
  /// Says whether bends that no shortest path has (at vertices with less than pi on one side) are straightened to a
  /// local geodesic.
  bool shorten = false;
  int threads = 0;  ///< 0: all cores; the result does not depend on it
};

/// Many paths in flat arrays: path i has the points [offsets[i], offsets[i + 1]).
struct GeodesicPaths {
  std::vector<Vec3> points;
  SurfacePoints surface;
  std::vector<std::int64_t> offsets{0};
  std::vector<double> lengths;  ///< infinity where no source reaches; such a path has no points
  std::vector<Index> sources;   ///< at which source each path begins, k_none where none reaches

  std::size_t count() const { return lengths.size(); }
  GeodesicPath path(std::size_t i) const;
};

/// The path from `a` to `b` whose length is their distance in the graph: each arc unfolded into the faces that it
/// crosses, consecutive points share a face. It bends at vertices only. A shortest path bends at saddle vertices alone,
/// with at least pi on either side; all other bends are what the graph is inexact by, `shorten` removes them.
/// \throw InputError for a point off the mesh, points of two components (naming them); Cancelled. A distance field and
/// O(faces crossed).
GeodesicPath shortest_path(const SaddleVertexGraph& graph, const SurfacePoint& a, const SurfacePoint& b,
                           const PathOptions& options = {}, Job* job = nullptr);

/// Leads each path from each target's nearest source to the target, by one distance field. \throw as above, but for
/// targets that no source reaches: theirs are empty.
GeodesicPaths shortest_paths(const SaddleVertexGraph& graph, const SurfacePoints& sources, const SurfacePoints& targets,
                             const PathOptions& options = {}, Job* job = nullptr);

}  // namespace saddleback
