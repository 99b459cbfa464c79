#pragma once
// Arrays of many megabytes: in huge pages where the system has them, and not filled before they are written.

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace saddleback {

/// Memory for `size` bytes, in huge pages if that pays; the caller frees it with `free_large` of the same size.
/// \throw std::bad_alloc
void* allocate_large(std::size_t size);
void free_large(void* memory, std::size_t size) noexcept;
/// Bytes of freed arrays, at most, that stay at hand for others.
std::size_t most_kept_large();
/// Copies `size` bytes by `threads` threads (0: all cores) where one takes long, above all to lay fresh pages.
void copy_large(void* to, const void* from, std::size_t size, int threads);

/// New elements have no value until they are given one, as those of a plain array.
template <class T>
struct LargeAllocator {
  using value_type = T;  // NOLINT(readability-identifier-naming): the standard's name
  LargeAllocator() = default;
  template <class U>
  explicit(false) LargeAllocator(const LargeAllocator<U>&) {}

  T* allocate(std::size_t count) { return static_cast<T*>(allocate_large(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t count) noexcept { free_large(memory, count * sizeof(T)); }
  template <class U>
  void construct(U* place) {
    ::new (static_cast<void*>(place)) U;
  }
  template <class U, class... Arguments>
  void construct(U* place, Arguments&&... arguments) {
    ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
  }
  bool operator==(const LargeAllocator&) const { return true; }
};

template <class T>
using LargeArray = std::vector<T, LargeAllocator<T>>;

}  // namespace saddleback
