#include "geodesics/query_cache.h"

namespace saddleback {
namespace {

// More threads than this at once are rare; what they used is freed again.
constexpr std::size_t k_most_idle = 64;

}  // namespace

QueryCache::Lease QueryCache::lease() {
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      std::unique_ptr<GraphSearch> search = std::move(idle_.back());
      idle_.pop_back();
      return {*this, std::move(search)};
    }
  }
  return {*this, std::make_unique<GraphSearch>()};
}

void QueryCache::give_back(std::unique_ptr<GraphSearch> search) {
  const std::lock_guard lock(mutex_);
  if (idle_.size() < k_most_idle) idle_.push_back(std::move(search));
}

std::shared_ptr<QueryCache> make_query_cache() { return std::make_shared<QueryCache>(); }

}  // namespace saddleback
