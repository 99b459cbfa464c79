#pragma once
// Lays outlines on a surface.

#include "saddleback/shape_mapping/surface_outline.h"
#include "saddleback/shapes/placement.h"
#include "saddleback/shapes/shape.h"

#include "shape_mapping/center_line.h"
#include "shape_mapping/shape_map.h"

namespace saddleback {

/// Lays outlines on a mesh, which must outlive it, again and again in the same memory. One thread at a time.
class OutlineMapper {
 public:
  using Loop = std::vector<Vec2>;

  explicit OutlineMapper(const Mesh& mesh);

  /// Maps by the exponential map about placement.center. `loops` are simple and disjoint, outlines counter-clockwise
  /// and holes clockwise, as a Shape gives them. When the answer is `none` the map is injective on the shape: all faces
  /// that it touches are laid out upright, the outline closes, and no other face maps into it. Otherwise `outline` has
  /// no meaning. Nothing is checked about the arguments. O(n log n + c m) for n vertices within the shape's box, c
  /// corners and m vertices in or about the shape.
  MapFailure map(std::span<const Loop> loops, const Placement& placement, SurfaceOutline& outline,
                 const MapLimits& limits = {});

  /// Does the same along a center line of the placement's: the shape bends with the line, and placement.angle does not
  /// count.
  MapFailure map_along(std::span<const Loop> loops, const Placement& placement, const CenterLine& line,
                       SurfaceOutline& outline, const MapLimits& limits = {});

  /// Returns where a point of a shape's plane lies in the plane that was laid last.
  Vec2 laid(const Vec2& point) const {
    const Vec2 scaled(point.x() * scale_.x(), point.y() * scale_.y());
    return {turn_.x() * scaled.x() - turn_.y() * scaled.y(), turn_.y() * scaled.x() + turn_.x() * scaled.y()};
  }
  /// The other way round.
  Vec2 given(const Vec2& place) const {
    const Vec2 turned(turn_.x() * place.x() + turn_.y() * place.y(), turn_.x() * place.y() - turn_.y() * place.x());
    return {turned.x() / scale_.x(), turned.y() / scale_.y()};
  }

  /// The face that a point of the plane lies in, walking from `face`, whose corners must be laid out. Beside a shape
  /// the plane may cover the surface twice; a point in the shape or on its outline is found on the faces that it
  /// touches. Elsewhere any face will do. Where there is none, `face` is the one of the center. O(faces on the way),
  /// seldom O(faces of the shape). \pre the last shape was mapped without a failure.
  MapFailure find(const Vec2& point, Index& face);

  /// The plane as it was laid last, in mesh units and not mirrored.
  const ShapeMap& plane() const { return plane_; }
  ShapeMap& plane() { return plane_; }

 private:
  void lay_corners(std::span<const Loop> loops, const Placement& placement, double turn);
  MapFailure cut();
  void cut_loop(std::size_t begin, std::size_t end);
  void walk(const Vec2& a, const Vec2& b, Index corner);
  Index exit_of(const Vec2& a, const Vec2& b) const;
  double cross_weight(Index h, const Vec2& a, const Vec2& b) const;
  bool is_in_face(const Vec2& corner) const;
  Vec2 weights_in_face(const Vec2& corner) const;
  void begin(SurfaceOutline& outline, const MapLimits& limits);
  struct Stretch {
    double smallest = 0, largest = 0;
  };
  bool is_soundly_laid(Index face) const;
  MapFailure measure(Index face, Stretch& stretch) const;
  MapFailure look_at(Index vertex, std::span<const ShapeMap::Spoke> about);
  void enter(Index face);
  void find_inside();
  bool is_in_shape(const Vec2& vertex) const;
  void complete_star(Index vertex);
  void check_crossings();
  bool has_inside(Index vertex) const { return inside_stamps_[vertex] == stamp_; }
  const Vec2& place(Index vertex) const { return plane_.coordinates(vertex); }

  const Mesh* mesh_;
  ShapeMap plane_;
  Vec2 scale_ = Vec2::Ones();  ///< mesh units for one of the shape's, along its axes: negative for mirrored ones
  Vec2 turn_ = Vec2::UnitX();  ///< the shape's x axis
  std::vector<Vec2> corners_;
  std::vector<Index> given_;  ///< per corner: number of the given edge that begins there
  std::vector<std::size_t> begins_;
  std::vector<Index> touched_;  ///< faces
  LargeArray<std::uint32_t> face_stamps_, inside_stamps_;
  std::vector<Index> crossed_;  ///< edges, by their smaller half-edge
  std::uint32_t stamp_ = 0;
  std::size_t settled_ = 0;  ///< vertices of the plane that have been looked at while it was laid
  SurfaceOutline* outline_ = nullptr;
  MapLimits limits_;
  PlaneBox box_;
  Index face_ = 0;
  Vec2 weights_ = Vec2::Zero();  ///< of where the walk is
};

/// Lays one shape. Along the field where one is given and has a direction at the center.
MapFailure map_shape(OutlineMapper& mapper, const Shape& shape, const Placement& placement, const DirectionField* field,
                     SurfaceOutline& outline, const MapLimits& limits = {});

}  // namespace saddleback
