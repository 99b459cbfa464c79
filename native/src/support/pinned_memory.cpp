#include "saddleback/pinned_memory.h"

#include <algorithm>
#include <mutex>
#include <vector>

#include "saddleback/cuda_twins.h"

namespace saddleback {
namespace {

class PinnedMemory final : public LargeMemory {
 public:
  void* allocate(std::size_t size) override {
    const std::lock_guard lock(mutex_);
    if (void* const kept = take(size)) return kept;
    blocks_.reserve(blocks_.size() + 1);  // nothing may fail once there is memory
    const std::size_t wanted = (size + k_step - 1) / k_step * k_step;
    void* memory = pin(wanted);
    if (!memory && free_ > 0) {
      drop_free_blocks();
      memory = pin(wanted);
    }
    if (!memory) return allocate_large(size);
    blocks_.push_back({memory, wanted, false});
    return memory;
  }

  void free(void* memory, std::size_t size) noexcept override {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(blocks_, memory, &Block::memory);
    if (found == blocks_.end()) return free_large(memory, size);
    if (free_ + found->size <= k_most_free) {
      found->is_free = true;
      free_ += found->size;
    } else {
      unpin(found->memory);
      blocks_.erase(found);
    }
  }

  void release() {
    const std::lock_guard lock(mutex_);
    drop_free_blocks();
  }

 private:
  struct Block {
    void* memory;
    std::size_t size;
    bool is_free;
  };
  static constexpr std::size_t k_step = std::size_t{1} << 16, k_most_free = std::size_t{1} << 31;

  static void* pin(std::size_t size) {
    const CudaTwins* const twins = cuda_twins();
    return twins ? twins->pin(size) : nullptr;
  }
  static void unpin(void* memory) noexcept { cuda_twins()->unpin(memory); }  // who pinned it is there to the end

  void* take(std::size_t size) {
    const auto wastes_little = [&](const Block& block) {
      return block.is_free && block.size >= size && block.size - size <= std::max(k_step, block.size / 5);
    };
    Block* best = nullptr;
    for (Block& block : blocks_)
      if (wastes_little(block) && (!best || block.size < best->size)) best = &block;
    if (!best) return nullptr;
    best->is_free = false;
    free_ -= best->size;
    return best->memory;
  }

  void drop_free_blocks() {
    for (const Block& block : blocks_)
      if (block.is_free) unpin(block.memory);
    std::erase_if(blocks_, [](const Block& block) { return block.is_free; });
    free_ = 0;
  }

  std::mutex mutex_;
  std::vector<Block> blocks_;
  std::size_t free_ = 0;  ///< bytes of the free ones
};

// Never destroyed: arrays may outlive everything else.
PinnedMemory& all() {
  static auto* const memory = new PinnedMemory;
  return *memory;
}

}  // namespace

LargeMemory& pinned_memory() { return all(); }
void release_pinned_memory() { all().release(); }

}  // namespace saddleback
