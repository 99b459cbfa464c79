#include "support/returned_memory.h"

#include <cstdlib>
#include <new>
#if defined(__unix__) || defined(__APPLE__)
#include <sys/mman.h>
#endif

namespace saddleback {

#if defined(__unix__) || defined(__APPLE__)

void* allocate_pages(std::size_t size) {
  void* const memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
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

}  // namespace saddleback
