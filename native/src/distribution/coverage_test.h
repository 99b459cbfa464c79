#pragma once
// Tests whether copies centered anywhere in a cell certainly meet what lies on the surface, or its border.

#include <optional>
#include <vector>

#include "saddleback/distribution/distribution.h"
#include "saddleback/mesh/trace.h"

#include "distribution/placing_rules.h"
#include "support/box_tree.h"

namespace saddleback::distribution {

class CoverageTest {
 public:
  /// A copy that one in the cell might meet, and how the cell's face lies in its plane.
  struct Neighbor {
    Index copy;
    double away;  ///< from its circumcircle to the cell's center
    Vec2 origin;
    Eigen::Matrix2d turn;
  };
  using Neighbors = std::vector<Neighbor>;
  /// Says what is known of all placements of a kind in a cell.
  struct Cover {
    bool is_whole = false;    ///< each meets a copy, or the border
    bool is_central = false;  ///< the one at the center does
    double motion = 0;        ///< by how much they differ
  };

  /// All must outlive this; what is `settled` may grow.
  CoverageTest(const Mesh& mesh, const PlacingRules& rules, const PlacedShapes& settled,
               const DistributionOptions& options);

  /// Finds the copies that the smallest ones may meet, the nearest first.
  void find_neighbors(const Cell& cell, const CellView& view, Neighbors& near) const;
  /// Kinds of which the disk about the center meets a copy wherever in the cell it is. It does not matter how they
  /// turn.
  std::uint64_t centrally_covered(const Cell& cell, const CellView& view, std::uint64_t kinds,
                                  const Neighbors& near) const;
  /// `copy`: the smallest of the kind at the cell's center; `tolerance`: its motion that is not worth a finer cell.
  Cover cover(const Cell& cell, const CellView& view, Index kind, const Copy& copy, const Neighbors& near,
              double tolerance) const;

 private:
  void flag_borders();
  void list_forbidden_faces();
  /// How copies bend counts where a proof is wanted; to look for room they are near enough to straight ones.
  bool proves_bent() const { return options_->maximal && options_->bend; }
  Cover straight_cover(const CellView& view, const Copy& copy, const Neighbors& near, double tolerance) const;
  Cover bent_cover(const Cell& cell, const CellView& view, Index kind, const Copy& copy, double tolerance) const;
  /// Points of a copy, in its own plane, and where they lie on the surface: many are asked for again.
  using Traced = std::vector<std::pair<Vec2, std::optional<TraceEnd>>>;
  std::optional<TraceEnd> trace(const CellView& view, const Copy& copy, const Vec2& point) const;
  bool is_traced_into_another(const CellView& view, const Copy& copy, const Motion& motion) const;
  bool trace_to(const CellView& view, const Copy& copy, const Vec2& point, Index other, Traced& traced,
                Vec2& place) const;
  bool is_certain(const CellView& view, const Copy& copy, const Motion& motion, const Overlap& found, const Pose& pose,
                  Index other, Traced& traced) const;
  bool meets_border(const CellView& view, const Copy& copy, const Motion& motion) const;
  double depth_at(const SurfacePoint& point) const;
  bool is_beyond_border(const CellView& view, const Copy& copy, const Motion& motion, const Vec2& point) const;
  bool is_beyond_border(const CellView& view, const Copy& copy, const Motion& motion) const;
  bool is_on_forbidden(const CellView& view, const Copy& copy, const Motion& motion) const;
  bool is_certainly_on(const SurfacePoint& place, const CellView& view, const Copy& copy, const Motion& motion,
                       const Vec3& x, const Vec3& y) const;

  const Mesh* mesh_;
  const PlacingRules* rules_;
  const PlacedShapes* settled_;
  const DistributionOptions* options_;
  std::vector<std::uint8_t> near_border_;  ///< per face; empty where there is none
  std::vector<double> forbidden_depth_;    ///< per vertex: at least so far within what is forbidden
  std::vector<Index> forbidden_faces_;
  BoxTree<Vec3> forbidden_boxes_{{}};  ///< of these faces; empty where lengths are not those of the positions
};

}  // namespace saddleback::distribution
