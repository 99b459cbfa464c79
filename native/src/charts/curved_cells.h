#pragma once
// The cells of a plane diagram with curved edges within the faces of a chart.

#include <vector>

#include "saddleback/charts/chart.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

#include "charts/face_cells.h"

namespace saddleback::charts {

/// The faces of a chart among cells whose edges are polylines.
struct CurvedCells {
  std::vector<Index> face_site;                ///< (F) of faces that no edge divides
  std::vector<std::vector<FacePiece>> pieces;  ///< (F) triangles; none of a face that no edge comes to. A corner's
                                               ///< `side` is set for the cell on the left of the edge alone
};

/// Divides each face by the constrained Delaunay triangulation of what of the edges lies in it. No point of an edge is
/// farther from its polyline than the tolerance. \throw Cancelled
CurvedCells divide_faces(const Chart& chart, const Voronoi2d& diagram, double tolerance, int threads,
                         const JobStage& stage);

}  // namespace saddleback::charts
