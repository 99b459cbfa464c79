#pragma once
// One direction at a time is found; both are kept.

#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/job.h"

#include "geodesics/graph/arc_rows.h"
#include "geodesics/graph/window_batches.h"
#include "support/memory/returned_memory.h"

namespace saddleback {

/// Arcs out of consecutive nodes, as the windows find them.
struct FoundArcs {
  Index first_node = 0;
  std::vector<std::int32_t> counts;           ///< per node
  ReturnedVector<std::uint64_t> words;        ///< row after row
  ReturnedVector<std::uint8_t> back_sectors;  ///< per word: direction back, at the target
};

/// Holds the same, kept in memory without room to grow.
struct KeptArcs {
  KeptArcs() = default;
  KeptArcs(const FoundArcs& found, ReturnedPieces& memory);
  /// Holds what lies elsewhere.
  KeptArcs(Index first, std::span<const std::int32_t> the_counts, std::span<const std::uint64_t> the_words,
           std::span<const std::uint8_t> the_back_sectors)
      : first_node(first), counts(the_counts), words(the_words), back_sectors(the_back_sectors) {}
  Index first_node = 0;
  std::span<const std::int32_t> counts;
  std::span<const std::uint64_t> words;  ///< row after row, then k_row_padding more
  std::span<const std::uint8_t> back_sectors;

 private:
  ReturnedPieces::Owner memory_;
};

/// Holds the reverses of arcs from elsewhere into a range of nodes.
struct ArcsAcross {
  std::span<const Index> nodes;  ///< of the range
  std::span<const std::uint64_t> words;
};

/// The union of the found arcs and their reverses, the shorter of each pair. `found` holds the nodes of a range in
/// order, in blocks of the same size (but the last), and is emptied on the way; `across` those into the range, in any
/// order, from all other nodes. The same bytes for any size and any number of threads. O(arcs). \throw Cancelled.
ArcRows unite_with_reverses(const ArcCodec& codec, const WaveKernel& kernel, std::vector<KeptArcs>& found,
                            std::span<const ArcsAcross> across, int threads, const JobStage& stage);

}  // namespace saddleback
