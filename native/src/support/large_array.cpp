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
  if (size >= 2 * k_page) {
    void* const memory = std::aligned_alloc(k_page, (size + k_page - 1) / k_page * k_page);
    if (!memory) throw std::bad_alloc();
    madvise(memory, size / k_page * k_page, MADV_HUGEPAGE);  // a wish: nothing is lost when it is not granted
    return memory;
  }
#endif
  void* const memory = std::malloc(size ? size : 1);
  if (!memory) throw std::bad_alloc();
  return memory;
}

void free_large(void* memory) noexcept { std::free(memory); }

}  // namespace saddleback
