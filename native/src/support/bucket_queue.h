#pragma once
// A queue for shortest paths that sorts by buckets of equal width.

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "saddleback/types.h"

namespace saddleback {

/// A ring of buckets, first in first out inside each: nearly in order, with no comparison. The ring is long enough for
/// the span between the least key and the largest that may be pushed beside it. An entry is eight bytes; buckets are
/// lists of chunks from one pool, so that nothing is allocated once the pool has grown. Keys are counted in widths: the
/// queue works alike at any scale.
class BucketQueue {
 public:
  struct Entry {
    Index node;
    float key;  ///< in widths, rounded: tells whether the node's key has fallen since
  };

  /// Empties the queue. Keys must not be below `least` nor, once entries are popped, farther than `span` above the
  /// last; should they be, they are popped too early or with the last.
  void reset(double width, double span, double least = 0);

  void push(Index node, double key) {
    const double place = key * inverse_width_;
    // Rounding must not put an entry behind the bucket being emptied, nor round the ring.
    push_into(std::clamp(static_cast<std::int64_t>(place), current_, current_ + mask_), node, place);
  }

  /// Works as push, for a node whose key was `before` (negative: none) and has fallen: an entry that waits in the right
  /// bucket will do, so that is_due must tell what to expand. Only for keys that keep what `reset` asks.
  void lower(Index node, double key, double before) {
    const double place = key * inverse_width_;
    const auto bucket = static_cast<std::int64_t>(place);
    if (bucket > current_ && bucket == bucket_of(before)) return;
    push_into(bucket, node, place);
  }

  bool pop(Entry& entry) {
    while (!front_ || next_ == front_->count) {
      if (front_ && front_->next) {
        drop_front();
      } else if (size_ == 0) {
        return false;
      } else {
        if (front_) leave_bucket();
        front_ = buckets_[static_cast<std::size_t>(current_ & mask_)].first;
        if (!front_) ++current_;
      }
    }
    entry = front_->entries[next_++];
    --size_;
    return true;
  }

  /// Tells whether the entry was pushed with this key, up to rounding: if not, the node was pushed again with a lesser
  /// one.
  bool is_current(const Entry& entry, double key) const {
    return static_cast<float>(key * inverse_width_) == entry.key;
  }

  /// Tells whether the entry's node, now with this key, belongs into the bucket being emptied: else its key has fallen
  /// since and it was expanded before.
  bool is_due(const Entry&, double key) const { return bucket_of(key) == current_; }

  /// The entry to be popped after `count` more, null when it is not at hand.
  const Entry* ahead(int count) const {
    return front_ && next_ + count < front_->count ? &front_->entries[next_ + count] : nullptr;
  }

  /// No key in the queue is less, up to rounding.
  double least_key() const { return static_cast<double>(current_) / inverse_width_; }

 private:
  static constexpr int k_chunk = 62;
  static constexpr int k_chunks_a_slab = 64;
  struct Chunk {
    Chunk* next;
    int count;
    Entry entries[k_chunk];
  };
  struct Bucket {
    Chunk *first, *last;
  };

  std::int64_t bucket_of(double key) const { return static_cast<std::int64_t>(key * inverse_width_); }
  void push_into(std::int64_t bucket, Index node, double place) {
    Chunk*& last = buckets_[static_cast<std::size_t>(bucket & mask_)].last;
    if (!last || last->count == k_chunk) last = append(buckets_[static_cast<std::size_t>(bucket & mask_)]);
    last->entries[last->count++] = {node, static_cast<float>(place)};
    ++size_;
  }
  Chunk* append(Bucket& bucket);
  void drop_front();
  void leave_bucket();

  double inverse_width_ = 1;
  std::int64_t current_ = 0, mask_ = 0;
  std::size_t size_ = 0;
  Chunk* front_ = nullptr;  ///< first chunk of the current bucket once it is being emptied
  int next_ = 0;            ///< entry of `front_`
  std::vector<Bucket> buckets_;
  std::vector<std::unique_ptr<Chunk[]>> slabs_;
  Chunk* free_ = nullptr;
};

}  // namespace saddleback
