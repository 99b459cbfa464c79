#pragma once
// The mesh as window propagation wants it: neighbors in space are neighbors in memory, one cache line a half-edge.

#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/mesh.h"
#include "saddleback/mesh/surface_points.h"

namespace saddleback {

/// A half-edge h = (from -> to) with its face laid out in the frame of h: `from` at the origin, `to` on the positive x
/// axis, the apex above it. A window on h is about to enter this face.
struct alignas(64) EdgeFrame {
  double length;
  double apex_x, apex_y;
  double left_length, right_length;  ///< of the face's edges from-apex and apex-to
  Index left, right;                 ///< half-edges on the far side of those two edges, k_none on the boundary
  Index from, to, apex;
  float to_end_rest;  ///< of `length`: what rounding leaves out of length - apex_x, too much for a needle's short side

  /// Returns the length from the apex to the end, along x.
  double to_end() const { return (length - apex_x) + static_cast<double>(to_end_rest) * length; }
};
static_assert(sizeof(EdgeFrame) == 64);

/// A source that is no vertex, in a face that it lies in. One on an edge lies in both faces.
struct SourceInFace {
  Index face;
  Index source;
  Vec3 barycentric;
};

/// Holds the same in a face on one of the two sides of a half-edge, in the frame of that.
struct SourceBeside {
  Vec2 place;
  Index source;
  Index next;  ///< of the same half-edge
};

/// The components of a mesh that hold sources, renumbered along a Hilbert curve, and where the sources are in them.
/// Half-edge 3f+i belongs to corner i of the renumbered face f, as in Mesh.
class ExactSurface {
 public:
  /// \throw Cancelled.
  ExactSurface(const Mesh& mesh, const SurfacePoints& sources, const JobStage& stage);

  const Mesh& mesh() const { return *mesh_; }
  Index vertex_count() const { return static_cast<Index>(mesh_vertex_.size()); }
  Index halfedge_count() const { return static_cast<Index>(frames_.size()); }
  const EdgeFrame& frame(Index h) const { return frames_[h]; }

  /// k_none on the boundary.
  Index twin(Index h) const { return frames_[Mesh::prev(h)].right; }
  std::span<const SourceInFace> sources_in(Index face) const;
  std::span<const SourceInFace> sources_in_faces() const { return in_faces_; }  ///< all, by face
  bool has_sources_beside(Index h) const { return !first_beside_.empty() && first_beside_[h] != k_none; }
  /// Visits the sources that lie in one of the two faces at a half-edge.
  template <class Visit>
  void for_sources_beside(Index h, Visit&& visit) const {
    if (first_beside_.empty()) return;
    for (Index i = first_beside_[h]; i != k_none; i = beside_[i].next) visit(beside_[i]);
  }
  /// Returns where the point of the half-edge's face is, in the frame of the half-edge.
  Vec2 in_frame(Index h, const Vec3& barycentric) const {
    const EdgeFrame& frame = frames_[h];
    const double at_to = barycentric[Mesh::next(h) % 3], at_apex = barycentric[Mesh::prev(h) % 3];
    return {at_to * frame.length + at_apex * frame.apex_x, at_apex * frame.apex_y};
  }
  /// Returns where a shortest path may bend: on the boundary, or the total angle exceeds 2 pi by more than rounding.
  bool may_bend(Index vertex) const { return bends_[vertex] != Bends::never; }
  /// Tells whether it is so near to a source that rounding leaves gaps between rays on their way round it: it emits
  /// what a source there would.
  bool is_beside_source(Index vertex) const { return bends_[vertex] == Bends::all_round; }

  /// Tells whether the angle of some vertex is less than a right one.
  bool has_tips() const { return !tip_tangents_.empty(); }
  /// Returns the tangent of a vertex's total angle; infinity where that is not less than a right one. Only where there
  /// are tips.
  double tangent_of_tip(Index vertex) const { return tip_tangents_[vertex]; }

  /// Tells whether it is on a component with a source.
  bool holds(Index mesh_face) const { return face_of_[mesh_face] != k_none; }

  // Between the mesh's numbers and those here.
  Index vertex_of(Index mesh_vertex) const { return vertex_of_[mesh_vertex]; }
  Index face_of(Index mesh_face) const { return face_of_[mesh_face]; }
  Index halfedge_of(Index mesh_halfedge) const { return 3 * face_of_[mesh_halfedge / 3] + mesh_halfedge % 3; }
  Index mesh_vertex(Index vertex) const { return mesh_vertex_[vertex]; }
  Index mesh_face(Index face) const { return mesh_face_[face]; }
  Index mesh_halfedge(Index h) const { return 3 * mesh_face_[h / 3] + h % 3; }
  std::size_t nbytes() const;

 private:
  enum class Bends : std::uint8_t { never, at_pi, all_round };
  void renumber(const SurfacePoints& sources, const JobStage& stage);
  void lay_out(const JobStage& stage);
  void place_sources(const SurfacePoints& sources);

  const Mesh* mesh_;
  std::vector<Index> vertex_of_, face_of_, mesh_vertex_, mesh_face_;
  std::vector<EdgeFrame> frames_;
  std::vector<Bends> bends_;
  std::vector<double> tip_tangents_;
  std::vector<SourceInFace> in_faces_;
  std::vector<SourceBeside> beside_;
  std::vector<Index> first_beside_;  ///< of each half-edge; empty where all sources are vertices
};

}  // namespace saddleback
