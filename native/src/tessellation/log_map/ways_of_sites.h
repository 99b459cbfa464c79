#pragma once
// Ways in the graph from sites to vertices far outside their cells.

#include <limits>
#include <memory_resource>
#include <queue>
#include <unordered_map>

#include "tessellation/log_map/cell_log_maps.h"

namespace saddleback {

/// Finds shortest ways from sites, over vertices of any label. Each site's search is kept, and goes on from where it
/// was.
class WaysOfSites {
 public:
  /// The maps must outlive it.
  explicit WaysOfSites(const CellLogMaps& maps) : maps_(maps) {}
  /// Returns where a node would be if the way to it went on as it begins.
  PackedVec2 find(Index site, Index node);

 private:
  struct Search {
    struct Step {
      double distance;
      Index node;
      PackedVec2 towards;
      bool operator<(const Step& other) const {  // the nearest on top of a heap
        return distance != other.distance ? distance > other.distance : node > other.node;
      }
    };
    struct Reached {
      double distance = std::numeric_limits<double>::infinity();  ///< of the shortest way so far
      bool is_settled = false;
      PackedVec2 place = PackedVec2::Zero();  ///< once settled
    };
    std::priority_queue<Step> queue;
    std::pmr::unordered_map<Index, Reached> reached;
    void push(const Step& step);
  };
  Search begin(Index site);

  const CellLogMaps& maps_;
  std::pmr::monotonic_buffer_resource memory_;  ///< of the searches
  std::unordered_map<Index, Search> searches_;  ///< by site
};

}  // namespace saddleback
