#pragma once
// Two triangulations side by side become one [guibas1985].

#include <utility>
#include <vector>

#include "saddleback/job.h"

#include "support/threads/parallel.h"
#include "voronoi2d/sweep/planar_mesh.h"

namespace saddleback::voronoi2d {

/// Some of the triangles in arrays that many parts share, each over a range of sites. Without triangles when there are
/// fewer than three sites or all are on one line.
struct MeshPart {
  Index begin, end;  ///< sites
  Index leftmost, rightmost, lowest, highest;
  bool has_triangles = false;
  std::vector<std::pair<Index, Index>> free;  ///< ranges of unused triangles; all parts have room for two a site

  Index take_triangle() {
    while (free.back().first == free.back().second) free.pop_back();
    return 4 * free.back().first++;
  }
};

/// Joins parts that a level or an upright line parts.
class alignas(k_apart) MeshJoiner {
 public:
  /// Joins meshes: of the mesh only the arrays matter; bit k of `twins[4 t + 3]` is set where edge k and the one beyond
  /// have one circle. `leaving`: by site a half-edge from there, along the border for those on it.
  MeshJoiner(const PlanarMesh& mesh, Index* leaving, const JobStage& stage)
      : mesh_(mesh), leaving_(leaving), stage_(stage) {}

  /// Returns true when `result` is Delaunay's triangulation of both; false when nothing was done, because neither has
  /// triangles or no line parts them. O(changes) and as much as the borders. \throw Cancelled
  bool join(MeshPart& first, MeshPart& second, MeshPart& result);
  /// Makes a triangulation Delaunay's [lawson1977]. `doubtful`: half-edges among whose edges are all that do not pass
  /// the circle test or whose triangles share a circle; used up. \throw Cancelled
  void restore(std::vector<Index>& doubtful);

 private:
  /// Tells which of the parts is to the left as seen from somewhere outside.
  struct Sides {
    MeshPart *left, *right;
    Index left_end, right_end;  ///< the sites of each next to the line that parts them
    bool is_upright;
  };
  bool find_sides(MeshPart& first, MeshPart& second, Sides& sides) const;
  predicates::Sign turn(Index a, Index b, Index c) const {
    return predicates::orient_2d_by_steps(mesh_.point(a), mesh_.point(b), mesh_.point(c));
  }
  Index target(Index half) const { return mesh_.triangles[next_half(half)]; }
  Index before_on_border(Index half) const;
  Index add_triangle(MeshPart& part, Index a, Index b, Index c);
  void set_twins(Index a, Index b);
  /// An edge of a part's border, on the way around it from the base of the gap.
  struct RimEdge {
    Index site;  ///< where the way comes to
    Index half;  ///< in the triangle behind it, or ~ the number of a loose edge
  };
  /// Holds what lies between the parts, and is about to be closed.
  struct Gap {
    const MeshPart *left_part, *right_part;
    Index left, right;  ///< ends of the base
    Index base;         ///< half-edge from right to left; k_none at first
  };
  void close_gap(MeshPart& result, const Sides& sides);
  Gap gap_between(const Sides& sides) const;
  predicates::Sign place_in_circle(const Gap& gap, Index tip, Index site) const;
  Index close_further(MeshPart& result, Gap& gap, bool is_left);
  void list_rims(const Gap& gap);
  void note_place(const std::vector<RimEdge>& rim, std::size_t place);
  static std::size_t place_of(Index twin);
  bool sees(const Gap& gap, const std::vector<RimEdge>& rim) const;
  bool remove_behind(MeshPart& result, const Gap& gap, bool is_left);
  bool is_in_the_way(const Gap& gap, const RimEdge& edge, const MeshPart& part) const;
  void take_out(MeshPart& result, const Gap& gap, Index half);
  Index other_leaving(const Gap& gap, Index half) const;
  void attach(Index half, const RimEdge& edge);
  void join_sites(MeshPart& result, const MeshPart& sites, Index nearest, bool is_upright, bool is_ascending);
  Index join_site(MeshPart& result, Index site, Index nearest);
  void exchange(Index half);

  PlanarMesh mesh_;
  Index* leaving_;
  JobStage stage_;
  std::vector<Index> doubtful_, order_;
  std::vector<RimEdge> left_rim_, right_rim_;  ///< the next one last
  std::vector<Index> loose_;                   ///< edges without triangles: the half-edge of that which one gets first
};

}  // namespace saddleback::voronoi2d
