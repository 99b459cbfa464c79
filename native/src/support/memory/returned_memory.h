#pragma once
// Arrays whose memory goes back to the system as soon as they are freed, so that it counts no longer at the peak of
// what follows. An ordinary heap keeps what lies between other things.

#include <cstddef>
#include <exception>
#include <memory>
#include <span>
#include <thread>
#include <utility>
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

/// Memory for many arrays of one thread, one after the other in pieces. A piece goes back to the system with the last
/// of its arrays: as each return makes all threads wait, pieces are large where arrays are freed in the order in which
/// they were made.
class ReturnedPieces {
 public:
  using Owner = std::shared_ptr<void>;
  explicit ReturnedPieces(std::size_t piece_size) : piece_size_(piece_size) {}
  /// Room for `size` bytes, aligned for anything. \throw std::bad_alloc
  Owner take(std::size_t size);

 private:
  std::size_t piece_size_, used_ = 0, size_ = 0;
  Owner piece_;
};

/// Frees what a cancelled call leaves behind: returning a gigabyte of pages, small ones above all, takes longer than a
/// user who cancelled should have to wait.
template <class T>
void free_in_background(T abandoned) noexcept {
  try {
    std::thread([kept = std::move(abandoned)] {}).detach();
  } catch (const std::exception&) {
    return;  // no thread is to be had: freed by now
  }
}

}  // namespace saddleback
