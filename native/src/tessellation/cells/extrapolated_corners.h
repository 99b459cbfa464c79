#pragma once
// Corners of faces that neither a site nor a vertex of its cell sees.

#include <limits>
#include <unordered_map>

#include "tessellation/cells/candidate_rows.h"
#include "tessellation/log_map/ways_of_sites.h"

namespace saddleback {

/// Lays down corners of long faces that cells without vertices cross. The first face that lays one decides, for all.
class ExtrapolatedCorners {
 public:
  /// Both must outlive it.
  ExtrapolatedCorners(const CellLogMaps& maps, const JobStage& stage) : maps_(maps), stage_(stage), ways_(maps) {}
  static constexpr double k_unknown = std::numeric_limits<double>::quiet_NaN();  ///< of a corner that is yet to be laid

  /// Null where the corner has not been laid.
  const PackedVec2* find(Index site, Index node) const;
  /// Completes a candidate, beyond a side of its face (k_none: its site lies in the face): by what is seen across the
  /// side, else along arcs. \throw Cancelled.
  void complete(CellCandidate& candidate, Index side);

 private:
  std::optional<PackedVec2> seen_beyond(Index halfedge, const PackedVec2& from, const PackedVec2& to) const;

  const CellLogMaps& maps_;
  const JobStage& stage_;
  std::unordered_map<std::uint64_t, PackedVec2> corners_;
  WaysOfSites ways_;
};

}  // namespace saddleback
