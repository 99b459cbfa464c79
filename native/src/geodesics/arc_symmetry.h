#pragma once
// One direction at a time is found; both are kept.

#include <vector>

#include "saddleback/arc_rows.h"
#include "saddleback/job.h"

#include "geodesics/window_waves.h"
#include "support/returned_memory.h"

namespace saddleback {

/// Arcs out of consecutive nodes, as the windows found them.
struct FoundArcs {
  Index first_node = 0;
  std::vector<std::int32_t> counts;           ///< per node
  ReturnedVector<std::uint64_t> words;        ///< row after row, then k_row_padding more
  ReturnedVector<std::uint8_t> back_sectors;  ///< per word: direction back, at the target
};

/// The union of the found arcs and their reverses, the shorter of each pair. `found` holds the nodes in order, in
/// blocks of the same size (but the last), and is emptied on the way. The same bytes for any size and any number of
/// threads. O(arcs). \throw Cancelled.
ArcRows unite_with_reverses(const ArcCodec& codec, const WaveKernel& kernel, std::vector<FoundArcs>& found, int threads,
                            const JobStage& stage);

}  // namespace saddleback
