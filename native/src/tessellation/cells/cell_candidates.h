#pragma once
// Which sites may own a part of which face.

#include <optional>
#include <span>
#include <vector>

#include "tessellation/cells/candidate_rows.h"
#include "tessellation/cells/spread_candidates.h"
#include "tessellation/log_map/cell_log_maps.h"

namespace saddleback {

/// \throw InputError naming the first offender: no sites, a site off the mesh, a component without a site (`when`
/// begins its message).
void check_sites(const Mesh& mesh, const SurfacePoints& sites, const char* when = "");

/// Candidates by the labels and distances of the graph: the labels of a face's corners, and what CandidateSpread finds.
///
/// Keeps its memory for other sites, and the cells whose own sites and borders are as they were: where few sites move,
/// few cells are found anew, and the others are the same to the bit.
class CellCandidates {
 public:
  /// There are none before `find`. Graph and rings must outlive the candidates.
  /// `lengths`, `cuda_device` as for CellLogMaps.
  CellCandidates(const SaddleVertexGraph& graph, const VertexRings& rings, CellLengths lengths, int threads,
                 int cuda_device);
  CellCandidates(const CellCandidates&) = delete;
  CellCandidates& operator=(const CellCandidates&) = delete;

  /// The sites must have passed check_sites. \throw Cancelled, and then holds nothing of use.
  void find(const SurfacePoints& sites, const JobStage& stage);
  /// Finds cells that have grown beyond what their sites were asked for anew: then they are as if those had been asked
  /// without end. Of a `find` in which most sites moved; others do so themselves. \throw Cancelled, as `find`.
  void look_farther(const JobStage& stage);
  /// The next `find` keeps nothing.
  void forget() { is_complete_ = false; }
  /// Renumbers as SiteLabels::renumber does. The next `find` must be of as many sites.
  void renumber(std::span<const Index> before);
  /// Tells whether the last `find` left the cell, the parts of faces that it owns and how it sees them, as it was.
  bool is_as_before(Index site) const { return is_as_before_[site] != 0; }

  const CellLogMaps& maps() const { return maps_; }
  const SiteLabels& labels() const { return maps_.labels(); }
  const VertexRings& rings() const { return maps_.rings(); }
  const CandidateRows& rows() const { return rows_; }

 private:
  void find_once(const SurfacePoints& sites, std::span<const double> reaches,
                 const std::optional<std::vector<Index>>& others, const JobStage& stage);
  void begin_sites();
  void place_cells(const JobStage& stage);
  double add_from(Index node, Index site, VerticesBeside& beside);
  std::vector<double> reaches(const SurfacePoints& sites) const;
  std::vector<Index> sites_that_moved(const SurfacePoints& sites) const;
  void keep_candidates();
  void compare();

  const int threads_;
  CellLogMaps maps_;
  std::vector<VerticesBeside> beside_;  ///< by thread
  CandidateRows rows_;
  CandidateSpread spread_;
  CornersOfSites corners_;
  CellsBefore before_;
  std::vector<std::uint8_t> is_as_before_;  ///< by site
  bool is_complete_ = false;
};

}  // namespace saddleback
