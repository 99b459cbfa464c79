#pragma once
// Windows in the order of their distance, roughly.

#include "support/block_queue.h"

namespace saddleback {

/// Part [b0, b1] of a half-edge, about to enter its face, covered from the image of a root at (sx, sy), sy <= 0, in the
/// frame of the half-edge (see EdgeFrame). In the queue a window on half-edge ~v stands for vertex v itself.
struct Window {
  double sx, sy, b0, b1;
  double sigma;  ///< distance of the root
  Index halfedge;
  Index root;  ///< the vertex that the path comes from, or vertex_count + i for source i inside a face or edge
};

using WindowQueue = BlockQueue<Window>;
using WindowBlock = WindowQueue::Block;

}  // namespace saddleback
