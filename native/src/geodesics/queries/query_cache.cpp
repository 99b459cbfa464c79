#include "geodesics/queries/query_cache.h"

#include <chrono>

namespace saddleback {

namespace {

/// Waits for the mutex, and may be cancelled, too.
std::unique_lock<std::timed_mutex> wait_for(std::timed_mutex& mutex, const JobStage& stage) {
  using namespace std::chrono_literals;
  while (!mutex.try_lock_for(20ms)) stage.check();
  return {mutex, std::adopt_lock};
}

}  // namespace

const Landmarks& QueryCache::landmarks(const SaddleVertexGraph& graph, const JobStage& stage) {
  const auto lock = wait_for(landmarks_mutex_, stage);
  if (!landmarks_) {
    const auto search = field_searches.lease();
    landmarks_ = std::make_unique<Landmarks>(graph, *search, stage);
  }
  return *landmarks_;
}

const FanMesh& QueryCache::fan_mesh(const SaddleVertexGraph& graph, int threads, const JobStage& stage) {
  const auto lock = wait_for(fan_mesh_mutex_, stage);
  if (!fan_mesh_)
    fan_mesh_ = std::make_unique<FanMesh>(graph.unfolding(), graph.nodes(), graph.vertices(), threads, stage);
  has_fan_mesh_ = true;
  return *fan_mesh_;
}

std::shared_ptr<QueryCache> make_query_cache() { return std::make_shared<QueryCache>(); }

}  // namespace saddleback
