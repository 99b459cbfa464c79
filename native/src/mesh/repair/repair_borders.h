#pragma once
// Borders that nearly meet: found, told and stitched.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "saddleback/mesh/repair.h"

#include "mesh/repair/repair_steps.h"

namespace saddleback {

/// A border vertex at another border's edge.
struct BorderContact {
  Index vertex, halfedge;
  double along;     ///< 0 to 1 from the half-edge's start
  double distance;  ///< to the edge
  double to_end;    ///< to the nearer end of the edge where that is within reach, else -1
};

/// Holds what counts as near: within a distance, or within a share of the edge's length, whichever is more. After so
/// many pairs of a vertex and an edge the search ends.
struct Reach {
  double distance, share;
  std::int64_t most_visits = std::numeric_limits<std::int64_t>::max();
};

/// All contacts of border vertices with border edges of which they are no end, nor the third corner of its face; by
/// half-edge, those of one in their order along it. O(B) expected for B border edges of similar length.
std::vector<BorderContact> border_contacts(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                           const Reach& reach, const JobStage& stage);

/// Divides border edges where border vertices lie amid them, on the edge but for rounding or within the distance.
void stitch_borders(RepairState& state, double weld_distance, const JobStage& stage);

/// Divides a face's side at vertices in their order along it; its apex stays a corner of all parts.
void divide_edge(RepairState& state, Index face, int side, std::span<const Index> amid);

/// Returns what a person should know of borders that nearly meet; nothing is changed.
CloseBorders tell_close_borders(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                const JobStage& stage);

/// Fills border loops of up to `most_edges` edges by their triangulations of least area; counts in the state what was
/// filled and what was left open. \pre manifold. O(n^3) for a loop of n edges.
void fill_holes(RepairState& state, Index most_edges, const JobStage& stage);

}  // namespace saddleback
