#pragma once
// A plane laid on the surface: flat coordinates of the vertices about a point or along a curve.

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "saddleback/mesh/surface_curve.h"
#include "saddleback/shape_mapping/surface_outline.h"
#include "saddleback/support/large_array.h"

namespace saddleback {

class CurveBend;
struct Sight;
struct UnfoldedTriangle;

/// Holds where the plane is laid and which part of it is wanted.
struct PlaneBox {
  Vec2 low, high;  ///< contains the origin
};

/// Flat coordinates of the vertices near a place, linear inside each face: so the plane is laid on the surface by a
/// continuous map that is straight in every face, and whose folding and stretch are known face by face. Lengths are
/// mesh units. About a point the coordinates are those of the exponential map (length and direction of the shortest way
/// from the center), along a curve Fermi's (arc length of the foot, signed distance): each vertex has them from an edge
/// that is nearer, through which it sees the source when the faces are unfolded [melvaer2012]; a vertex that sees it
/// through no edge (behind a saddle) is laid out beside its neighbors instead. Exact where the surface can be unrolled.
///
/// Made once for a mesh, which must outlive it, and used again and again in the same memory. One thread at a time.
class ShapeMap {
 public:
  explicit ShapeMap(const Mesh& mesh);
  ~ShapeMap();
  ShapeMap(ShapeMap&&) noexcept;
  ShapeMap& operator=(ShapeMap&&) noexcept;

  enum class State : std::uint8_t {
    waiting,  ///< for a better or nearer edge to be seen through, or not reached
    source,   ///< at or beside the center or curve
    settled,
    inside,  ///< settled, and marked by the watch
  };
  /// A half-edge out of a vertex, to where, and the third corner of its face.
  struct Spoke {
    Index halfedge, to, apex;
    State to_state, apex_state;
  };
  /// A function that is called with each vertex whose coordinates are found and those about it, the nearest first,
  /// until it returns false.
  using Watch = std::function<bool(Index vertex, std::span<const Spoke> about)>;

  /// The exponential map: the center at the origin, the x axis at `angle` in the FaceChart of center.face. At a vertex
  /// angles are scaled so that its total angle becomes 2 pi. Where the surface folds, the plane may be laid back and
  /// forth over the box without end: it goes no farther from the center than `reach`, measured straight through space.
  /// O(n log n) for the n vertices within the box.
  void about_point(const SurfacePoint& center, double angle, const PlaneBox& box,
                   double reach = std::numeric_limits<double>::infinity(), const Watch& watch = {});

  /// Lays the plane along a curve of the same mesh, whose point at arc length `origin` becomes the origin, the x axis
  /// along it. Where the curve is shorter than the box the plane is laid on straight beyond its ends. O(n log n +
  /// segments).
  void along_curve(const SurfaceCurve& curve, double origin, const PlaneBox& box);

  const Mesh& mesh() const { return *mesh_; }
  /// A face on which the origin lies.
  Index center_face() const { return center_face_; }

  bool has(Index vertex) const { return status_[vertex] >= stamp_; }
  /// Marks a vertex that is settled.
  void mark_inside(Index vertex) { set(vertex, State::inside); }
  /// Returns the coordinates of a vertex vertex that has some.
  const Vec2& coordinates(Index vertex) const { return nodes_[vertex].place; }
  /// All vertices that have coordinates, in no particular order.
  std::span<const Index> vertices() const { return reached_; }

  /// Lays out the corners of a face that have no coordinates yet beside those that have. At least two must have some.
  void complete(Index face);

  /// Walks from `face`, whose corners must be laid out, to the face that a point of the plane lies in, laying out what
  /// it comes to: O(faces on the way). Leaves `face` where it got stuck when the answer is a failure.
  MapFailure find(const Vec2& point, Index& face);

  /// Tells whether a point of the plane lies in a face whose corners are laid out.
  bool is_in(const Vec2& point, Index face) const;

  /// The surface point at a point of the plane that lies in the face; rounding outside of it is removed.
  SurfacePoint surface_point(const Vec2& point, Index face) const;

 private:
  static constexpr std::uint32_t k_states = 4;
  struct Node {
    Vec2 place;
    double key;   ///< in the queue: the distance from the source, if it is seen
    double miss;  ///< by how much the line of sight misses the edge
  };
  struct Entry {
    double key;
    Index vertex;
    bool operator<(const Entry& other) const { return key != other.key ? key > other.key : vertex > other.vertex; }
  };

  void begin();
  void seed_face(const SurfacePoint& center, double angle);
  void seed_star(const SurfacePoint& center, Index vertex, double angle);
  void seed_segment(const CurveSegment& segment, double start);
  Node& reach(Index vertex, State state);
  void put(Index vertex, const Vec2& place, double key, double miss, State state);
  void put_source(Index vertex, const Vec2& place) { put(vertex, place, distance_of(place), 0, State::source); }
  void march(const PlaneBox& box, const Watch& watch);
  State state_of(Index vertex) const {
    return static_cast<State>(has(vertex) ? status_[vertex] - stamp_ : static_cast<std::uint32_t>(State::waiting));
  }
  void set(Index vertex, State state) { status_[vertex] = stamp_ + static_cast<std::uint32_t>(state); }
  void find_spokes(Index vertex);
  void look_about(Index vertex, const PlaneBox& box);
  bool is_out_of_reach(Index from, Index to) const;
  void look_through(Index halfedge, Index from, Index to, Index apex);
  double distance_of(const Vec2& place) const { return along_curve_ ? std::abs(place.y()) : place.norm(); }

  Sight sight_through(const UnfoldedTriangle& triangle, const Vec2& from, const Vec2& to) const;

  const Mesh* mesh_;
  std::unique_ptr<CurveBend> bend_;  ///< of the curve
  LargeArray<Node> nodes_;
  LargeArray<std::uint32_t> status_;  ///< the stamp of the map that reached the vertex last, and the state by then
  std::vector<Index> reached_;
  std::vector<Entry> queue_;
  std::vector<Spoke> spokes_;  ///< of the vertex that was settled last
  std::uint32_t stamp_ = 0;    ///< a multiple of k_states
  Index center_face_ = 0;
  bool along_curve_ = false;
  Vec3 center_ = Vec3::Zero();
  double reach_ = std::numeric_limits<double>::infinity();
};

}  // namespace saddleback
