#pragma once
// Paths that several threads find in blocks, in one list.

#include <mutex>
#include <optional>
#include <vector>

#include "saddleback/geodesics/geodesic_paths.h"

namespace saddleback {

/// Joins blocks as soon as all before them are there: what is joined last, all at once, would touch as much memory
/// again as finding did, and nobody could tell how long that takes.
class JoinedPaths {
 public:
  explicit JoinedPaths(std::size_t block_count) : ready_(block_count) {}
  /// Adds a block's paths, which are `share` of all. Any thread may call it. Leaves `part` empty.
  void add(std::size_t block, double share, GeodesicPaths& part);
  /// Hands over the paths, when all blocks were added.
  GeodesicPaths take() { return std::move(paths_); }

 private:
  struct Block {
    GeodesicPaths paths;
    double share;
  };
  std::optional<Block> next();
  void append(const Block& block);

  std::mutex guard_;
  std::vector<std::optional<Block>> ready_;
  std::size_t next_ = 0;
  bool is_joining_ = false;  ///< some thread is, and takes what becomes ready meanwhile
  // Of the thread that joins:
  double share_ = 0;
  GeodesicPaths paths_;
};

}  // namespace saddleback
