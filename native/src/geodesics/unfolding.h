#pragma once
// Tables for unfolding faces into a plane, a record a half-edge.

#include <span>

#include "saddleback/job.h"
#include "saddleback/large_array.h"
#include "saddleback/mesh.h"

namespace saddleback {

/// For each half-edge h = (v0 -> v1) of face f: where f's third corner lies in the frame with v0 at the origin and v1
/// on the positive x axis, and in which direction h leaves v0.
class Unfolding {
 public:
  /// \throw Cancelled.
  Unfolding(const Mesh& mesh, int threads, const JobStage& stage);
  const Mesh& mesh() const { return *mesh_; }
  const Vec2& apex(Index h) const { return apexes_[h]; }
  /// Surface angle of h at its origin: counter-clockwise from first_halfedge, 0 to total_angle, radians.
  const double& polar(Index h) const { return polars_[h]; }
  std::span<const double> polars() const { return polars_; }
  /// The same for the edge of h seen from to(h): also where h has no twin.
  double polar_of_reverse(Index h) const {
    const Index t = mesh_->twin(h);
    return t == k_none ? mesh_->total_angle(mesh_->to(h)) : polars_[t];
  }

 private:
  const Mesh* mesh_;
  LargeArray<Vec2> apexes_;
  LargeArray<double> polars_;
};

}  // namespace saddleback
