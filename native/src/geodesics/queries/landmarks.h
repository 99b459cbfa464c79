#pragma once
// Lower bounds of distances in the graph, from distances to a few vertices far apart.

#include <array>
#include <span>
#include <vector>

#include "geodesics/queries/graph_search.h"
#include "geodesics/queries/source_arcs.h"

namespace saddleback {

/// The triangle inequality about landmarks: d(v, t) >= |d(L, v) - d(L, t)| [goldberg2005]. Each component has its own,
/// chosen one after the other as far as can be from those before. 64 bytes a vertex.
class Landmarks {
 public:
  static constexpr int k_count = 16;

  /// A field for each landmark; components share them. \throw Cancelled.
  Landmarks(const SaddleVertexGraph& graph, GraphSearch& search, const JobStage& stage);

  /// Holds what bounds need of a target.
  struct Target {
    alignas(64) std::array<float, k_count> least, most;  ///< of the landmarks' distances to the target, in units
    Vec3 position;
  };
  Target target(const PointFan& fan, const Vec3& position) const;

  /// Returns at most the distance in the graph from the node to the target, whatever was rounded.
  double bound(Index node, const Target& target) const {
    const float* const own = table_.data() + static_cast<std::size_t>(node) * k_count;
    float most = 0;
    for (int i = 0; i < k_count; ++i) {
      const float above = own[i] - target.most[i], below = target.least[i] - own[i];
      const float better = above > below ? above : below;
      most = better > most ? better : most;
    }
    return static_cast<double>(most - slack_) * unit_;
  }
  /// A bound may be less than one without rounding by this much.
  double slack() const { return 2 * static_cast<double>(slack_) * unit_; }

 private:
  const SaddleVertexGraph* graph_;
  double unit_;      ///< mean edges, so that floats do at any scale
  float slack_ = 0;  ///< units: more than the rounding of all that a bound is made of
  std::vector<float> table_;
};

}  // namespace saddleback
