#pragma once
// Copies between a device and host memory that the device cannot reach by itself, which is all memory that nobody
// pinned. The driver copies such memory with one thread; pinning it for one copy takes longer than the copy. Here a few
// threads do it, piece by piece, through pinned memory of their own: they also populate the pages under what is fresh.
// One or two pieces are copied by the caller, who would wait longer for threads to begin and to end, above all where
// those of the work before still look for more. To and from what is pinned the device copies by itself.

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstring>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "support/cuda/cuda_check.h"
#include "support/cuda/device_stream.h"
#include "support/memory/scratch_pool.h"
#include "support/memory/streamed_copy.h"

namespace saddleback {

/// Room for two pieces: one is filled while the other is emptied.
class PinnedPieces {
 public:
  static constexpr std::size_t k_size = std::size_t{1} << 21;
  PinnedPieces() { check_cuda(cudaHostAlloc(&memory_, 2 * k_size, cudaHostAllocPortable), "asking for pinned memory"); }
  ~PinnedPieces() { (void)cudaFreeHost(memory_); }
  PinnedPieces(const PinnedPieces&) = delete;
  PinnedPieces& operator=(const PinnedPieces&) = delete;
  char* piece(int number) const { return static_cast<char*>(memory_) + static_cast<std::size_t>(number) * k_size; }
  /// Pinned pieces that are left to the next call: pinning takes milliseconds.
  static ScratchPool<PinnedPieces>& pool() {
    static ScratchPool<PinnedPieces> pieces;
    return pieces;
  }

 private:
  void* memory_ = nullptr;
};

/// Copies beside the work of a stream. For one thread.
class HostCopies {
 public:
  explicit HostCopies(cudaStream_t stream) : stream_(stream) {
    check_cuda(cudaGetDevice(&device_), "asking for the device");
  }
  ~HostCopies() { close(); }
  HostCopies(const HostCopies&) = delete;
  HostCopies& operator=(const HostCopies&) = delete;

  /// Announces, before the first copy, that `size` bytes will be copied to `to`. Threads begin at once, beside the work
  /// of the stream, to populate the pages there that are fresh; the bytes there are lost, until end_populating() or the
  /// first copy.
  void expect(void* to, std::size_t size) {
    if (is_pinned(to)) return;
    const std::lock_guard lock(mutex_);
    is_expected_ = true;
    populated_ = {static_cast<volatile char*>(to), size};
    for (std::size_t begin = 0; begin < size; begin += PinnedPieces::k_size)
      fresh_.push_back({static_cast<volatile char*>(to) + begin, std::min(PinnedPieces::k_size, size - begin)});
    start_threads(fresh_.size());
  }
  /// Ends all access to the memory that was expected: others may write or free it. Pages that are not populated so far
  /// are populated as they are written.
  void end_populating() {
    std::unique_lock lock(mutex_);
    if (!fresh_.empty())
      populated_ = populated_.first(static_cast<std::size_t>(fresh_.front().data() - populated_.data()));
    fresh_.clear();
    changed_.wait(lock, [&] { return populating_ == 0; });
  }
  /// Copies to the host what the stream has written so far and does not change any more; none to nowhere.
  template <class Number>
  void to_host(const Number* from, std::size_t count, void* to) {
    if (count == 0 || !to) return;
    events_.emplace_back().record(stream_);
    to_host(from, count, to, events_.back());
  }
  /// Copies the same, what was written before an event.
  template <class Number>
  void to_host(const Number* from, std::size_t count, void* to, cudaEvent_t written) {
    if (count == 0 || !to) return;
    add({from, to, count * sizeof(Number), cudaMemcpyDeviceToHost, written}, to);
  }
  /// Copies to the device: complete when finish() returns.
  template <class Number>
  void to_device(const Number* from, std::size_t count, Number* to) {
    if (count == 0) return;
    events_.emplace_back().record(stream_);  // the memory is the stream's from here on
    add({from, to, count * sizeof(Number), cudaMemcpyHostToDevice, events_.back()}, from);
  }
  /// Tells whether the device copies from and to there by itself.
  static bool is_pinned(const void* host) {
    cudaPointerAttributes attributes{};
    if (cudaPointerGetAttributes(&attributes, host) != cudaSuccess) {
      (void)cudaGetLastError();
      return false;
    }
    return attributes.type == cudaMemoryTypeHost;
  }
  /// Waits until all is copied; calls poll(share of it that is) now and then, which may throw.
  template <class Poll>
  void finish(Poll&& poll) {
    using namespace std::chrono_literals;
    for (const Copy& copy : std::exchange(small_, {})) start(copy);
    if (threads_.empty()) copy_here(poll);
    for (std::unique_lock lock(mutex_); open_ > 0 && !failure_;) {
      if (changed_.wait_for(lock, 20ms) == std::cv_status::no_timeout) continue;
      const double share = copied_share();
      lock.unlock();
      poll(share);
      lock.lock();
    }
    if (failure_) std::rethrow_exception(failure_);
    finish_direct(poll);
    events_.clear();
  }
  void finish() {
    finish([](double) {});
  }

