#pragma once
// The local geodesic near a chain of straight pieces.

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "geodesics/unfolding/face_strip.h"

namespace saddleback {

/// A chain of straight pieces that meet at vertices: leg i runs from ends[i] to ends[i + 1].
struct LegChain {
  std::vector<LegEnd> ends;
  std::vector<UnfoldedArc> legs;  ///< only the first leg_count are in use: the rest keeps its memory
  std::size_t leg_count = 0;

  void clear();
  UnfoldedArc& add_leg();
  double length() const;
};

/// The vertex that a leg runs through where it crosses a half-edge, if it is the tip of a cone: straight on one side,
/// the leg is bent on the other. Else k_none.
Index cone_met(const Mesh& mesh, Index entered, double crossing);

/// Moves a chain to the other side of vertices that it passes with less than pi on one side, until there are none: each
/// time the faces about the vertex on that side join the faces before and after it to one strip, whose shortest path
/// replaces the two pieces, about the sharpest bends first (as the edge flips of [sharp2020], but without a mesh to
/// flip). Never longer; ends because every step is shorter. Never leaves the homotopy class.
class PathShortener {
 public:
  explicit PathShortener(const Unfolding& unfolding)
      : unfolding_(unfolding), mesh_(unfolding.mesh()), funnel_(unfolding) {}
  /// `check` is called before every step: it throws to stop.
  template <class Check>
  void shorten(LegChain& chain, Check&& check);
  void shorten(LegChain& chain) {
    shorten(chain, [] {});
  }
  /// Makes the chain the shortest path along a strip, which is known by the half-edges entered.
  void lay_along(const LegEnd& begin, const LegEnd& end, std::span<const Index> entered, LegChain& chain);

 private:
  friend class LoopShortener;
  // Of a path at a vertex, in radians below pi, as powers of two; the least one is straight but for rounding. Sharp
  // bends first are fewer steps than bends in their order: half the time on scans.
  static constexpr int k_sharpest = 1, k_straightest = -33;
  static constexpr double k_least_bend = 0x1p-33;
  enum class Side { none, left, right };
  /// Two pieces and what they join.
  struct Joint {
    const LegEnd &before, &at, &after;
    const UnfoldedArc &in, &out;
  };
  static Joint joint(const LegChain& chain, std::size_t i) {
    return {chain.ends[i - 1], chain.ends[i], chain.ends[i + 1], chain.legs[i - 1], chain.legs[i]};
  }
  /// Goes to the other side of vertex i where the path is bent by more than that. \return false where that is no
  /// shorter.
  bool step(LegChain& chain, std::size_t i, double bend);
  Side bent_side(const Joint& joint, double bend = k_least_bend) const;
  bool join(const Joint& joint, Side side);
  bool go_round(const Joint& joint, Side side);
  void append(Index entered);
  void trim(const LegEnd& begin, const LegEnd& end);
  void lay_out_turns(const LegEnd& begin, const LegEnd& end);
  void replace(LegChain& chain, std::size_t i);
  bool split_at_cone(LegChain& chain);
  // Every step shortens the path; a cap for the case that rounding thinks so for ever. A path of few legs may pass over
  // most vertices of the surface, each more than once where it winds.
  static constexpr std::size_t k_steps_per_vertex = 200;

  const Unfolding& unfolding_;
  const Mesh& mesh_;
  Funnel funnel_;
  std::vector<Index> strip_;
  LegChain found_;
};

template <class Check>
void PathShortener::shorten(LegChain& chain, Check&& check) {
  std::size_t steps = k_steps_per_vertex * (chain.leg_count + static_cast<std::size_t>(mesh_.vertex_count()));
  do {
    for (int power = k_sharpest; power >= k_straightest; --power) {
      const double bend = std::ldexp(1.0, power);
      for (std::size_t i = 1; i < chain.leg_count && steps > 0;) {
        check();
        if (!step(chain, i, bend)) {
          ++i;
          continue;
        }
        --steps;
        i = std::max<std::size_t>(i - 1, 1);  // the vertex before it is left in a new direction
      }
    }
  } while (steps > 0 && split_at_cone(chain));
}

}  // namespace saddleback
