#pragma once
// The edges of a diagram as straight pieces, and where they come to faces of a chart.

#include <optional>
#include <vector>

#include "saddleback/charts/chart.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

#include "charts/face_cells.h"
#include "support/box_tree.h"

namespace saddleback::charts {

/// A place where a piece comes to a face: one of its ends, or where it crosses an edge or a vertex of the mesh.
struct Meeting {
  CornerKey key;
  Vec2 place;
  Index halfedge;  ///< of the face that the place lies on; k_none for mesh vertices, and inside
  int corner;      ///< of the face, -1 for all but mesh vertices
  double share;    ///< of the half-edge's length; those of both half-edges of a mesh edge sum to 1 exactly
  double along;    ///< the piece
};

/// Pieces of all edges, within a tolerance of the curves. What meets what is decided by mesh edge and piece alone, so
/// that the faces on both sides find the same.
class EdgePieces {
 public:
  EdgePieces(const Chart& chart, const Voronoi2d& diagram, double tolerance, const JobStage& stage);

  /// Lists the pieces that may come to a face, ascending.
  void find(Index face, std::vector<Index>& pieces) const;
  /// Lists where a piece comes to a face, in order along it: within the face it is straight between these places.
  void meet(Index face, Index piece, std::vector<Meeting>& meetings) const;
  /// Returns the diagram's edge that a piece is of.
  Index edge(Index piece) const { return pieces_[piece].edge; }

 private:
  struct Piece {
    Index edge, first;  ///< number of the point that it begins at, the next one being its end
  };
  struct End {
    Vec2 place;
    CornerKey key;
  };

  void add_edge(const Voronoi2d& diagram, Index edge, double tolerance, double extent);
  void add_point(const Vec2& place, Index vertex);
  std::optional<Meeting> meet_end(Index face, Index point) const;
  std::optional<Meeting> crossing(Index h, Index piece) const;
  Meeting on_edge(Index h, const Vec2& place, CornerKey key) const;

  const Chart& chart_;
  std::vector<Index> corners_;  ///< by vertex of the diagram: that which stands for it
  std::vector<End> points_;
  std::vector<Piece> pieces_;
  std::vector<Box<Vec2>> boxes_;
  std::optional<BoxTree<Vec2>> tree_;
};

}  // namespace saddleback::charts
