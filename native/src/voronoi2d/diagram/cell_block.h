#pragma once
// The cells of some sites in a row, side by side: what is done to each of their corners and sides is then one long loop
// instead of a short one for each cell, whose ends no processor predicts.

#include <algorithm>
#include <array>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"

#include "voronoi2d/sweep/triangulation.h"

namespace saddleback::voronoi2d {

/// Sides of cells, counter-clockwise, beginning with the lowest neighbor; an open cell's first and last neighbors are
/// those on the border. Corner k of a cell lies after its side k; the last one of an open cell is at infinity.
class CellBlock {
 public:
  static constexpr Index k_most = 128;  ///< cells

  CellBlock();
  /// Cells of the `count` sites from `begin` on. `leaving`: for each a half-edge from there, at the border the one
  /// along it, counter-clockwise. \throw Cancelled
  void gather(const Triangulation& mesh, const Index* leaving, Index begin, Index count, const JobStage& stage);
  /// Calls work(i) for i in [begin, end): numbers of sides, of which one cell may have most. \throw Cancelled
  template <class Work>
  static void for_sides(Index begin, Index end, const JobStage& stage, Work&& work) {
    constexpr Index k_at_once = 1 << 14;
    while (begin < end) {
      stage.check();
      for (const Index stop = begin + std::min(k_at_once, end - begin); begin < stop; ++begin) work(begin);
    }
  }

  Index cell_count = 0, size = 0;          ///< `size`: sides of all cells
  std::array<Index, k_most + 1> starts{};  ///< by cell: its first side
  std::array<Index, k_most> lowest{};      ///< by cell: the lowest neighbor; -1 where vertices of more cells may be
  std::vector<Index> open;                 ///< cells that are
  std::vector<Index> halves;               ///< by side: from the site, or to it for the last side of an open cell
  std::vector<Index> sites, neighbors;     ///< by side: of either side
  std::vector<Index> next_neighbors;       ///< by side: beyond the next side; k_none after the last of an open cell

 private:
  static constexpr Index k_few = 8;       ///< triangles about most sites
  static constexpr Index k_together = 2;  ///< cells
  /// Counts the sides of some cells in a row, 0 where there are more than a few. False, and all 0, if one is open.
  template <Index Together>
  bool gather_few(const Triangulation& mesh, const Index* leaving, Index cell);
  void gather_few_flat(const Triangulation& mesh, Index first, Index cell);
  bool gather_any(const Triangulation& mesh, Index first, const JobStage& stage);
  void append_few(Index cell, Index cell_site);
  void append_any(Index cell_site, bool is_open, const JobStage& stage);
  void make_room(Index more, const JobStage& stage);

  // Sides of cells with few, `k_few` places for each, before they are turned to begin with the lowest neighbor.
  std::vector<Index> few_half_, few_neighbor_;
  std::array<Index, k_most> few_size_{}, few_lowest_{};  ///< by cell; 0: not few
  std::vector<Index> any_half_, any_neighbor_;           ///< of a cell with any number
  Index any_lowest_ = 0;
};

}  // namespace saddleback::voronoi2d
