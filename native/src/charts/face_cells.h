#pragma once
// The cells of a plane diagram within one face of a chart.

#include <vector>

#include "saddleback/charts/chart.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

namespace saddleback::charts {

/// Holds what a corner of a piece is; equal for all pieces that share it.
struct CornerKey {
  enum class Kind : std::uint8_t { vertex, crossing, branch, curve };
  Kind kind;
  /// vertex: of the mesh; crossing: half-edge that speaks for the mesh edge; branch: vertex of the diagram; curve:
  /// point of a curved edge.
  Index a;
  Index b;  ///< crossing: edge of the diagram, or piece of a curved one; of these the half-edge of a seam it lies on
  bool operator==(const CornerKey&) const = default;
};

struct PieceCorner {
  CornerKey key;
  Vec2 place;
  Index halfedge;  ///< of the face that the corner lies on; k_none for mesh vertices, and inside
  Index side;      ///< the diagram's edge that follows the corner, k_none where a side of the face does
  Index line;      ///< else the half-edge
};

/// Part of a face in one cell: convex, counter-clockwise.
struct FacePiece {
  Index site;
  std::vector<PieceCorner> corners;
};

/// Divides a face among the cells, beginning with that of `site`, which must have a part of it; no pieces where it has
/// all. Neighbors of a cell come next where its piece has a side in common with them.
void divide_face(const Chart& chart, const Voronoi2d& diagram, Index face, Index site, std::vector<FacePiece>& pieces);

}  // namespace saddleback::charts
