#pragma once
// Candidates that spread from face to face until none wins more.

#include <vector>

#include "tessellation/cells/candidate_rows.h"
#include "tessellation/log_map/vertices_beside.h"

namespace saddleback {

class ExtrapolatedCorners;

/// Tells of the corners of faces how the sites see them that are candidates there.
struct CornersOfSites {
  std::vector<double> farthest;               ///< by site: how far; 0 where there are none
  std::vector<std::uint8_t> is_extrapolated;  ///< by site: whether some are laid down; who asks first has a say
  /// Takes in a candidate's corners. Safe for several at once.
  void add(const CellCandidate& candidate);
  void mark_extrapolated(Index site);
};

/// Candidates of the cells before.
struct CellsBefore {
  CandidateRows rows;
  std::vector<std::uint8_t> is_kept;  ///< by site: how it sees corners is as it was
  bool keeps(Index site) const { return is_kept[site] != 0; }
  /// Null where there is none, or the cell is not kept.
  const CellCandidate* find(Index face, Index site) const;
};

/// Spreads candidates over edges. The candidates of a face begin with the labels of its corners and the sites that lie
/// in it; a site that is nearest on a part of an edge, by the lower envelope there, is requested for the face beyond,
/// until nothing changes. Thus cells smaller than a face, or without any vertex, are found: a cell is connected, and
/// its site's own face begins the walk. Keeps its memory.
class CandidateSpread {
 public:
  /// `beside`: a thread's own each. All must outlive it.
  CandidateSpread(const CellLogMaps& maps, std::vector<VerticesBeside>& beside, int threads);
  ~CandidateSpread();
  /// Cells must be placed. `rows` has the candidates of mixed faces, and gets the others. \throw Cancelled.
  void run(const SurfacePoints& sites, const CellsBefore& before, CandidateRows& rows, CornersOfSites& corners,
           const JobStage& stage);

 private:
  struct Worker;
  struct Request {
    Index face, site;
    Index side;  ///< of the face, beyond which the site is nearest; k_none: it lies in the face
    auto operator<=>(const Request&) const = default;
  };
  /// The tables that candidates spread over.
  struct Ground {
    const CellsBefore& before;
    CandidateRows& rows;
    CornersOfSites& corners;
  };
  void begin(const SurfacePoints& sites, const Ground& ground);
  std::vector<Request> all_requests();
  void add(const std::vector<Request>& requests, const Ground& ground, ExtrapolatedCorners& corners);
  bool make(const Request& request, const Ground& ground, const ExtrapolatedCorners& corners, Worker& worker,
            CellCandidate& candidate) const;
  void yield_to_labels(CellCandidate& candidate, CornersOfSites& corners) const;
  template <class Visit>
  void visit(Index face, const CandidateRows& rows, Visit&& visit) const;
  bool is_settled(Index face, const CandidateRows& rows) const;
  void find_requests(Index face, const CandidateRows& rows, Worker& worker) const;
  void request(const Request& request, const CandidateRows& rows, std::vector<Request>& requests) const;
  void merge_added(CandidateRows& rows);

  const CellLogMaps& maps_;
  const VertexRings& rings_;
  const int threads_;
  std::vector<Worker> workers_;
  struct Added {
    CellCandidate candidate;
    Index before;  ///< the face's one before, k_none for the first
  };
  std::vector<Index> last_added_;  ///< by face: its last one in added_, or k_none
  std::vector<Added> added_;
  Index first_newest_ = 0;          ///< of added_, since faces were last looked at; 0: all candidates are new
  std::vector<Index> added_faces_;  ///< in increasing order
};

}  // namespace saddleback
