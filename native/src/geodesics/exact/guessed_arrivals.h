#pragma once
// A first guess of how shortest paths come to vertices, which takes little time.

#include <vector>

#include "saddleback/job.h"

#include "geodesics/exact/exact_surface.h"

namespace saddleback {

/// A shortest path comes straight from its root, which is a source or a vertex where it bends.
struct GuessedArrival {
  static constexpr Index k_along_edge = -2, k_at_source = -3;
  double distance;  ///< infinity where no source reaches, or only beyond the limit
  double sigma;     ///< distance of the root
  double x, y;      ///< from the root to the vertex, in the frame of the half-edge
  Index halfedge;   ///< through whose face it comes, to the apex; or one of those above
  Index from;       ///< along an edge: from this vertex
  Index source;
  Index root;  ///< the vertex that it bent at last, k_none where it is the source
};

struct GuessExtent {
  double limit;     ///< of distances
  double vertices;  ///< within it, about: what is done is a share of them
};

/// Distances of the surface's vertices, usually some thousandths too long or too short: from vertex to vertex, the two
/// nearer corners of a face telling those of the third as if their paths came from one root. (Trettner, Bommes and
/// Kobbelt, "Geodesic distance computation via virtual source propagation", 2021, in the simple form that keeps the
/// roots at vertices.) \throw Cancelled. O(V).
std::vector<GuessedArrival> guessed_arrivals(const ExactSurface& surface, const SurfacePoints& sources,
                                             const GuessExtent& extent, const JobStage& stage);

}  // namespace saddleback
