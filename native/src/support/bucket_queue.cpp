#include "support/bucket_queue.h"

namespace saddleback {
namespace {

// A span of very many widths (arcs of wildly different lengths) gets wider buckets instead of more memory.
constexpr double k_most_buckets = 1 << 16;

}  // namespace

void BucketQueue::reset(double width, double span, double least) {
  const double bucket_width = std::max(width, span / k_most_buckets);
  inverse_width_ = 1 / bucket_width;
  std::size_t count = 4;
  while (static_cast<double>(count) < span / bucket_width + 3) count *= 2;
  mask_ = static_cast<std::int64_t>(count) - 1;
  buckets_.assign(count, Bucket{nullptr, nullptr});
  current_ = static_cast<std::int64_t>(least * inverse_width_);
  size_ = 0;
  front_ = nullptr;
  next_ = 0;
  free_ = nullptr;  // a search may have been left half way: all chunks are free again
  for (const auto& slab : slabs_) {
    for (int i = 0; i < k_chunks_a_slab; ++i) {
      slab[i].next = free_;
      free_ = &slab[i];
    }
  }
}

BucketQueue::Chunk* BucketQueue::append(Bucket& bucket) {
  if (!free_) {
    slabs_.push_back(std::make_unique<Chunk[]>(k_chunks_a_slab));
    for (int i = 0; i < k_chunks_a_slab; ++i) {
      slabs_.back()[i].next = free_;
      free_ = &slabs_.back()[i];
    }
  }
  Chunk* const chunk = free_;
  free_ = chunk->next;
  chunk->next = nullptr;
  chunk->count = 0;
  if (bucket.first) {
    bucket.last->next = chunk;
  } else {
    bucket.first = chunk;
  }
  return chunk;
}

void BucketQueue::drop_front() {
  Chunk* const done = front_;
  front_ = done->next;
  next_ = 0;
  buckets_[static_cast<std::size_t>(current_ & mask_)].first = front_;
  done->next = free_;
  free_ = done;
}

/// All that the current bucket holds is its last chunk, which is done.
void BucketQueue::leave_bucket() {
  front_->next = free_;
  free_ = front_;
  buckets_[static_cast<std::size_t>(current_ & mask_)] = {nullptr, nullptr};
  front_ = nullptr;
  next_ = 0;
  ++current_;
}

}  // namespace saddleback
