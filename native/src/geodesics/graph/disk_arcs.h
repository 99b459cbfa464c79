#pragma once
// The arcs of a graph's nodes, packed.

#include <memory>
#include <vector>

#include "geodesics/graph/graph_arcs.h"
#include "geodesics/graph/visible_vertices.h"

namespace saddleback {

/// Appends an arc of a vertex to the last row.
void append_arc(const ArcSearch& search, const ArcCodec& codec, Index vertex, const DirectArc& arc, FoundArcs& found);

/// Writes what a GeodesicDisks sees as rows of arcs. One a thread.
class DiskRows {
 public:
  DiskRows(const ArcSearch& search, const WaveTables& tables, const ArcCodec& codec, const DiskRule& rule)
      : search_(search),
        mesh_(tables.mesh),
        sectors_(tables.sectors),
        codec_(codec),
        finder_(tables.mesh, search.kernel, rule, &tables.strips) {}

  /// Appends the arcs of nodes first to first + count - 1, at most k_batch. Mesh edges are always among them. Returns
  /// false, and appends none, when windows left the nodes for which tables are laid. \throw Cancelled.
  bool find(Index first, Index count, FoundArcs& found, const JobStage& stage);

 private:
  void write_row(Index node, int lane, FoundArcs& found);
  bool is_at_thin_face(Index node) const;
  void add_near(Index node, FoundArcs& found, const JobStage& stage);

  const ArcSearch& search_;
  const WindowMesh& mesh_;
  const WaveSectors& sectors_;
  const ArcCodec& codec_;
  GeodesicDisks finder_;
  std::vector<double> lengths_;  ///< of a row
  std::vector<float> leaving_, back_;
  std::unique_ptr<VisibleVertices> visible_;  ///< made for the first such face
  std::vector<DirectArc> near_;
};

}  // namespace saddleback
