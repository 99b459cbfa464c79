#pragma once
// Windows in the order of their distance, roughly: buckets of equal width on a ring.

#include <cstdint>
#include <memory>
#include <vector>

#include "saddleback/types.h"

namespace saddleback {

/// Part [b0, b1] of a half-edge, about to enter its face, lit from the image of a root at (sx, sy), sy <= 0, in the
/// frame of the half-edge (see EdgeFrame). In the queue a window on half-edge ~v stands for vertex v itself.
struct Window {
  double sx, sy, b0, b1;
  double sigma;  ///< distance of the root
  Index halfedge;
  Index root;  ///< the vertex that the light comes from, or vertex_count + i for source i inside a face or edge
};

/// Windows lie in blocks: a bucket needs no memory of its own and gives back what it used.
struct WindowBlock {
  static constexpr Index k_capacity = 84;  // about a page
  WindowBlock* next;
  Index size;
  Window windows[k_capacity];
};

/// Buckets on a ring. A key beyond the ring goes into its last bucket: the order is for speed alone.
class WindowQueue {
 public:
  explicit WindowQueue(double bucket_width) : width_(bucket_width), per_width_(1 / bucket_width), ring_(k_buckets) {}

  void push(const Window& window, double key) {
    const double ahead = key * per_width_ - static_cast<double>(current_);
    constexpr double k_last = k_buckets - 1;
    const std::int64_t steps = ahead > 0 ? static_cast<std::int64_t>(ahead < k_last ? ahead : k_last) : 0;
    WindowBlock*& head = bucket(current_ + steps);
    if (!head || head->size == WindowBlock::k_capacity) head = fresh(head);
    head->windows[head->size++] = window;
  }

  /// The current bucket's windows, detached from the queue; null when it is empty.
  WindowBlock* take() {
    WindowBlock* const taken = bucket(current_);
    bucket(current_) = nullptr;
    return taken;
  }

  void give_back(WindowBlock* block) {
    block->next = free_;
    free_ = block;
    --in_use_;
  }
  /// A taken block that its taker keeps for as long as the queue lives.
  void keep(WindowBlock*) { --in_use_; }

  /// Goes on to the next bucket that holds something; false when nothing is left.
  bool advance() {
    if (in_use_ == 0) return false;
    while (!bucket(current_)) ++current_;
    return true;
  }

  /// No window taken from now on is nearer, but for those whose place in the order rounding or the ring changed.
  double reached() const { return static_cast<double>(current_) * width_; }

 private:
  static constexpr std::int64_t k_buckets = 1024;

  WindowBlock*& bucket(std::int64_t number) { return ring_[static_cast<std::size_t>(number & (k_buckets - 1))]; }

  WindowBlock* fresh(WindowBlock* next) {
    if (!free_) {
      pool_.push_back(std::make_unique_for_overwrite<WindowBlock>());
      free_ = pool_.back().get();
      free_->next = nullptr;
    }
    WindowBlock* const block = free_;
    free_ = block->next;
    block->next = next;
    block->size = 0;
    ++in_use_;
    return block;
  }

  double width_, per_width_;
  std::int64_t current_ = 0, in_use_ = 0;
  std::vector<WindowBlock*> ring_;
  std::vector<std::unique_ptr<WindowBlock>> pool_;
  WindowBlock* free_ = nullptr;
};

}  // namespace saddleback
