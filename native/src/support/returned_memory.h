#pragma once
// Arrays whose memory goes back to the system as soon as they are freed, so that it counts no longer at the peak of
// what follows. An ordinary heap keeps what lies between other things.

#include <cstddef>
#include <vector>

namespace saddleback {

/// Whole pages of the system's, so for arrays of many kilobytes. \throw std::bad_alloc
void* allocate_pages(std::size_t size);
void free_pages(void* memory, std::size_t size) noexcept;

template <class T>
struct ReturningAllocator {
  using value_type = T;  // NOLINT(readability-identifier-naming): the standard's name
  ReturningAllocator() = default;
  template <class U>
  explicit(false) ReturningAllocator(const ReturningAllocator<U>&) {}

  T* allocate(std::size_t count) { return static_cast<T*>(allocate_pages(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t count) noexcept { free_pages(memory, count * sizeof(T)); }
  bool operator==(const ReturningAllocator&) const { return true; }
};

template <class T>
using ReturnedVector = std::vector<T, ReturningAllocator<T>>;

}  // namespace saddleback
