#include "support/cuda/pinned_memory.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <vector>

#include "support/cuda/cuda_module.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

/// Touches all pages: to pin those that are not there yet takes longer, and nobody could stop it.
void lay_pages(std::byte* memory, std::size_t size, int threads, const JobStage& stage) {
  constexpr std::size_t k_piece = std::size_t{1} << 21, k_page = std::size_t{1} << 12;
  const auto pieces = static_cast<Index>((size + k_piece - 1) / k_piece);
  parallel_for(pieces, threads, 4, [&](Index piece, int) {
    stage.check();
    const std::size_t begin = static_cast<std::size_t>(piece) * k_piece, end = std::min(size, begin + k_piece);
    for (std::size_t at = begin; at < end; at += k_page) static_cast<volatile std::byte*>(memory)[at] = std::byte{};
  });
}

class PinnedMemory final : public LargeMemory {
 public:
  void* allocate(std::size_t size) override {
    const std::lock_guard lock(mutex_);
    const auto block = find_free(size);
    if (block == blocks_.end()) return allocate_large(size);
    block->is_free = false;
    free_ -= block->size;
    return block->memory;
  }

  void free(void* memory, std::size_t size) noexcept override {
    const std::lock_guard lock(mutex_);
    const auto block = std::ranges::find(blocks_, memory, &Block::memory);
    if (block == blocks_.end()) return free_large(memory, size);
    block->is_free = true;
    free_ += block->size;
    std::rotate(block, block + 1, blocks_.end());
    drop_free_blocks(k_most_free);
  }

  void make_room(std::size_t size, int threads, const JobStage& stage) {
    if (!cuda_module() || size > k_largest || has_room(size)) return;
    const std::size_t wanted = (size + k_step - 1) / k_step * k_step;
    const auto give_back = [&](std::byte* memory) { free_large(memory, wanted); };
    std::unique_ptr<std::byte, decltype(give_back)> memory(static_cast<std::byte*>(allocate_large(wanted)), give_back);
    lay_pages(memory.get(), wanted, threads, stage);
    const std::lock_guard lock(mutex_);
    blocks_.reserve(blocks_.size() + 1);  // nothing may fail once it is pinned
    const auto pin = [&] { return cuda_module()->pin(memory.get(), wanted); };
    if (!pin()) {  // there is a limit to what can be
      drop_free_blocks(0);
      if (!pin()) return;
    }
    blocks_.push_back({memory.release(), wanted, true});
    free_ += wanted;
  }

  void release() {
    const std::lock_guard lock(mutex_);
    drop_free_blocks(0);
  }

 private:
  struct Block {
    void* memory;
    std::size_t size;
    bool is_free;
  };
  static constexpr std::size_t k_step = std::size_t{1} << 16, k_largest = std::size_t{1} << 30,
                               k_most_free = std::size_t{1} << 31;

  bool has_room(std::size_t size) {
    const std::lock_guard lock(mutex_);
    return find_free(size) != blocks_.end();
  }

  std::vector<Block>::iterator find_free(std::size_t size) {
    const auto serves = [&](const Block& block) {
      return block.is_free && block.size >= size && block.size - size <= std::max(k_step, size / 4);
    };
    auto best = blocks_.end();
    for (auto block = blocks_.begin(); block != blocks_.end(); ++block)
      if (serves(*block) && (best == blocks_.end() || block->size < best->size)) best = block;
    return best;
  }

  /// Frees the blocks that have been unused the longest, until no more than `most` bytes are unused.
  void drop_free_blocks(std::size_t most) noexcept {
    std::erase_if(blocks_, [&](const Block& block) {
      if (!block.is_free || free_ <= most) return false;
      free_ -= block.size;
      cuda_module()->unpin(block.memory);  // who pinned it is there to the end
      free_large(block.memory, block.size);
      return true;
    });
  }

  std::mutex mutex_;
  std::vector<Block> blocks_;  ///< the free ones in the order in which they became so
  std::size_t free_ = 0;       ///< bytes of those
};

// Never destroyed: arrays may outlive everything else.
PinnedMemory& all() {
  static auto* const memory = new PinnedMemory;
  return *memory;
}

}  // namespace

LargeMemory& pinned_memory() { return all(); }
void make_pinned_room(std::size_t size, int threads, const JobStage& stage) { all().make_room(size, threads, stage); }
void release_pinned_memory() { all().release(); }

}  // namespace saddleback
