#pragma once
// The rules for what may be laid at a point: which kinds of copies, how turned, how large.

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "saddleback/distribution/distribution.h"
#include "saddleback/support/one_or_each.h"

#include "distribution/cell.h"
#include "distribution/collision/collision_shape.h"
#include "distribution/collision/overlap.h"
#include "distribution/flat_faces.h"
#include "distribution/placed_shapes.h"
#include "shape_mapping/center_line.h"

namespace saddleback::distribution {

/// A shape in one of the directions that the field offers, mirrored or not. Position tells the rest.
struct Kind {
  Index shape;
  int turn;  ///< which of the field's directions
  bool is_mirrored;
};

inline constexpr std::size_t k_most_kinds = 64;  ///< a bit of a word each, see maximal_sampling

/// A cell, and how much direction and size of a shape change over it.
struct CellView {
  SurfacePoint center;
  Vec2 place;               ///< the center in the face's plane
  double radius;            ///< farthest corner from the center
  Index shape = k_none;     ///< whose angle and size these are
  double angle = 0;         ///< of the field at the center
  double angle_spread = 0;  ///< by how much it differs elsewhere in the cell
  double size = 0, size_spread = 0;
};

class PlacingRules {
 public:
  PlacingRules(const Mesh& mesh, std::span<const Shape> shapes, const DistributionOptions& options,
               const JobStage& stage);

  std::span<const Kind> kinds() const { return kinds_; }
  const FlatFaces& flat() const { return flat_; }
  /// The largest circumradius of anything that is laid, gap included, and the smallest without.
  double largest_radius() const { return largest_radius_; }
  double smallest_radius() const { return smallest_radius_; }
  double shape_radius(const Kind& kind) const { return radii_[kind.shape]; }
  /// Returns how often to try it, against others: by their areas.
  double weight_of(const Kind& kind) const;
  double inradius(Index kind) const { return inradii_[kinds_[kind].shape]; }
  /// Returns the circumradius of the smallest copies where shapes are largest, without the gap.
  double radius_of_smallest_copies() const;
  double smallest_body_area() const { return smallest_body_area_; }  ///< the gap included, mesh units
  double smallest_factor() const { return smallest_factor_; }
  /// The mean of the squares of the factors that copies are scaled by.
  double mean_square_factor() const {
    return (smallest_factor_ * smallest_factor_ + smallest_factor_ * largest_factor_ +
            largest_factor_ * largest_factor_) /
           3;
  }

  /// Returns the mean of the squares of the shapes' sizes at the middle of a face, and of their areas in their planes.
  double mean_square_size(Index face) const;
  double mean_area() const;

  /// Finds all but what depends on the shape, which `see` adds: most cells are decided without.
  CellView view(const Cell& cell) const;
  void see(const Cell& cell, Index shape, CellView& view) const;
  double size_at(Index shape, Index face, const Vec2& weights) const;
  double size_at(Index shape, const SurfacePoint& point) const {
    return size_at(shape, point.face, {point.barycentric[1], point.barycentric[2]});
  }
  /// Returns how far the smallest copies at a place reach, the gap included.
  double reach_at(Index face, const Vec2& weights) const;

  /// A copy of the kind at a point where its field has this angle.
  Copy copy(Index kind, const SurfacePoint& center, double field_angle, double scale) const;
  Copy copy(const Placement& placement) const {
    return {placement, &body(placement.shape, placement.mirrored, placement.scale), 0};
  }
  /// Returns the same without the gap, of one that lies there already.
  Copy bare_copy(const Placement& placement) const {
    return {placement, bare_[2 * static_cast<std::size_t>(placement.shape) + (placement.mirrored ? 1 : 0)].get(), 0};
  }
  double field_angle(Index kind, const SurfacePoint& point) const {
    return one_or_each(fields_, kinds_[kind].shape)->angle_at(point);
  }
  /// Returns what a copy bends along; none where it does not.
  std::optional<CenterLine> line(const Placement& placement) const;
  /// Returns by how much the points of a copy move when its center does within the cell.
  Motion motion(const CellView& view, double factor) const {
    return {view.radius, factor * (view.size * view.angle_spread + view.size_spread)};
  }

 private:
  void turn(const Cell& cell, const DirectionField& field, CellView& view) const;
  const CollisionShape& body(Index shape, bool is_mirrored, double scale) const;
  void make_bodies(std::span<const Shape> shapes, const DistributionOptions& options, const JobStage& stage);

  const Mesh* mesh_;
  FlatFaces flat_;
  std::vector<const DirectionField*> fields_;  ///< one, or one a shape
  std::span<const Shape> shapes_;
  bool bends_;
  std::vector<std::vector<double>> size_;  ///< one, or one a shape
  double smallest_factor_, largest_factor_;
  std::vector<double> radii_, inradii_, areas_;  ///< per shape
  std::vector<Kind> kinds_;
  std::vector<std::vector<std::unique_ptr<CollisionShape>>>
      bodies_;                                         ///< per shape and side, by size where there is a gap
  std::vector<std::unique_ptr<CollisionShape>> bare_;  ///< without the gap, where some lie there already
  std::vector<double> least_scales_;                   ///< per shape
  double largest_radius_ = 0, smallest_radius_ = 0, largest_body_radius_ = 0, smallest_body_area_ = 0;
};

}  // namespace saddleback::distribution
