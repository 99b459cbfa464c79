#pragma once
// What queries of one graph keep for the next query.

#include <memory>
#include <mutex>
#include <vector>

#include "geodesics/graph_search.h"

namespace saddleback {

/// Searches that are not at work: their memory is reused. Safe to use from any number of threads.
class QueryCache {
 public:
  /// A search that goes back to the cache when it is done with.
  class Lease {
   public:
    Lease(QueryCache& cache, std::unique_ptr<GraphSearch> search) : cache_(&cache), search_(std::move(search)) {}
    Lease(Lease&&) noexcept = default;
    ~Lease() {
      if (search_) cache_->give_back(std::move(search_));
    }
    GraphSearch* operator->() const { return search_.get(); }
    GraphSearch& operator*() const { return *search_; }

   private:
    QueryCache* cache_;
    std::unique_ptr<GraphSearch> search_;
  };

  Lease lease();

 private:
  void give_back(std::unique_ptr<GraphSearch> search);
  std::mutex mutex_;
  std::vector<std::unique_ptr<GraphSearch>> idle_;
};

}  // namespace saddleback
