#pragma once
// How many windows a propagation of exact distances will have, foretold from a sample of rays.

#include <algorithm>
#include <vector>

#include "saddleback/job.h"

#include "geodesics/exact/guessed_arrivals.h"

namespace saddleback {

/// A window ends at rays that go on beyond the vertices which split it, until another path came sooner or the surface
/// ends. So the edges that these rays cross tell how many windows there will be, and how far out; a few thousand
/// vertices from all over the surface stand for all.
class WindowForecast {
 public:
  struct Extent {
    double limit;       ///< where the propagation ends
    double ring_width;  ///< windows are counted in rings about the sources
    double vertices;    ///< that are reached, about
    /// What a vertex that is reached counts as, and how much more where paths bend.
    double windows_at_vertex, windows_at_bend;
  };
  WindowForecast() = default;
  /// \throw Cancelled. O(V).
  WindowForecast(const ExactSurface& surface, const SurfacePoints& sources, const Extent& extent,
                 const JobStage& stage);

  /// Windows of rings up to and without this one, about; a vertex that is reached counts as some.
  double before(std::size_t ring) const { return counts_[std::min(ring, counts_.size() - 1)]; }
  double total() const { return counts_.back(); }

 private:
  std::vector<double> counts_{0.0};  ///< never empty
};

}  // namespace saddleback
