#pragma once
// Exact distances from a wave front of rays: from a point, or at right angles from a curve.

#include <functional>
#include <limits>
#include <vector>

#include "saddleback/job.h"

#include "geodesics/unfolding/unfolding.h"
#include "geodesics/wavefront/query_points.h"
#include "geodesics/wavefront/ray_barriers.h"
#include "geodesics/wavefront/ray_window.h"
#include "support/block_queue.h"

namespace saddleback {

/// Holds what is known of a vertex.
struct RayLabel {
  double distance = std::numeric_limits<double>::infinity();
  double value = 0;  ///< angle of departure or arc length of the foot; behind a saddle vertex that vertex's
  std::int8_t side = 0;
  bool shadowed = false;  ///< the shortest way bends at a saddle vertex
};

struct RayLimits {
  double radius = std::numeric_limits<double>::infinity();
  /// Rays stop so many edges away from where they set out, measured in the longest edge on their way: near enough for
  /// what looks at a front from vertices behind it. Labels beyond are of longer ways.
  double edges = std::numeric_limits<double>::infinity();
};

/// Takes how far the rays have come, and to how many vertices.
using ReportRays = std::function<void(double distance, Index vertices)>;

/// Window propagation [chen1990], with the filters of [xin2009], of windows of any front, with saddle vertices sending
/// out windows of their own: every label is that of a shortest path. A vertex on the very border of a window is updated
/// by it (closed intervals), so that rays through the vertices of regular grids reach what lies behind them. Windows
/// come in the order of their distance, roughly (see exact_propagation.cpp): a vertex whose label falls after it sent
/// out windows sends out others. Holds scratch memory of O(V + F) to be reused; one a thread.
class WavefrontDistances {
 public:
  explicit WavefrontDistances(const Unfolding& unfolding);

  /// Forgets everything, for new sources. Distances of `places`, if any, are found as well: of those in sight of the
  /// source or of a saddle vertex, when another face lies between.
  void begin(const WatchedPlaces* places = nullptr);
  /// A vertex that the front reaches at once. `back` is the surface angle, at the vertex, of the way back.
  void offer(Index vertex, const RayLabel& label, double back);
  /// A vertex of the source itself, whose rays the caller sends out; the first label stays.
  void add_source(Index vertex, const RayLabel& label);
  /// Rays whose roots are in the face before the window.
  void add_window(const RayWindow& window);
  /// Returns what ends rays, to be filled after `begin` and before anything else; none at first.
  RayBarriers& barriers() { return barriers_; }
  /// \throw Cancelled.
  void run(const RayLimits& limits, const JobStage& stage, const ReportRays& report = {});

  /// Vertices with their final labels, in any order; those that were reached within the limits.
  const std::vector<Index>& settled() const { return settled_; }
  const RayLabel& label(Index vertex) const { return vertices_[vertex].label; }
  /// Of any vertex: infinity where no ray came.
  double distance(Index vertex) const { return distances_[vertex]; }
  PlaceDistances& places() { return places_; }
  const PlaceDistances& places() const { return places_; }

  /// A vertex round which rays may go, or any other one.
  struct Tip {
    double tangent = std::numeric_limits<double>::infinity();  ///< see tips.h
    double sine = 0, reach = 0;  ///< of the total angle; no place nearer is beyond its faces
  };

 private:
  struct VertexState {
    RayLabel label;
    Vec2 ray = Vec2::Zero();  ///< in the frame of `halfedge`, where it came by a window; else x is the angle back
    double bent_at;           ///< the distance with which it sent out windows
    Index halfedge;           ///< k_none: `ray` holds the angle
    bool is_source;
  };
  struct Occupant {  // the best window that covered the angle opposite a half-edge: "one angle, one split"
    double distance, split;
    std::uint32_t epoch;
  };
  /// A child's side of its parent's face, in coordinates that start at the base vertex they share, with the parent's
  /// half-edge on the x axis.
  struct Side {
    bool left;
    Index edge;              ///< half-edge of the parent's face
    double at_near, at_far;  ///< distances of the base vertices, the shared one first
    double at_apex;
  };

  VertexState& state(Index vertex);
  bool improves(Index vertex, double distance, bool shadowed) const;
  void improve(Index vertex, const RayLabel& label, const Vec2& ray, Index halfedge);
  void push(const RayWindow& window);
  void drain(BlockQueue<RayWindow>::Block* block, const JobStage& stage);
  bool cover_again(const JobStage& stage);
  void bend(Index vertex);
  double angle_back(Index vertex) const;
  void emit_from(Index vertex, double begin, double end);
  template <class Front>
  bool circles_tip(const RayWindow& window) const;
  void reach_before_barriers(const RayWindow& window);
  template <class Front>
  void propagate(const RayWindow& window);
  template <class Front>
  void reach_apex(const RayWindow& window, const Vec2& ray, double split, double reach);
  template <class Front>
  void add_child(const RayWindow& parent, const Side& side, double begin, double end, bool to_apex);
  template <class Front>
  RayWindow seen_from_side(const RayWindow& parent, RayWindow child, const Side& side) const;
  template <class Front>
  void reach_places(const RayWindow& window);
  bool is_too_far(const RayWindow& window, double key);
  double longest_to_apex(Index halfedge);

  const Unfolding& unfolding_;
  const Mesh& mesh_;
  std::vector<double> distances_;  ///< of the vertices' labels, once more: filters need little else
  std::vector<VertexState> vertices_;
  std::vector<Occupant> occupants_;
  std::vector<Tip> tips_;  ///< by vertex; empty where there is none
  RayBarriers barriers_;
  BlockQueue<RayWindow> queue_;  ///< a window on half-edge ~v stands for vertex v, its distance being the offset
  std::vector<Index> due_;       ///< vertices of the current bucket
  std::vector<Index> reached_, settled_;
  PlaceDistances places_;
  RayLimits limits_;
  std::vector<double> longest_;  ///< by vertex, with a limit in edges: the longest one on the way to it; 0: not known
  std::vector<Index> with_longest_;
  bool is_cut_ = false;  ///< there are places, and barriers
  std::uint32_t epoch_ = 0;
};

/// The window that a vertex throws on the edge opposite the corner at half-edge h, of which h's vertex is the point of
/// departure: directions `begin` to `end`, measured from h, 0 to the corner's angle. \return false when there is
/// nothing behind that edge.
bool window_of_corner(const Unfolding& unfolding, Index h, double begin, double end, RayWindow& window);

}  // namespace saddleback
