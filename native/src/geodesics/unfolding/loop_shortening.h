#pragma once
// Closed local geodesics.

#include <span>
#include <vector>

#include "saddleback/job.h"

#include "geodesics/unfolding/path_shortening.h"

namespace saddleback {

/// Tightens closed curves within their homotopy class. A shortest closed curve in a closed strip of faces turns at a
/// vertex beside it or is straight: its length is a convex function of where it crosses one edge, whose least value
/// tells the vertex. From there it is a path from that vertex to itself, whose begin is moved on like any other bend.
class LoopShortener {
 public:
  LoopShortener(const Unfolding& unfolding, const JobStage& stage)
      : mesh_(unfolding.mesh()), shortener_(unfolding), stage_(stage) {}
  /// Says what became of a curve.
  enum class Result {
    tight,    ///< it is a local geodesic
    point,    ///< it contracted
    bent,     ///< it may be shorter
    slipped,  ///< it may be shorter in another strip
  };
  /// Makes the chain the local geodesic near a closed strip, which is known by the half-edges entered; it runs from an
  /// end to the same one. \return tight or point: then the chain means nothing. \throw Cancelled.
  Result shorten(std::span<const Index> entered, LegChain& loop);

 private:
  /// A vertex where a curve turns, and an edge of the strip that ends there.
  struct Turn {
    Index vertex = k_none;
    std::size_t edge = 0;
  };
  Result begin(std::vector<Index>& strip, LegChain& loop);
  Turn turn_of(std::span<const Index> strip);
  double length_from(std::span<const Index> strip, double share);
  bool is_straight(std::span<const Index> strip, double share) const;
  Turn cone_on(std::span<const Index> strip, double share) const;
  Turn nearest(std::span<const Index> strip, double share) const;
  /// Returns where trial_ crosses the i-th edge.
  double crossing(std::size_t i, double share) const { return i == 0 ? share : trial_.legs[0].crossings[i - 1]; }
  Result free_begin(LegChain& loop);
  void close(std::vector<Index>& strip) const;

  const Mesh& mesh_;
  PathShortener shortener_;
  const JobStage& stage_;
  LegChain trial_;
};

}  // namespace saddleback
