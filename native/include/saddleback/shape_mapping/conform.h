#pragma once
// Objects bent onto the surface, and rigid copies that stand on it.

#include <memory>

#include "saddleback/shape_mapping/map_shapes.h"

namespace saddleback {

class OutlineMapper;

/// Points fixed to a surface, so that they follow it when its vertices move.
struct ConformedPoints {
  MapFailure failure = MapFailure::none;  ///< of the shape; then nothing else is given
  SurfacePoints anchors;
  std::vector<double> heights;  ///< above the surface, mesh units
  std::vector<Index> lost;      ///< points that lie where the plane could not be laid; they are put at the center
};

/// Bends points onto a mesh, which must outlive it, for shape after shape in the same memory. One thread at a time.
class Conformer {
 public:
  explicit Conformer(const Mesh& mesh);
  ~Conformer();
  Conformer(Conformer&&) noexcept;
  Conformer& operator=(Conformer&&) noexcept;

  /// Bends points of a shape's space onto the surface: x and y by the map of the shape, z along the surface's normal,
  /// all to the placement's scale. Points beside the outline are laid as far as the surface goes on unfolded. Along the
  /// field where one is given. \throw InputError for a point that is not finite. O(m) besides the map, for m points in
  /// an order that leads from one to the next.
  ConformedPoints conform(const Shape& shape, const Placement& placement, const DirectionField* field,
                          std::span<const Vec3> points, const MapLimits& limits = {});

 private:
  std::unique_ptr<OutlineMapper> mapper_;
};

/// (V,) unit normals, the mean of those of the faces about each vertex by their angles. O(F).
std::vector<Vec3> vertex_normals(const Mesh& mesh);

/// The smooth normal at a point: those of the corners by their weights.
Vec3 normal_at(const Mesh& mesh, std::span<const Vec3> vertex_normals, const SurfacePoint& point);

/// Returns where anchored points are on this mesh: the one of the anchors, or the same one with other positions.
std::vector<Vec3> positions_of(const Mesh& mesh, std::span<const Vec3> vertex_normals, const SurfacePoints& anchors,
                               std::span<const double> heights);

/// A rigid copy: the shape's z axis along the smooth normal of the center, its x axis along the placement's direction.
struct RigidFrame {
  Vec3 position;
  Eigen::Quaterniond rotation;
  Vec3 scale;  ///< y negative for mirrored placements
};
std::vector<RigidFrame> rigid_frames(const Mesh& mesh, std::span<const Vec3> vertex_normals,
                                     std::span<const Placement> placements);

}  // namespace saddleback
