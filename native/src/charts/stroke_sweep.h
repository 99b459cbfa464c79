#pragma once
// What a map by distance can hold: triangles on one side of a curve, in the order of their distance.

#include <span>
#include <vector>

#include "charts/stroke_sheet.h"

namespace saddleback::charts {

/// Triangles of a sheet as they hang together, where walls part them: on both sides of those vertices are others.
struct PartedSheet {
  PartedSheet(const Sheet& sheet, const JobStage& stage);

  static Index next(Index h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static Index prev(Index h) { return h % 3 == 0 ? h + 2 : h - 1; }
  Index from(Index h) const { return vertices[h]; }
  /// The half-edge between two nodes, k_none when there is none in this direction.
  Index halfedge(Index from_node, Index to_node) const;

  std::vector<Index> vertices;       ///< that half-edges 3t+k leave
  std::vector<Index> twins;          ///< k_none at walls and at the border
  std::vector<Index> nodes;          ///< of the vertices
  std::vector<Index> begins, stars;  ///< half-edges that leave vertex v: stars[begins[v]] ... stars[begins[v + 1]]

 private:
  std::vector<std::pair<std::uint64_t, Index>> by_nodes_;  ///< ascending
};

/// The lines about one side of a curve, as half-edges of which the side is on the left.
struct SideBorder {
  std::vector<Index> curve;       ///< one for each piece, k_none where there is nothing on this side
  std::vector<Index> start, end;  ///< of lines across its ends, from the curve on
};

enum class Held : std::uint8_t { nothing, at_start, at_end };

/// A disk whose triangles have one by one been set on the chain of edges above the curve: no vertex but those that are
/// left on the chain is as far away as all of its neighbors, and none but the curve's as near.
struct SweptSide {
  std::vector<Index> triangles;
  std::vector<Index> vertices;        ///< in the order of their distance, without the curve's
  std::vector<Held> held;             ///< by vertex of the sheet: on a line across an end
  std::vector<std::uint8_t> is_last;  ///< by vertex of the sheet: left on the chain
};

/// Takes vertices in the order of their distance, with the triangles between them and what has been taken. Where a
/// vertex meets the chain in two places (the fronts about an obstacle) it is joined to one of them. Marks what it takes
/// in `taken`, and lifts vertices that are level with what they cover, by less than 1e-4 of the radius. O(n log n).
/// \throw Cancelled
SweptSide sweep_side(Sheet& sheet, const PartedSheet& parted, const SideBorder& border, double radius,
                     std::vector<std::uint8_t>& taken, const JobStage& stage);

}  // namespace saddleback::charts
