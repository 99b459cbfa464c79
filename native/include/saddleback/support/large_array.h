#pragma once
// Arrays of many megabytes: in huge pages where the system has them, and not filled before they are written.

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace saddleback {

/// Memory for `size` bytes, in huge pages if that pays; the caller frees it with `free_large` of the same size.
/// \throw std::bad_alloc
void* allocate_large(std::size_t size);
void free_large(void* memory, std::size_t size) noexcept;

/// Memory of another kind for large arrays. Outlives all that it gives.
class LargeMemory {
 public:
  /// \throw std::bad_alloc
  virtual void* allocate(std::size_t size) = 0;
  virtual void free(void* memory, std::size_t size) noexcept = 0;

 protected:
  ~LargeMemory() = default;
};

/// New elements have no value until they are given one, as those of a plain array. What is moved stays in its memory,
/// whatever its kind; copies are made in the usual one.
template <class T>
struct LargeAllocator {
  using value_type = T;  // NOLINT(readability-identifier-naming): the standard's names
  using propagate_on_container_move_assignment = std::true_type;  // NOLINT(readability-identifier-naming)
  using propagate_on_container_swap = std::true_type;             // NOLINT(readability-identifier-naming)
  LargeAllocator() = default;
  explicit(false) LargeAllocator(LargeMemory* memory) : source(memory) {}
  template <class U>
  explicit(false) LargeAllocator(const LargeAllocator<U>& other) : source(other.source) {}

  T* allocate(std::size_t count) {
    const std::size_t size = count * sizeof(T);
    return static_cast<T*>(source ? source->allocate(size) : allocate_large(size));
  }
  void deallocate(T* memory, std::size_t count) noexcept {
    const std::size_t size = count * sizeof(T);
    source ? source->free(memory, size) : free_large(memory, size);
  }
  LargeAllocator select_on_container_copy_construction() const { return {}; }
  template <class U>
  void construct(U* place) {
    ::new (static_cast<void*>(place)) U;
  }
  template <class U, class... Arguments>
  void construct(U* place, Arguments&&... arguments) {
    ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
  }
  bool operator==(const LargeAllocator& other) const { return source == other.source; }

  LargeMemory* source = nullptr;  ///< null: the usual one
};

template <class T>
using LargeArray = std::vector<T, LargeAllocator<T>>;

/// New elements have no value until they are given one.
template <class T>
struct UnsetAllocator : std::allocator<T> {
  template <class U>
  void construct(U*) {
    static_assert(std::is_trivially_copyable_v<U> && std::is_trivially_destructible_v<U>);
  }
  template <class U, class... Arguments>
  void construct(U* place, Arguments&&... arguments) {
    ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
  }
};

/// Numbers in ordinary memory: threads that fill it have the system clear its pages, each a part, and not the one that
/// makes it all of them.
template <class T>
using UnsetArray = std::vector<T, UnsetAllocator<T>>;

}  // namespace saddleback
