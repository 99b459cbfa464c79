#pragma once
// Strips of faces laid out flat, and the shortest path along one.

#include <span>
#include <vector>

#include "geodesics/unfolding/arc_unfolding.h"

namespace saddleback {

/// Holds where a leg begins or ends: a vertex or, at the ends of a path, any point.
struct LegEnd {
  Index vertex = k_none;
  SurfacePoint point;  ///< of a vertex any of its faces
  bool is_vertex() const { return vertex != k_none; }
};

LegEnd leg_end(const Mesh& mesh, const SurfacePoint& point);
LegEnd leg_end(const Mesh& mesh, Index vertex);

/// The half-edge that leaves a vertex in a face; k_none where the face does not have it.
Index leaving(const Mesh& mesh, Index vertex, Index face);

/// The straight way through a strip of faces, which are known by the half-edges `entered` between them; the line is
/// known to stay inside but for rounding. Without any, both ends lie in one face or on one edge.
void lay_out(const Unfolding& unfolding, const LegEnd& begin, const LegEnd& end, std::span<const Index> entered,
             UnfoldedArc& leg);

/// The leg from its end to its begin; what is unknown about its ends stays so.
void reverse(const Mesh& mesh, UnfoldedArc& leg);

/// A vertex at which the shortest path along a strip turns: half-edges [first, last) of the strip meet there.
struct StripTurn {
  Index vertex;
  std::size_t first, last;
};

/// Holds where the shortest path along a strip turns, in order: the funnel algorithm [lee1984]. Holds scratch memory.
class Funnel {
 public:
  explicit Funnel(const Unfolding& unfolding) : unfolding_(unfolding) {}
  std::span<const StripTurn> turns(const LegEnd& begin, const LegEnd& end, std::span<const Index> entered);

 private:
  const Unfolding& unfolding_;
  std::vector<Vec2> left_, right_;
  std::vector<StripTurn> turns_;
};

}  // namespace saddleback
