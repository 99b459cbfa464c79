// Touching fresh memory costs a visit to the kernel for each page; with pages of 2 MiB that is nothing.

#include "saddleback/large_array.h"

#include <cstdlib>
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace saddleback {

void* allocate_large(std::size_t size) {
#ifdef __linux__
  constexpr std::size_t k_page = std::size_t{1} << 21;
  if (size >= k_page / 2) {
    void* const memory = std::aligned_alloc(k_page, (size + k_page - 1) / k_page * k_page);
    if (!memory) throw std::bad_alloc();
    // A wish: nothing is lost when it is not granted. The last page only where most of it is used.
    madvise(memory, (size + k_page / 8) / k_page * k_page, MADV_HUGEPAGE);
    return memory;
  }
#endif
  void* const memory = std::malloc(size ? size : 1);
  if (!memory) throw std::bad_alloc();
  return memory;
}

void free_large(void* memory) noexcept { std::free(memory); }

}  // namespace saddleback
