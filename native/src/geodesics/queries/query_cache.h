#pragma once
// The memory that queries of one graph keep for the next query.

#include <atomic>
#include <memory>
#include <mutex>

#include "geodesics/queries/graph_search.h"
#include "geodesics/queries/graph_search_cuda.h"
#include "geodesics/queries/landmarks.h"
#include "geodesics/queries/point_arcs.h"
#include "geodesics/queries/point_search.h"
#include "geodesics/queries/source_arcs.h"
#include "support/memory/scratch_pool.h"

namespace saddleback {

/// Safe to use from any number of threads.
class QueryCache {
 public:
  ScratchPool<GraphSearch> field_searches;
  ScratchPool<PointSearch> point_searches;
  ScratchPool<DirectFanFinder> fan_finders;
  ScratchPool<CurveFanFinder> curve_fan_finders;
  DeviceGraphs device_graphs;

  /// Returns the landmarks, found in the first call, for which others wait. \throw Cancelled.
  const Landmarks& landmarks(const SaddleVertexGraph& graph, const JobStage& stage);
  /// Returns the same for what fans of points are found with.
  const FanMesh& fan_mesh(const SaddleVertexGraph& graph, int threads, const JobStage& stage);
  /// Returns the unfolding of the graph's mesh, laid in the first call.
  const Unfolding& unfolding(const Mesh& mesh) {
    std::call_once(unfolding_once_, [&] { unfolding_ = std::make_unique<Unfolding>(mesh, 0, JobStage()); });
    return *unfolding_;
  }
  bool has_fan_mesh() const { return has_fan_mesh_; }

 private:
  std::timed_mutex landmarks_mutex_, fan_mesh_mutex_;
  std::unique_ptr<Landmarks> landmarks_;
  std::unique_ptr<FanMesh> fan_mesh_;
  std::once_flag unfolding_once_;
  std::unique_ptr<Unfolding> unfolding_;
  std::atomic<bool> has_fan_mesh_{false};
};

}  // namespace saddleback
