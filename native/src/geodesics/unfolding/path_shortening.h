#pragma once
// The local geodesic near a chain of straight pieces.

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

/// Moves a chain to the other side of vertices that it passes with less than pi on one side, until there are none: each
/// time the faces about the vertex on that side join the faces before and after it to one strip, whose shortest path
/// replaces the two pieces (as the edge flips of [sharp2020], but without a mesh to flip). Never longer; ends because
/// every step is shorter.
class PathShortener {
 public:
  explicit PathShortener(const Unfolding& unfolding)
      : unfolding_(unfolding), mesh_(unfolding.mesh()), funnel_(unfolding) {}
  void shorten(LegChain& chain);

 private:
  enum class Side { none, left, right };
  Side bent_side(const LegChain& chain, std::size_t i) const;
  bool join(const LegChain& chain, std::size_t i, Side side);
  bool go_round(const LegChain& chain, std::size_t i, Side side);
  void append(Index entered);
  void trim(const LegEnd& begin, const LegEnd& end);
  void lay_out_turns(const LegChain& chain, std::size_t i);
  void replace(LegChain& chain, std::size_t i);

  const Unfolding& unfolding_;
  const Mesh& mesh_;
  Funnel funnel_;
  std::vector<Index> strip_;
  LegChain found_;
};

}  // namespace saddleback
