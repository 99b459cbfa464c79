#pragma once
// The three ways to choose a graph's arcs.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "geodesics/graph/arc_symmetry.h"
#include "geodesics/graph/geodesic_disks.h"

namespace saddleback {

/// Holds what waves of windows run on.
struct WaveTables {
  WindowMesh mesh;
  WaveSectors sectors;
  BorderStrips strips;
  /// Lays them for all nodes. \throw InputError for more triangles than slots can be numbered for; Cancelled.
  WaveTables(const Unfolding& unfolding, std::span<const Index> nodes, std::span<const Index> vertices, int threads,
             const JobStage& stage);
  /// Lays them for some. \throw as above.
  WaveTables(const Unfolding& unfolding, const LaidNodes& laid, std::span<const Index> nodes,
             std::span<const Index> vertices, int threads, const JobStage& stage);

 private:
  WaveTables(const Unfolding& unfolding, const NodeEdges& edges, const LaidNodes& laid, std::span<const Index> nodes,
             std::span<const Index> vertices, int threads, const JobStage& stage);
};

/// Nodes whose arcs are kept together: so many that what is done for each block is nothing, so few that no thread waits
/// long for the last.
inline constexpr Index k_nodes_a_block = 128;
/// Returns how many blocks nodes make.
inline Index block_count(Index node_count) { return (node_count + k_nodes_a_block - 1) / k_nodes_a_block; }

/// \throw InputError for more triangles than slots can be numbered for.
void check_mesh_size(std::int64_t triangle_count);

/// Holds where arcs are looked for.
struct ArcSearch {
  const Unfolding& unfolding;
  std::span<const Index> nodes, vertices;  ///< nodes of the vertices, vertices of the nodes
  const WaveKernel& kernel;
  int threads = 0;
};

/// Returns what a graph of the given options keeps, of vertices and of other points.
DiskRule disk_rule(Index k, double accuracy, Lattice lattice = Lattice::none);

/// Finds the arcs by waves of windows. \throw Cancelled. O(V) times the windows of a disk.
std::vector<KeptArcs> disk_arcs(const ArcSearch& search, const ArcCodec& codec, const WaveTables& tables,
                                const DiskRule& rule, const JobStage& stage);

/// Finds the arcs of some blocks of nodes with tables for these and some about them. Blocks whose windows left those
/// are kept without arcs. \throw Cancelled.
std::vector<KeptArcs> disk_arcs_of(std::span<const Index> blocks, const ArcSearch& search, const ArcCodec& codec,
                                   const WaveTables& tables, const DiskRule& rule, const JobStage& stage);

/// All straight geodesics of the mesh. \throw InputError when the graph would not fit into memory; Cancelled. O(V^2 log
/// V).
std::vector<KeptArcs> exact_arcs(const ArcSearch& search, const ArcCodec& codec, const JobStage& stage);

/// The fastest kernel that this machine runs for "auto", or the one named. \throw InputError when there is none.
const WaveKernel& wave_kernel(const std::string& instructions);

}  // namespace saddleback
