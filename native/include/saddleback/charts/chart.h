#pragma once
// Surfaces laid out in the plane: UV maps.

#include <memory>
#include <span>
#include <vector>

#include "saddleback/mesh/mesh.h"
#include "saddleback/mesh/surface_points.h"
#include "saddleback/types.h"

namespace saddleback {

/// A mesh whose faces lie side by side in the plane, in one or several islands: along a seam neighbors on the mesh are
/// none in the plane. Immutable; the mesh must outlive it.
class Chart {
 public:
  /// One place for each vertex (V), or one for each corner of each face (3 F). \throw InputError naming the first
  /// offender: another number of places, one that is not finite or beyond 1e60, a face that is flipped or without area
  /// in the plane (exact), two faces that overlap by more than rounding (k_rounding); Cancelled. O(F log F).
  Chart(const Mesh& mesh, std::span<const Vec2> uv, Job* job = nullptr);
  ~Chart();  // NOLINT(performance-trivially-destructible): Finder is known in the .cpp only
  Chart(Chart&&) noexcept;
  Chart& operator=(Chart&&) noexcept;

  const Mesh& mesh() const { return *mesh_; }
  /// (3 F) by half-edge: the place of the corner that it leaves.
  std::span<const Vec2> corners() const { return corners_; }
  /// Tells whether the faces on both sides of a half-edge lie side by side in the plane, too.
  bool is_joined(Index h) const {
    const Index twin = mesh_->twin(h);
    return twin != k_none && corners_[h] == corners_[Mesh::next(twin)] && corners_[Mesh::next(h)] == corners_[twin];
  }
  double area() const { return area_; }  ///< in the plane
  /// The point of the surface at each place, the face k_none where there is none; of several faces the smallest. Exact
  /// but for the rounding of coordinates. O(m log F). \throw InputError for a place that is not finite; Cancelled.
  SurfacePoints locate(std::span<const Vec2> places, int threads = 0, Job* job = nullptr) const;
  /// Returns where points of the surface lie in the plane. \throw InputError for a point off the mesh.
  std::vector<Vec2> places(const SurfacePoints& points) const;

  /// Overlaps up to this part of the largest coordinate count as none: coordinates often come as float32, and islands
  /// that touch then overlap by their rounding (2^-24).
  static constexpr double k_rounding = 0x1p-22;

 private:
  struct Finder;
  void check_faces(const JobStage& stage) const;
  void check_overlaps(const JobStage& stage) const;

  const Mesh* mesh_;
  std::vector<Vec2> corners_;
  double area_ = 0;
  std::unique_ptr<Finder> finder_;
};

/// The point of a face at a place of the plane; places beside the face are brought to its border.
SurfacePoint point_at(const Chart& chart, Index face, const Vec2& place);

}  // namespace saddleback
