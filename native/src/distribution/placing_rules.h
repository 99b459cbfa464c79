#pragma once
// The rules for what may be laid at a point: which kinds of copies, how turned, how large.

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "saddleback/distribution/distribution.h"

#include "distribution/cell.h"
#include "distribution/collision_shape.h"
#include "distribution/flat_faces.h"
#include "distribution/overlap.h"
#include "distribution/placed_shapes.h"
#include "shape_mapping/center_line.h"

namespace saddleback::distribution {

/// A shape in one of the directions that the field offers, mirrored or not. Position tells the rest.
struct Kind {
  Index shape;
  int turn;  ///< which of the field's directions
  bool is_mirrored;
};

/// A cell, and how much direction and size change over it.
struct CellView {
  SurfacePoint center;
  Vec2 place;           ///< the center in the face's plane
  double radius;        ///< farthest corner from the center
  double angle;         ///< of the field at the center
  double angle_spread;  ///< by how much it differs elsewhere in the cell
  double size, size_spread;
};

class PlacingRules {
 public:
  PlacingRules(const Mesh& mesh, std::span<const Shape> shapes, const DistributionOptions& options,
               const DirectionField& field, const JobStage& stage);

  std::span<const Kind> kinds() const { return kinds_; }
  const FlatFaces& flat() const { return flat_; }
  /// The largest circumradius of anything that is laid, gap included, and the smallest without.
  double largest_radius() const { return largest_radius_; }
  double smallest_radius() const { return smallest_radius_; }
  double shape_radius(const Kind& kind) const { return radii_[kind.shape]; }
  double shape_area(const Kind& kind) const { return areas_[kind.shape]; }
  double inradius(Index kind) const { return inradii_[kinds_[kind].shape]; }
  double largest_inradius() const { return *std::max_element(inradii_.begin(), inradii_.end()); }
  /// Returns the radius of bodies, the gap included, in units of their planes.
  double largest_body_radius() const { return largest_body_radius_; }
  double largest_shape_radius() const { return *std::max_element(radii_.begin(), radii_.end()); }
  double smallest_body_area() const { return smallest_body_area_; }  ///< the gap included, mesh units
  double smallest_factor() const { return smallest_factor_; }
  /// The mean of the squares of the factors that copies are scaled by.
  double mean_square_factor() const {
    return (smallest_factor_ * smallest_factor_ + smallest_factor_ * largest_factor_ +
            largest_factor_ * largest_factor_) /
           3;
  }

  /// Finds all but the angle and its spread, which `turn` adds: most cells are decided without them.
  CellView view(const Cell& cell) const;
  void turn(const Cell& cell, CellView& view) const;
  double size_at(Index face, const Vec2& weights) const;
  double size_at(const SurfacePoint& point) const {
    return size_at(point.face, {point.barycentric[1], point.barycentric[2]});
  }

  /// A copy of the kind at a point where the field has this angle.
  Copy copy(Index kind, const SurfacePoint& center, double field_angle, double scale) const;
  double field_angle(const SurfacePoint& point) const { return field_->angle_at(point); }
  /// Returns what a copy bends along; none where it does not.
  std::optional<CenterLine> line(const Placement& placement) const;
  /// Returns by how much the points of a copy move when its center does within the cell.
  Motion motion(const CellView& view, double factor) const {
    return {view.radius, factor * (view.size * view.angle_spread + view.size_spread)};
  }

 private:
  const CollisionShape& body(Index kind, double scale) const;
  void make_bodies(std::span<const Shape> shapes, const DistributionOptions& options, const JobStage& stage);

  const Mesh* mesh_;
  FlatFaces flat_;
  const DirectionField* field_;
  std::span<const Shape> shapes_;
  bool bends_;
  std::vector<double> size_;
  double smallest_factor_, largest_factor_;
  std::vector<double> radii_, inradii_, areas_;  ///< per shape
  std::vector<Kind> kinds_;
  std::vector<std::vector<std::unique_ptr<CollisionShape>>>
      bodies_;  ///< per shape and side, by size where there is a gap
  double least_scale_ = 1;
  double largest_radius_ = 0, smallest_radius_ = 0, largest_body_radius_ = 0, smallest_body_area_ = 0;
};

}  // namespace saddleback::distribution
