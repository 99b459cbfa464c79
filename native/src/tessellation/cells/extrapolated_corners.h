#pragma once
// Corners of faces that neither a site nor a vertex of its cell sees.

#include <limits>
#include <memory_resource>
#include <queue>
#include <unordered_map>

#include "tessellation/cells/candidate_rows.h"
#include "tessellation/log_map/cell_log_maps.h"

namespace saddleback {

/// Lays down corners of long faces that cells without vertices cross. The first face that lays one decides, for all.
class ExtrapolatedCorners {
 public:
  /// Both must outlive it.
  ExtrapolatedCorners(const CellLogMaps& maps, const JobStage& stage) : maps_(maps), stage_(stage) {}
  static constexpr double k_unknown = std::numeric_limits<double>::quiet_NaN();  ///< of a corner that is yet to be laid

  /// Null where the corner has not been laid.
  const PackedVec2* find(Index site, Index node) const;
  /// Completes a candidate, beyond a side of its face (k_none: its site lies in the face): by what is seen across the
  /// side, else along arcs. \throw Cancelled.
  void complete(CellCandidate& candidate, Index side);

 private:
  /// Extrapolates from one site; goes on from where it was.
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
  PackedVec2 along_arcs(Index site, Index node);
  std::optional<PackedVec2> seen_beyond(Index halfedge, const PackedVec2& from, const PackedVec2& to) const;

  const CellLogMaps& maps_;
  const JobStage& stage_;
  std::pmr::monotonic_buffer_resource memory_;  ///< of the searches
  std::unordered_map<std::uint64_t, PackedVec2> corners_;
  std::unordered_map<Index, Search> searches_;  ///< by site
};

}  // namespace saddleback
