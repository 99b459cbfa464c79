#pragma once
// The cells of all weighted sites: most are read off a mesh, and those that doubles do not tell for certain are found
// each for itself, exactly.

#include <optional>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/support/large_array.h"
#include "saddleback/types.h"

#include "voronoi2d/sweep/triangulation.h"
#include "voronoi2d/weighted/weighted_cell.h"
#include "voronoi2d/weighted/weighted_mesh.h"
#include "voronoi2d/weighted/weighted_sites.h"

namespace saddleback::voronoi2d {

class WeightedCells {
 public:
  /// Finds the cells exactly, for up to `tile_size` sites at once; the cells do not depend on it. O(n log n) expected.
  /// \throw Cancelled
  WeightedCells(const WeightedSites& sites, Index tile_size, int threads, const JobStage& stage);

  /// A side and the corner behind it, counter-clockwise. What two cells share has one place, to leave its number there.
  struct Side {
    Index neighbor;
    Index edge;    ///< place of the edge
    Index vertex;  ///< place of the vertex, k_none at infinity
  };
  /// Appends a cell, by rank, from its lowest neighbor on. O(sides).
  void read(Index site, LargeArray<Side>& sides) const;
  /// Returns the lowest of the cells about the vertex of a place.
  Index lowest_about(Index vertex) const;
  /// Returns where the vertex of a place lies, times the sites' scale.
  Vec2 position(Index vertex) const;
  Index edge_place_count() const { return edge_place_count_; }
  Index vertex_place_count() const { return vertex_place_count_; }

 private:
  /// A cell that was found for itself.
  struct Exact {
    std::vector<WeightedCell::Side> sides;
    std::vector<Side> placed;
  };

  static constexpr Index k_wanted = -2;  ///< instead of where a cell is
  static constexpr Index k_few = 64;     ///< cells, a thread's work at a time

  void find_exactly(const std::vector<Index>& wanted, const JobStage& stage);
  template <class Visit>
  void visit_guess(Index site, Visit&& visit) const;
  std::vector<Index> misfits(const std::vector<Index>& found, const JobStage& stage);
  void place_exact_cells(const JobStage& stage);
  void place_by_mesh(Index site, Exact& cell, const JobStage& stage) const;
  void place_edge(Index site, Index side);
  void place_vertex(Index site, Index side);
  Index twin_of(Index site, const WeightedCell::Side& side) const;
  static Index before(const Exact& cell, Index side);
  bool is_exact(Index site) const { return exact_of_[site] != k_none; }
  Index far_away() const { return sites_.count(); }
  /// Vertices of so many places, the first ones, are the mesh's.
  Index in_mesh() const { return mesh_ ? mesh_->triangle_count() : 0; }

  const WeightedSites& sites_;
  DiskTree tree_;
  double heaviest_;
  int threads_;
  std::optional<WeightedMesh> mesh_;
  NeighborLists line_;          ///< instead, where all sites are on one
  LargeArray<Index> exact_of_;  ///< by rank: where its cell is, k_none for those of the mesh
  std::vector<Exact> exact_;
  /// A vertex that is not in the mesh.
  struct Vertex {
    Vec2 position;
    Index lowest;  ///< of the cells about it
  };
  std::vector<Vertex> vertices_;
  Index edge_place_count_ = 0, vertex_place_count_ = 0;
};

}  // namespace saddleback::voronoi2d
