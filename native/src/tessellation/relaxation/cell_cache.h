#pragma once
// The cells that relaxations on one graph can take over from each other.

#include <array>
#include <memory>
#include <mutex>
#include <optional>
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

  bool fits(const SaddleVertexGraph& graph, int threads, int cuda_device) const;
  /// Keeps cells with another density, and finds all their moments anew. O(F).
  void change_density(std::span<const double> density);
  const CellCandidates& candidates() const { return candidates_; }
  /// False before the first `find` and after one that was cancelled.
  bool is_whole() const { return is_whole_; }
  /// Gives sites that are where some were before those one's numbers. Sites that are not in the same order as before
  /// count as moved.
  void match(const SurfacePoints& sites);
  /// \throw Cancelled, DeviceError, and then all cells are found anew the next time.
  const std::vector<CellMoments>& find(const SurfacePoints& sites, const JobStage& stage);
  /// Passes on to CellCandidates::look_farther.
  void look_farther(const JobStage& stage);

 private:
  const SaddleVertexGraph& graph_;
  std::vector<double> density_;
  const int threads_, cuda_device_;
  const VertexRings rings_;
  std::optional<CellIntegrals> integrals_;  ///< by the density
  CellCandidates candidates_;
  std::vector<CellMoments> moments_;  ///< none where those known are of another density
  bool is_whole_ = false;             ///< nothing was cancelled
};

/// Cells that a relaxation looked at last, and those that it showed of its result.
enum class CachedCells { relaxed, shown };

class CellCache::Content {
 public:
  /// Keeps cells and returns those that were kept. Null is nothing.
  std::unique_ptr<KnownCells> exchange(CachedCells which, std::unique_ptr<KnownCells> cells);

 private:
  std::mutex mutex_;
  std::array<std::unique_ptr<KnownCells>, 2> cells_;
};

/// Known cells for a call; those of a cache where they fit, and back into it when the call is done.
class BorrowedCells {
 public:
  /// `cache` may be null. Both must outlive it.
  BorrowedCells(CellCache* cache, CachedCells which, const SaddleVertexGraph& graph, std::span<const double> density,
                int threads, int cuda_device);
  ~BorrowedCells();
  BorrowedCells(const BorrowedCells&) = delete;
  BorrowedCells& operator=(const BorrowedCells&) = delete;
  KnownCells& operator*() const { return *cells_; }
  KnownCells* operator->() const { return cells_.get(); }

 private:
  CellCache* cache_;
  const CachedCells which_;
  std::unique_ptr<KnownCells> cells_;
};

}  // namespace saddleback
