#pragma once
// Checks what a graph is to be built of, and whether numbers from a file describe one that a builder could have made.

#include <span>
#include <string>
#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "geodesics/graph/arc_rows.h"

namespace saddleback {

/// \throw InputError unless a graph of the mesh can be built so.
void check_options(const Mesh& mesh, const SaddleVertexGraphOptions& options);

/// \throw InputError "path: PATH is a damaged graph file: WHAT; ...".
[[noreturn]] void refuse_graph_file(const std::string& path, const std::string& what);

/// The node of each vertex. \throw InputError unless `vertices` holds every vertex once.
std::vector<Index> inverse_order(std::span<const Index> vertices, const std::string& path);

/// Every arc leads to another node of its component, once a row, in the codec's own bits, and has its reverse with the
/// same length. Rows may be as in a file, their targets out of range. O(arcs * degree). \throw InputError; Cancelled.
void check_arcs(const Mesh& mesh, const ArcRows& arcs, std::span<const Index> vertices, const std::string& path,
                const JobStage& stage);

}  // namespace saddleback
