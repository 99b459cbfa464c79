#pragma once
// How the time of a propagation of exact distances is spread.

#include <array>
#include <cstdint>
#include <vector>

#include "saddleback/job.h"

#include "geodesics/exact_surface.h"

namespace saddleback {

/// Of the time of a propagation that is watched, what passes before it runs: its surface is laid out.
double share_of_surface(const Mesh& mesh, const SurfacePoints& sources, double limit);

/// How much of a propagation is done: the time goes into windows, and how many there will be is foretold.
///
/// A window is split at every vertex that it passes, so that light spreads out from the source as a flow that grows by
/// one at each vertex and is handed on to the vertices farther out. What becomes of it depends on the surface: on a
/// sphere all of it comes together behind, elsewhere it runs over borders, or ends where other light came first. So it
/// is foretold in several ways at once, and the more the windows counted so far agree with one, the more it counts.
class ExactProgress {
 public:
  /// The forecast is a part of the stage. \throw Cancelled. O(V log V).
  ExactProgress(const ExactSurface& surface, const SurfacePoints& sources, double limit, const JobStage& stage);

  /// A vertex of the surface is reached for the first time, at about that distance.
  void reach(Index vertex, double distance);
  /// Windows up to that distance are done, so many in all. \throw Cancelled.
  void update(double distance, std::int64_t window_count);

 private:
  static constexpr int k_ways = 4;  ///< that flows are foretold
  using Flows = std::array<float, k_ways>;
  using Sums = std::array<double, k_ways>;
  /// Windows done, and what of the flows was done then.
  struct Count {
    double windows;
    Sums flows;
  };

  void spread_flows(const ExactSurface& surface, const SurfacePoints& sources, double limit, const JobStage& stage);
  std::size_t ring_of(double distance) const;
  void remember(double windows);
  double share() const;

  JobStage running_;
  double per_ring_ = 0;
  std::vector<Flows> flows_;   ///< of the surface's vertices
  std::vector<Sums> pending_;  ///< half of the flow of vertices ahead, by rings about the sources
  std::size_t ring_ = 0;       ///< the first one pending
  Sums done_{}, totals_{}, beliefs_{};
  std::vector<Count> counts_;
};

}  // namespace saddleback
