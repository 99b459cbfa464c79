#pragma once
// The cells that relaxations on one graph can take over from each other.

#include <memory>
#include <vector>

#include "saddleback/tessellation/cell_cache.h"

#include "tessellation/cells/cell_candidates.h"
#include "tessellation/cells/cell_moments.h"

namespace saddleback {

/// Cells of some sites with their moments, and what they are made with. Few of them are found anew when few of the
/// sites move.
class KnownCells {
 public:
  /// The graph must outlive it. `lengths`, `cuda_device` as for CellLogMaps.
  KnownCells(const SaddleVertexGraph& graph, std::span<const double> density, CellLengths lengths, int threads,
             int cuda_device);

  bool fits(const SaddleVertexGraph& graph, std::span<const double> density, int threads, int cuda_device) const;
  const CellCandidates& candidates() const { return candidates_; }
  /// False before the first `find` and after one that was cancelled.
  bool is_whole() const { return is_whole_; }
  /// Gives sites that are where some were before those one's numbers. Sites that are not in the same order as before
  /// count as moved.
  void match(const SurfacePoints& sites);
  /// \throw Cancelled, DeviceError, and then all cells are found anew the next time.
  const std::vector<CellMoments>& find(const SurfacePoints& sites, const JobStage& stage);
  /// As CellCandidates::look_farther.
  void look_farther(const JobStage& stage);

 private:
  const SaddleVertexGraph& graph_;
  const std::vector<double> density_;
  const int threads_, cuda_device_;
  const VertexRings rings_;
  CellIntegrals integrals_;
  CellCandidates candidates_;
  std::vector<CellMoments> moments_;
  bool is_whole_ = false;  ///< nothing was cancelled
};

struct CellCache::Content {
  std::unique_ptr<KnownCells> cells;
};

/// Known cells for a call; those of a cache where they fit, and back into it when the call is done.
class BorrowedCells {
 public:
  /// `cache` may be null. Both must outlive it.
  BorrowedCells(CellCache* cache, CellCache::Cells which, const SaddleVertexGraph& graph,
                std::span<const double> density, int threads, int cuda_device);
  ~BorrowedCells();
  BorrowedCells(const BorrowedCells&) = delete;
  BorrowedCells& operator=(const BorrowedCells&) = delete;
  KnownCells& operator*() const { return *cells_; }
  KnownCells* operator->() const { return cells_.get(); }

 private:
  CellCache* cache_;
  const CellCache::Cells which_;
  std::unique_ptr<KnownCells> cells_;
};

}  // namespace saddleback
