// Touching fresh memory costs a visit to the kernel for each page; with pages of 2 MiB the visits are nothing, but
// clearing them is not. What is too small for those is kept for the next array of its size. Of larger arrays the huge
// pages are kept, some of them and on loan: the system may take them back whenever it is short of memory. Each page can
// become a part of an array of any size, so that none lies idle between others while more are asked for.

#include "saddleback/support/large_array.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>

#include "support/memory/large_memory.h"
#include "support/memory/returned_memory.h"
#include "support/threads/parallel.h"
#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
#define SADDLEBACK_OWN_PAGES
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace saddleback {

namespace {
/// Goes back to the system within a few milliseconds.
constexpr std::size_t k_returned_piece = std::size_t{1} << 24;
}  // namespace

#ifdef SADDLEBACK_OWN_PAGES

namespace {

constexpr std::size_t k_huge = std::size_t{1} << 21, k_step = std::size_t{1} << 16;
constexpr std::size_t k_smallest = k_step;                     // below, an ordinary heap is as good
constexpr std::size_t k_smallest_kept = std::size_t{1} << 12;  // though such a heap may go back and forth to the system
constexpr std::size_t k_largest_kept = 7 << 19, k_most_kept = std::size_t{24} << 20;

/// Returns what is had for a size. The last page is huge only where most of it is used: small pages are never kept.
std::size_t rounded(std::size_t size) {
  if (size < k_smallest) return (size + k_smallest_kept - 1) / k_smallest_kept * k_smallest_kept;
  return std::max((size + k_step - 1) / k_step * k_step, (size + 3 * k_huge / 8) / k_huge * k_huge);
}

/// Memory from the system; what is large begins at a huge page. nullptr when there is none.
void* map_pages(std::size_t size) {
  const std::size_t extra = size >= k_huge / 2 ? k_huge : 0;
  void* const memory = mmap(nullptr, size + extra, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return nullptr;
  if (extra == 0) return memory;
  char* const start = static_cast<char*>(memory);
  const std::size_t skipped = (k_huge - reinterpret_cast<std::uintptr_t>(start) % k_huge) % k_huge;
  if (skipped > 0) munmap(start, skipped);
  if (extra > skipped) munmap(start + skipped + size, extra - skipped);
  madvise(start + skipped, size / k_huge * k_huge, MADV_HUGEPAGE);  // advice, which the system may ignore
  return start + skipped;
}

/// Free memory of small arrays.
class Kept {
 public:
  void* take(std::size_t size) {
    const std::lock_guard lock(mutex_);
    const auto end = blocks_.begin() + count_;
    const auto found = std::find_if(blocks_.begin(), end, [&](const Block& block) { return block.size == size; });
    if (found == end) return nullptr;
    void* const memory = found->memory;
    *found = blocks_[--count_];
    total_ -= size;
    return memory;
  }
  /// False if there is enough already.
  bool keep(void* memory, std::size_t size) {
    const std::lock_guard lock(mutex_);
    if (size > k_largest_kept || total_ + size > k_most_kept || count_ == blocks_.size()) return false;
    blocks_[count_++] = {memory, size};
    total_ += size;
    return true;
  }

 private:
  struct Block {
    void* memory;
    std::size_t size;
  };
  std::mutex mutex_;
  std::array<Block, 64> blocks_{};
  std::size_t count_ = 0, total_ = 0;
};

// Never destroyed: arrays may outlive everything else.
Kept& kept() {
  static Kept* const all = new Kept;
  return *all;
}

/// Free huge pages, up to a small part of the memory that there is.
class KeptPages {
 public:
  KeptPages() : most_(find_most()), pages_(std::make_unique<char*[]>(most_)) {}

  /// Puts pages in the place of the first ones of fresh memory.
  void lay(void* memory, std::size_t size) {
    const std::lock_guard lock(mutex_);
    char* to = static_cast<char*>(memory);
    for (const char* const end = to + size / k_huge * k_huge; to != end && count_ > 0; to += k_huge)
      mremap(pages_[--count_], k_huge, k_huge, MREMAP_MAYMOVE | MREMAP_FIXED, to);  // if not, the fresh page stays
  }
  /// Takes the first pages of memory that is not used any more; returns the size of what was taken.
  std::size_t keep(void* memory, std::size_t size) {
    const std::lock_guard lock(mutex_);
    char* const begin = static_cast<char*>(memory);
    const std::size_t taken = std::min(size / k_huge, most_ - count_);
    if (taken > 0 && madvise(begin, taken * k_huge, MADV_FREE) != 0) return 0;
    for (std::size_t i = 0; i < taken; ++i) pages_[count_++] = begin + i * k_huge;
    return taken * k_huge;
  }

 private:
  static std::size_t find_most() {
    constexpr std::size_t k_share = 8, k_limit = 2048;
    const auto pages = static_cast<std::size_t>(std::max(0L, sysconf(_SC_PHYS_PAGES)));
    const auto page_size = static_cast<std::size_t>(std::max(0L, sysconf(_SC_PAGESIZE)));
    return std::min(k_limit, pages * page_size / k_share / k_huge);
  }

  std::mutex mutex_;
  std::size_t most_;
  std::unique_ptr<char*[]> pages_;
  std::size_t count_ = 0;
};

KeptPages& kept_pages() {
  static KeptPages* const all = new KeptPages;
  return *all;
}

}  // namespace

void* allocate_large(std::size_t size) {
  const std::size_t wanted = size >= k_smallest_kept ? rounded(size) : std::max<std::size_t>(size, 1);
  void* memory = size >= k_smallest_kept ? kept().take(wanted) : nullptr;
  if (memory) return memory;
  memory = wanted < k_smallest ? std::malloc(wanted) : map_pages(wanted);
  if (!memory) throw std::bad_alloc();
  if (wanted >= k_huge) kept_pages().lay(memory, wanted);
  return memory;
}

namespace {

/// Piece by piece, so that others who ask for memory meanwhile wait for one of them at most.
void give_back_pages(char* memory, std::size_t size) noexcept {
  while (size > 0) {
    const std::size_t piece = std::min(size, k_returned_piece);
    const std::size_t kept_size = kept_pages().keep(memory, piece);
    if (kept_size < piece) munmap(memory + kept_size, piece - kept_size);
    memory += piece;
    size -= piece;
  }
}

void free_now(void* memory, std::size_t size) noexcept {
  const std::size_t had = rounded(size);
  if (size >= k_smallest_kept && kept().keep(memory, had)) return;
  if (had < k_smallest) return std::free(memory);  // as it was given: kept memory serves any size that fits
  give_back_pages(static_cast<char*>(memory), had);
}

}  // namespace

#else

void* allocate_large(std::size_t size) {
  void* const memory = std::malloc(size ? size : 1);
  if (!memory) throw std::bad_alloc();
  return memory;
}

static void free_now(void* memory, std::size_t) noexcept { std::free(memory); }

#endif

void free_large(void* memory, std::size_t size) noexcept {
  if (size < k_returned_piece || std::uncaught_exceptions() == 0) return free_now(memory, size);
  auto free = [size](void* abandoned) { free_now(abandoned, size); };
  free_in_background(std::unique_ptr<void, decltype(free)>(memory, free));
}

void copy_large(void* to, const void* from, std::size_t size, int threads) {
  constexpr std::size_t k_piece = std::size_t{1} << 21;
  const auto pieces = static_cast<Index>((size + k_piece - 1) / k_piece);
  parallel_for(pieces, threads, 4, [&](Index piece, int) {
    const std::size_t begin = static_cast<std::size_t>(piece) * k_piece;
    std::memcpy(static_cast<char*>(to) + begin, static_cast<const char*>(from) + begin,
                std::min(k_piece, size - begin));
  });
}

}  // namespace saddleback
