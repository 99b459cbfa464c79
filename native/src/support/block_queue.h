#pragma once
// Items in the order of their keys, roughly: buckets of equal width on a ring.

#include <cstdint>
#include <memory>
#include <vector>

#include "saddleback/types.h"

namespace saddleback {

/// Items lie in blocks: a bucket needs no memory of its own and gives back what it used.
template <class Item>
struct ItemBlock {
  static constexpr Index k_capacity = static_cast<Index>(4032 / sizeof(Item));  // about a page
  ItemBlock* next;
  Index size;
  Item items[k_capacity];
};

/// Buckets on a ring. A key beyond the ring goes into its last bucket: the order is for speed alone.
template <class Item>
class BlockQueue {
 public:
  using Block = ItemBlock<Item>;

  explicit BlockQueue(double bucket_width) : width_(bucket_width), per_width_(1 / bucket_width), ring_(k_buckets) {}

  void push(const Item& item, double key) {
    const double ahead = key * per_width_ - static_cast<double>(current_);
    constexpr double k_last = k_buckets - 1;
    const std::int64_t steps = ahead > 0 ? static_cast<std::int64_t>(ahead < k_last ? ahead : k_last) : 0;
    Block*& head = bucket(current_ + steps);
    if (!head || head->size == Block::k_capacity) head = fresh(head);
    head->items[head->size++] = item;
  }

  /// The current bucket's items, detached from the queue; null when it is empty.
  Block* take() {
    Block* const taken = bucket(current_);
    bucket(current_) = nullptr;
    return taken;
  }

  void give_back(Block* block) {
    block->next = free_;
    free_ = block;
    --in_use_;
  }
  /// A taken block that its taker keeps for as long as the queue lives.
  void keep(Block*) { --in_use_; }

  /// Goes on to the next bucket that holds something; false when nothing is left.
  bool advance() {
    if (in_use_ == 0) return false;
    while (!bucket(current_)) ++current_;
    return true;
  }

  /// Empties the queue, to begin again with keys from 0. No block may be kept.
  void clear() {
    for (Block*& head : ring_) {
      while (head) {
        Block* const next = head->next;
        give_back(head);
        head = next;
      }
    }
    if (in_use_ > 0) {  // who had taken some was stopped, and gave none back
      free_ = nullptr;
      in_use_ = static_cast<std::int64_t>(pool_.size());
      for (const auto& block : pool_) give_back(block.get());
    }
    current_ = 0;
  }

  double width() const { return width_; }                 ///< of a bucket
  std::int64_t blocks_in_use() const { return in_use_; }  ///< those taken and neither kept nor given back, too
  /// Returns a bound below which no item taken from now on has its key, except those whose place in the order rounding
  /// or the ring changed.
  double reached() const { return static_cast<double>(current_) * width_; }

 private:
  static constexpr std::int64_t k_buckets = 1024;

  Block*& bucket(std::int64_t number) { return ring_[static_cast<std::size_t>(number & (k_buckets - 1))]; }

  Block* fresh(Block* next) {
    if (!free_) {
      pool_.push_back(std::make_unique_for_overwrite<Block>());
      free_ = pool_.back().get();
      free_->next = nullptr;
    }
    Block* const block = free_;
    free_ = block->next;
    block->next = next;
    block->size = 0;
    ++in_use_;
    return block;
  }

  double width_, per_width_;
  std::int64_t current_ = 0, in_use_ = 0;
  std::vector<Block*> ring_;
  std::vector<std::unique_ptr<Block>> pool_;
  Block* free_ = nullptr;
};

}  // namespace saddleback
