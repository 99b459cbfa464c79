#pragma once
// A graph found in ranges of its nodes, by as many processes or machines as there are.

#include <cstddef>
#include <cstdint>
#include <span>

#include "saddleback/geodesics/saddle_vertex_graph.h"
#include "saddleback/support/large_array.h"

namespace saddleback {

/// Holds a range's arcs as they travel: they say what they are of and hold a checksum.
using PartBytes = LargeArray<std::byte>;

/// \throw InputError when a mesh of so many triangles is larger than any graph can be built for, before it is read.
void check_graph_size(std::int64_t triangle_count);

/// Finds the arcs of a part of the nodes, 0 to parts - 1, which are about equal. Tables are laid for the range and what
/// lies about it alone, so that the parts take little longer together than all at once. Any number of threads and any
/// machine give the same bytes. \throw InputError for a part or options out of range, an exact graph or CUDA devices;
/// Cancelled. O(V / parts) times the windows of a disk, and O(V).
PartBytes find_arcs(const Mesh& mesh, Index part, Index parts, const SaddleVertexGraphOptions& options = {},
                    Job* job = nullptr);

/// Returns a part's arcs that lead into another part: all that `unite_arcs` needs of this one there. \throw InputError
/// for bytes that are no found arcs, and a part that is the same or out of range. O(arcs).
PartBytes arcs_across(std::span<const std::byte> arcs, Index part);

/// Unites a part's arcs with the reverses of all others: its rows of the graph. `across` holds what arcs_across gives
/// of each other part for this one. \throw InputError for bytes that do not belong together; Cancelled. O(arcs).
PartBytes unite_arcs(std::span<const std::byte> arcs, std::span<const std::span<const std::byte>> across,
                     int threads = 0, Job* job = nullptr);

}  // namespace saddleback