 private:
  struct Copy {
    const void* from;
    void* to;
    std::size_t size;
    cudaMemcpyKind kind;
    cudaEvent_t after;
  };
  static constexpr std::size_t k_small = std::size_t{1} << 19;  ///< not worth a thread
  static constexpr std::size_t k_few = 2;                       ///< pieces not worth a thread
  static constexpr std::size_t k_most_threads = 8;
  /// A few milliseconds of the slowest links, and some ten.
  static constexpr std::size_t k_direct = std::size_t{1} << 26, k_most_at_once = std::size_t{1} << 29;

  void start(const Copy& copy) { start(copy, aside_); }
  static void start(const Copy& copy, cudaStream_t stream) {
    check_cuda(cudaStreamWaitEvent(stream, copy.after), "waiting for the device");
    check_cuda(cudaMemcpyAsync(copy.to, copy.from, copy.size, copy.kind, stream), "copying between host and device");
  }

  void add(const Copy& copy, const void* host) {
    end_populating();
    if (is_pinned(host)) return add_direct(copy);
    if (copy.size < k_small) return small_.push_back(copy);  // the driver would make the caller wait
    const std::lock_guard lock(mutex_);
    for (std::size_t begin = 0; begin < copy.size; begin += PinnedPieces::k_size) {
      pieces_.push_back({static_cast<const char*>(copy.from) + begin, static_cast<char*>(copy.to) + begin,
                         std::min(PinnedPieces::k_size, copy.size - begin), copy.kind, copy.after});
      ++open_;
      ++added_;
    }
    start_threads(open_);
    changed_.notify_all();
  }

  void start_threads(std::size_t pieces) {
    const std::size_t most = std::min<std::size_t>(k_most_threads, std::max(1u, std::thread::hardware_concurrency()));
    while (pieces > k_few && threads_.size() < std::min(most, pieces)) threads_.emplace_back([this] { work(); });
  }

  /// Adds copies that the device makes by itself: of pinned memory nothing is in the way, but what the device has been
  /// told to copy it copies: who cancels should not wait for much of it.
  void add_direct(const Copy& copy) {
    for (std::size_t begin = 0; begin < copy.size; begin += k_direct) {
      const Copy piece{static_cast<const char*>(copy.from) + begin, static_cast<char*>(copy.to) + begin,
                       std::min(k_direct, copy.size - begin), copy.kind, copy.after};
      direct_size_ += piece.size;
      if (direct_.empty() && direct_size_ <= k_most_at_once)
        start(piece);
      else
        direct_.push_back(piece);
    }
  }
  template <class Poll>
  void finish_direct(Poll&& poll) {
    const auto count = static_cast<double>(direct_.size());
    for (StreamEvent copied; !direct_.empty(); direct_.pop_front()) {
      copied.record(aside_);
      start(direct_.front());
      wait_polling(copied, [&] { poll(1 - static_cast<double>(direct_.size()) / count); });
    }
    wait_polling(aside_, [&] { poll(count > 0 ? 1. : 0.); });
    direct_size_ = 0;
  }

  template <class Poll>
  void copy_here(Poll&& poll) {
    while (const std::optional<Copy> piece = take(false)) {
      if (!own_) own_.emplace(PinnedPieces::pool().lease());
      char* const memory = (*own_)->piece(0);
      const bool is_up = piece->kind == cudaMemcpyHostToDevice;
      if (is_up) std::memcpy(memory, piece->from, piece->size);
      start({is_up ? memory : piece->from, is_up ? piece->to : memory, piece->size, piece->kind, piece->after});
      wait_polling(aside_, [&] { poll(copied_share()); });
      if (!is_up) copy_out(piece->to, memory, piece->size);
      --open_;
    }
  }

