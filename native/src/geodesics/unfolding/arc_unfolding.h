#pragma once
// The faces that an arc of the graph runs over.

#include <vector>

#include "saddleback/mesh/surface_points.h"

#include "geodesics/unfolding/unfolding.h"

namespace saddleback {

/// Holds what a graph keeps of an arc: enough to find the geodesic again.
struct ArcHint {
  Index from, to;                 ///< vertices
  double length;                  ///< up to rounding
  double begin_angle, end_angle;  ///< surface angles at `from` between which the arc leaves
  /// Relative: how near its length an arc must be. Two geodesics to one vertex inside one window usually differ by
  /// more.
  double tolerance = 1e-7;
  /// Says whether rounding may be far more than usual: beside edges that are millions of times longer, or where an arc
  /// passes a vertex on its other side, by less than the single precision in which it was found.
  bool is_rough = false;
};

/// A straight geodesic from a vertex to a vertex or point.
struct UnfoldedArc {
  double length = 0;
  double start_angle = 0;         ///< at the first vertex, surface angle from first_halfedge
  double end_angle = 0;           ///< direction back, at the last vertex; unused where the last is a point
  std::vector<Index> entered;     ///< half-edges crossed, each of the face that is entered; empty along a mesh edge
  std::vector<double> crossings;  ///< where, as a fraction of the half-edge from its start
};

/// Follows the window between the hint's angles, splitting it at every vertex inside, until it meets the vertex wanted
/// at the length wanted. Exact to rounding: distances are measured from the source in one plane. Holds its scratch
/// memory; one a thread.
class ArcUnfolder {
 public:
  /// Unfolds; without angles those of the arcs are not set, where that saves time.
  explicit ArcUnfolder(const Unfolding& unfolding, bool with_angles = true)
      : unfolding_(unfolding), mesh_(unfolding.mesh()), with_angles_(with_angles) {}
  /// \return false when no such geodesic exists (the hint belongs to another mesh). O(faces crossed).
  bool unfold(const ArcHint& hint, UnfoldedArc& arc) { return unfold(hint, nullptr, arc); }
  /// Does the same to a point that is no vertex; hint.to is not looked at.
  bool unfold(const ArcHint& hint, const SurfacePoint& target, UnfoldedArc& arc) { return unfold(hint, &target, arc); }

 private:
  /// Half-edge about to be entered, its ends in the plane of the source at the origin, and the part of it in sight.
  struct Window {
    Index entered;
    Index depth;
    Vec2 from, to;
    Vec2 right, left;  ///< unit vectors; left is counter-clockwise of right
  };
  struct Crossed {
    Index entered;
    Vec2 from, to;  ///< its ends, as above
  };
  bool unfold(const ArcHint& hint, const SurfacePoint* target, UnfoldedArc& arc);
  bool unfold_within(double border, const ArcHint& hint, UnfoldedArc& arc);
  bool along_an_edge(const ArcHint& hint, UnfoldedArc& arc) const;
  bool inside_first_face(const ArcHint& hint, Index halfedge, UnfoldedArc& arc) const;
  /// Returns where the target lies when it lies in the face of `window`, whose third corner is at `apex`.
  bool find_target(const ArcHint& hint, const Window& window, const Vec2& apex, Vec2& place) const;
  bool start(const ArcHint& hint, Index halfedge, UnfoldedArc& arc);
  bool search(const ArcHint& hint, double base_angle, UnfoldedArc& arc);
  void push(Index edge, Index depth, const Vec2& from, const Vec2& to, const Vec2& right, const Vec2& left);
  bool was_followed(const Window& window, double farthest);
  bool finish(const Window& last, const Vec2& target, double base_angle, UnfoldedArc& arc);

  const Unfolding& unfolding_;
  const Mesh& mesh_;
  const bool with_angles_;
  const SurfacePoint* target_ = nullptr;  ///< null: the vertex hint.to
  double border_ = 0;                     ///< how far off a ray, relative, what lies on it may be
  std::vector<Window> stack_;
  std::vector<Crossed> trail_;
  std::vector<Crossed> rays_;  ///< where windows without width have been
};

}  // namespace saddleback
