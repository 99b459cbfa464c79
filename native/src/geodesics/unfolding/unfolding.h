#pragma once
// Tables for unfolding faces into a plane, a record a half-edge.

#include <algorithm>
#include <span>

#include "saddleback/job.h"
#include "saddleback/mesh/mesh.h"
#include "saddleback/support/large_array.h"

namespace saddleback {

/// A half-edge's face in the frame of the half-edge: its start at the origin, its end on the positive x axis.
struct UnfoldedFace {
  Vec2 apex;
  double to_end;  ///< from the apex to the end, along x
};
/// Either of the two ways along x is off by a few roundings of the side there, not of the longest edge.
UnfoldedFace unfold(const Mesh& mesh, Index h);
/// Tells whether a face has an edge that is short beside another: lengths tell too little of its direction.
inline bool is_needle(double base, double left, double right) {
  return std::min({base, left, right}) <= std::max({base, left, right}) / 16;
}

/// Knows, for each half-edge h = (v0 -> v1) of face f: where f's third corner lies in the frame with v0 at the origin
/// and v1 on the positive x axis, and in which direction h leaves v0.
class Unfolding {
 public:
  /// Keeps both in tables. \throw Cancelled.
  Unfolding(const Mesh& mesh, int threads, const JobStage& stage);
  /// Finds either whenever it is asked for: what asks for few does without tables.
  explicit Unfolding(const Mesh& mesh) : mesh_(&mesh) {}
  const Mesh& mesh() const { return *mesh_; }
  Vec2 apex(Index h) const {
    if (apexes_.empty()) [[unlikely]]
      return unfold(*mesh_, h).apex;
    return apexes_[h];
  }
  /// UnfoldedFace::to_end.
  double to_end(Index h) const {
    const Index right = Mesh::next(h);
    const double base = mesh_->length(h), side = mesh_->length(right);
    if (!is_needle(base, mesh_->length(Mesh::prev(h)), side)) return base - apex(h).x();
    return apex(right).x() * (side / base);
  }
  /// Surface angle of h at its origin: counter-clockwise from first_halfedge, 0 to total_angle, radians.
  /// O(1) by the tables, O(degree) without.
  double polar(Index h) const {
    if (polars_.empty()) [[unlikely]]
      return sum_to(h);
    return polars_[h];
  }
  std::span<const double> polars() const { return polars_; }
  /// Returns the same for the edge of h seen from to(h): also where h has no twin.
  double polar_of_reverse(Index h) const {
    const Index t = mesh_->twin(h);
    return t == k_none ? mesh_->total_angle(mesh_->to(h)) : polar(t);
  }

 private:
  double sum_to(Index h) const;
  const Mesh* mesh_;
  LargeArray<Vec2> apexes_;
  LargeArray<double> polars_;
};

}  // namespace saddleback