  /// Returns the share of the pieces, while no thread changes them.
  double copied_share() const { return added_ == 0 ? 0 : 1 - static_cast<double>(open_) / static_cast<double>(added_); }

  void close() {
    {
      const std::lock_guard lock(mutex_);
      is_closing_ = true;
      fresh_.clear();
      pieces_.clear();
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
    (void)cudaStreamSynchronize(aside_);
  }

  /// The next piece; nothing at the end, and when there is none and the caller has better to do than wait.
  std::optional<Copy> take(bool waits) {
    std::unique_lock lock(mutex_);
    if (waits) changed_.wait(lock, [&] { return is_closing_ || !pieces_.empty(); });
    if (pieces_.empty()) return std::nullopt;
    const Copy piece = pieces_.front();
    pieces_.pop_front();
    return piece;
  }

  void populate_pages() {
    constexpr std::size_t k_page = std::size_t{1} << 12;
    for (std::unique_lock lock(mutex_); !fresh_.empty();) {
      const std::span<volatile char> memory = fresh_.front();
      fresh_.pop_front();
      ++populating_;
      lock.unlock();
      for (std::size_t at = 0; at < memory.size(); at += k_page) memory[at] = 0;
      lock.lock();
      if (--populating_ == 0) changed_.notify_all();
    }
  }

  /// Pages that the system clears on the way are in the caches by then: only what was populated before is not.
  void copy_out(void* to, const void* from, std::size_t size) const {
    const std::less<const volatile void*> before;
    if (!before(to, populated_.data()) && before(to, populated_.data() + populated_.size()))
      return copy_past_caches(to, from, size);
    std::memcpy(to, from, size);
  }

  void work() {
    try {
      populate_pages();
      check_cuda(cudaSetDevice(device_), "choosing the device");
      copy_pieces();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
      changed_.notify_all();
    }
  }

  void copy_pieces() {
    const auto pinned = PinnedPieces::pool().lease();
    // In one stream the device comes to the next piece sooner, which is in the way of others' smaller copies as long as
    // there is work beside these.
    std::optional<Stream> own;
    if (!is_expected_) own.emplace();
    const cudaStream_t stream = own ? static_cast<cudaStream_t>(*own) : aside_;
    const StreamEvent copied[2];
    std::optional<Copy> last;
    for (int slot = 0;; slot ^= 1) {
      const std::optional<Copy> piece = take(!last);
      if (!piece && !last) return;
      if (piece) {
        char* const memory = pinned->piece(slot);
        const bool is_up = piece->kind == cudaMemcpyHostToDevice;
        if (is_up) std::memcpy(memory, piece->from, piece->size);
        start({is_up ? memory : piece->from, is_up ? piece->to : memory, piece->size, piece->kind, piece->after},
              stream);
        copied[slot].record(stream);
      }
      if (last) {
        check_cuda(cudaEventSynchronize(copied[slot ^ 1]), "copying between host and device");
        if (last->kind == cudaMemcpyDeviceToHost) copy_out(last->to, pinned->piece(slot ^ 1), last->size);
        const std::lock_guard lock(mutex_);
        if (--open_ == 0) changed_.notify_all();
      }
      last = piece;
    }
  }

  cudaStream_t stream_;
  Stream aside_;
  int device_ = 0;
  std::vector<StreamEvent> events_;
  std::vector<Copy> small_;
  std::deque<Copy> direct_;  ///< of pinned memory, not begun yet
  std::size_t direct_size_ = 0;
  std::vector<std::thread> threads_;
  std::optional<ScratchPool<PinnedPieces>::Lease> own_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::span<volatile char>> fresh_;  ///< memory whose pages are still to be populated
  int populating_ = 0;                          ///< threads that populate pages
  std::span<volatile char> populated_;
  bool is_expected_ = false;  ///< expect() was called; threads do not read populated_ before they copy
  std::deque<Copy> pieces_;
  std::size_t added_ = 0, open_ = 0;  ///< pieces, and those of them not copied yet
  std::exception_ptr failure_;
  bool is_closing_ = false;
};

}  // namespace saddleback
