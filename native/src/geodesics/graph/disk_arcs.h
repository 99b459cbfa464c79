#pragma once
// The arcs of a graph's nodes, packed.

#include <vector>

#include "geodesics/graph/arc_symmetry.h"
#include "geodesics/graph/geodesic_disks.h"

namespace saddleback {

/// Writes what a GeodesicDisks sees as rows of arcs. One a thread.
class DiskRows {
 public:
  DiskRows(const WindowMesh& mesh, const WaveSectors& sectors, const ArcCodec& codec, const WaveKernel& kernel,
           const DiskRule& rule)
      : sectors_(sectors), codec_(codec), kernel_(kernel), finder_(mesh, kernel, rule) {}

  /// Appends the arcs of nodes first to first + count - 1, at most k_batch. Mesh edges are always among them.
  /// \throw Cancelled.
  void find(Index first, Index count, FoundArcs& found, const JobStage& stage);

 private:
  void write_row(Index node, int lane, FoundArcs& found);

  const WaveSectors& sectors_;
  const ArcCodec& codec_;
  const WaveKernel& kernel_;
  GeodesicDisks finder_;
  std::vector<double> lengths_;  ///< of a row
  std::vector<float> leaving_, back_;
};

}  // namespace saddleback
