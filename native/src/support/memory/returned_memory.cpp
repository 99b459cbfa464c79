#include "support/memory/returned_memory.h"

#include <algorithm>
#include <cstdlib>
#include <new>
#if defined(__unix__) || defined(__APPLE__)
#include <sys/mman.h>
#endif

namespace saddleback {

#if defined(__unix__) || defined(__APPLE__)

namespace {
[[maybe_unused]] constexpr std::size_t k_worth_huge_pages = std::size_t{1} << 21;
}

void* allocate_pages(std::size_t size) {
  void* const memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  // Of what is large the middle, wherever huge pages fit: each is one visit to the kernel instead of hundreds.
  if (size >= k_worth_huge_pages) madvise(memory, size, MADV_HUGEPAGE);
#endif
  return memory;
}

void free_pages(void* memory, std::size_t size) noexcept { munmap(memory, size); }

#else

void* allocate_pages(std::size_t size) {
  void* const memory = std::malloc(size);
  if (!memory) throw std::bad_alloc();
  return memory;
}

void free_pages(void* memory, std::size_t) noexcept { std::free(memory); }

#endif

ReturnedPieces::Owner ReturnedPieces::take(std::size_t size) {
  constexpr std::size_t k_alignment = 64;
  const std::size_t room = (size + k_alignment - 1) / k_alignment * k_alignment;
  if (!piece_ || used_ + room > size_) {
    size_ = std::max(room, piece_size_);
    const std::size_t had = size_;
    piece_ = Owner(allocate_pages(had), [had](void* memory) { free_pages(memory, had); });
    used_ = 0;
  }
  Owner result(piece_, static_cast<std::byte*>(piece_.get()) + used_);
  used_ += room;
  return result;
}

}  // namespace saddleback
