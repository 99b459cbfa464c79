#pragma once
// The logarithmic map of a few faces, again and again from other points.

#include <array>
#include <span>
#include <vector>

#include "saddleback/mesh/surface_points.h"

namespace saddleback {

/// Places the corners of a patch of faces in the tangent plane of a point of the patch, by geodesics that stay in it:
/// in order of distance, each vertex is seen across an edge whose ends are placed, or along an edge where that is
/// shorter. After [melvaer2012]. Exact where the patch is flat and convex; of second order elsewhere.
class PatchLog {
 public:
  explicit PatchLog(const Mesh& mesh) : mesh_(mesh) {}
  /// Begins with other faces, in increasing order, in the memory of the last. Mesh and faces must outlive it. O(n).
  void begin(std::span<const Index> faces);

  /// Finds the log map about a point of a face of the patch; false when the face is not one of the patch's. O(n log n).
  bool run(const SurfacePoint& center);
  /// Finds the log map about a point near the last one, to all vertices by the ways that led there last: those to a few
  /// might be shorter on the other side of a vertex, by a square of the point's move. False where the ways are not
  /// known to go on from the new point; then run must be called. O(n).
  bool run_again(const SurfacePoint& center);
  /// Places of the corners of the i-th face in the plane, with the axes of CellLogMaps. After run.
  const Vec2& log(Index i, int corner) const { return places_[corners_[i][corner]]; }

 private:
  struct Reached {
    double distance;
    Index vertex;
    bool operator<(const Reached& other) const { return distance > other.distance; }  // the nearest on top of a heap
  };
  /// An edge of a face along the x axis, and the corner opposite.
  struct EdgeShape {
    double length, share;  ///< share: 1 / (2 length)
    double left, right;    ///< from the corner to the edge's start and end
    bool is_obtuse;        ///< whether the corner is
    Vec2 apex;
  };
  struct Foot {
    double x, depth_squared;
  };
  /// The way in which a vertex was placed.
  struct Way {
    Index vertex, edge;  ///< edge: as in edges_, opposite it in a face; k_none: it was known from the start
    Index from;          ///< the vertex before, along a side of the face; k_none: none, straight across the edge
  };
  void number_vertices();
  void list_faces_around();
  Index local_face(Index face) const;
  void start_in_face(const SurfacePoint& center, Index local);
  void start_at_vertex(Index vertex);
  void visit_face(Index local, Index vertex);
  void see_across(Index local, int edge);
  static Foot foot_of_center(const EdgeShape& edge, double to_start, double to_end);
  bool is_nearer(Index vertex, double distance) const;
  void begin_with(Index vertex, const Vec2& place, double distance);
  void offer(const Way& way, const Vec2& place, double distance);
  void walk(const Way& way, double length);
  bool follow(const Way& way, Index number);

  const Mesh& mesh_;
  std::span<const Index> faces_;
  std::vector<Index> vertices_;                ///< of the mesh
  std::vector<std::array<Index, 3>> corners_;  ///< of each face, into vertices_
  std::vector<Index> table_;                   ///< by hash: into vertices_
  std::vector<Index> first_, around_;          ///< faces at each vertex
  std::vector<EdgeShape> edges_;               ///< by face and edge
  std::vector<Vec2> places_;
  std::vector<double> distances_;
  std::vector<double> gains_;             ///< by how large a share a way must be shorter to count
  Index visits_ = 0;                      ///< so far, of vertices taken from the heap
  std::vector<Index> changed_, visited_;  ///< at which visit a vertex was last placed, and visited
  std::vector<Reached> heap_;
  Index first_face_ = k_none;    ///< in which run began, k_none where it lay on a border of it
  std::vector<Way> ways_;        ///< that were taken, in order
  std::vector<Index> last_way_;  ///< by vertex: of them
};

}  // namespace saddleback
