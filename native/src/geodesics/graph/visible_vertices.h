#pragma once
// The vertices that a point of the surface sees along one straight geodesic, and their distances.

#include <cstdint>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/surface_points.h"

#include "geodesics/unfolding/unfolding.h"

namespace saddleback {

/// A straight geodesic from the source to a vertex.
struct DirectArc {
  Index vertex;
  double length;
  double start_angle;  ///< at the source: in the FaceChart of its face, or at a vertex from first_halfedge
  double end_angle;    ///< direction back to the source, at the vertex from first_halfedge
};

/// Window propagation after [chen1990] with the filters of [xin2009], kept to the windows of the source itself:
/// vertices behind a saddle vertex get an upper bound by edges, which is enough to kill windows that serve nothing.
/// Windows and vertices leave one queue in order of distance, until k vertices are settled.
///
/// Two rules make it right on regular grids, where rays run through lattice points: a window updates an apex on its
/// very border (closed interval), and ties never remove a window. Holds scratch memory of O(V + F) to be reused; one a
/// thread.
class VisibleVertices {
 public:
  explicit VisibleVertices(const Unfolding& unfolding);

  /// Fills `arcs` with the vertices among the k nearest that the vertex sees, and all its neighbors by mesh edges.
  /// \throw Cancelled.
  void from_vertex(Index source, Index k, std::vector<DirectArc>& arcs, const JobStage& stage);
  /// Does the same for a point that need not be a vertex; the corners of its face are always among the arcs.
  void from_point(const SurfacePoint& source, Index k, std::vector<DirectArc>& arcs, const JobStage& stage);

 private:
  /// Part [b0, b1] of half-edge h, about to enter h's face, covered by the source at `source` (y <= 0) in the frame of
  /// h.
  struct Window {
    Vec2 source;
    double b0, b1;
    double rotation;  ///< polar angle, at the source, of the x axis of h's frame
    Index halfedge;
  };
  struct VertexState {
    double distance;             ///< upper bound of the geodesic distance
    double direct;               ///< length of the shortest straight geodesic found
    double start_angle;          ///< of that geodesic; when it came by a window, the rotation of `offset`'s frame
    double end_angle;            ///< of that geodesic; unused when it came by a window
    Vec2 offset = Vec2::Zero();  ///< source to vertex in the frame of `halfedge`
    Index halfedge;              ///< whose window reached the vertex as its apex, k_none for a mesh edge
    std::uint32_t epoch;
    bool settled, neighbor;
    bool is_direct() const { return direct <= distance; }
  };
  /// The best window that covered the angle opposite a half-edge: "one angle, one split".
  struct Occupant {
    double distance, split;
    std::uint32_t epoch;
  };
  struct Event {
    double key;
    Index id;  ///< window >= 0, vertex ~id
    bool operator<(const Event& other) const { return key != other.key ? key > other.key : id > other.id; }
  };
  /// A child's side of its parent's face, in coordinates that start at the base vertex they share.
  struct Side {
    bool left;
    Index near, far;  ///< base vertices: shared with the child edge, and the other one
    Index edge;       ///< half-edge of the parent's face
    double length;    ///< of the child edge
    Vec2 direction;   ///< of the child edge
    Vec2 source;
  };

  void begin();
  VertexState& state(Index vertex);
  double distance(Index vertex) const;
  void add_neighbor(Index vertex, double length, double start_angle, double end_angle);
  void offer_bound(Index vertex, double distance);
  void offer_direct(Index vertex, double distance, const Window& window, const Vec2& offset);
  void push(const Event& event);
  void push_window(const Window& window);
  void run(Index k, const JobStage& stage);
  void settle(Index vertex);
  void propagate(const Window& window);
  Side side_of(const Window& window, bool left) const;
  void add_child(const Window& parent, const Side& side, double begin, double end, bool to_apex);
  bool is_useless(const Side& side, const Vec2& source, double q0, double q1, Index apex, double base) const;
  void collect(std::vector<DirectArc>& arcs);

  const Unfolding& unfolding_;
  const Mesh& mesh_;
  std::vector<VertexState> vertices_;
  std::vector<Occupant> occupants_;
  std::vector<Window> windows_;
  std::vector<Event> queue_;
  std::vector<Index> touched_;
  std::uint32_t epoch_ = 0;
  Index settled_ = 0, windows_alive_ = 0, direct_pending_ = 0;
};

}  // namespace saddleback
