#include "geodesics/query_cache.h"

#include <chrono>

namespace saddleback {

const Landmarks& QueryCache::landmarks(const SaddleVertexGraph& graph, const JobStage& stage) {
  using namespace std::chrono_literals;
  while (!landmarks_mutex_.try_lock_for(20ms)) stage.check();  // who waits may be cancelled, too
  const std::lock_guard lock(landmarks_mutex_, std::adopt_lock);
  if (!landmarks_) {
    const auto search = field_searches.lease();
    landmarks_ = std::make_unique<Landmarks>(graph, *search, stage);
  }
  return *landmarks_;
}

std::shared_ptr<QueryCache> make_query_cache() { return std::make_shared<QueryCache>(); }

}  // namespace saddleback
