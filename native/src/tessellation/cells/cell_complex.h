#pragma once
// The cells of sites as a subdivision of faces.

#include "saddleback/tessellation/geodesic_voronoi.h"

#include "tessellation/cells/face_candidates.h"

namespace saddleback {

/// Divides every face that several cells share into convex pieces; the others belong to one cell. Breaks on mesh edges
/// are computed once an edge, so that the pieces of neighboring faces fit to the bit. Tells of the diagram the
/// vertices' cells and distances, the faces' cells, the pieces by face, and the points: breaks on edges, then inner
/// points of faces. The same for any number of threads. \throw Cancelled.
GeodesicVoronoi divide_faces(const FaceCandidates& candidates, int threads, const JobStage& stage);

}  // namespace saddleback
