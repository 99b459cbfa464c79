#pragma once
// The innermost loop of every query: offers a distance along all arcs of a row.

#include <cstdint>

#include "geodesics/graph/arc_rows.h"

namespace saddleback {

/// Nodes whose distance a row has lowered, with it and the one before; at most k_most a call.
struct LoweredNodes {
  static constexpr int k_most = 256;
  int count = 0;
  Index nodes[k_most];
  double distances[k_most];
  double before[k_most];
};

/// Holds what is offered along a row, and where it is written.
struct RowOffer {
  double distance;      ///< of the row's node
  double* distances;    ///< of all nodes
  const Index* labels;  ///< of all nodes, or null: then only shorter distances are taken
  Index label;          ///< of the row's node: at equal distance it takes a node from a larger label
};

/// Relaxes for each of the first `count` <= LoweredNodes::k_most words of a row (its targets are distinct): lowers the
/// target's distance to offer.distance + length where that is less, and lists the targets that the offer wins. At equal
/// distance a smaller label wins as well. Labels are the caller's to write.
using RelaxRow = void (*)(const ArcCodec& codec, const std::uint64_t* words, int count, const RowOffer& offer,
                          LoweredNodes& lowered);

/// The fastest that this machine runs: AVX2 or plain C++. Sums of arcs are exact: both give the same bits.
RelaxRow relax_row();
/// The one in plain C++, which the other is tested against.
RelaxRow relax_row_portable();

}  // namespace saddleback
