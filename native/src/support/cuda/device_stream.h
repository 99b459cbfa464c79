#pragma once
// A CUDA device's work in order, its clock and its memory.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/cuda/cuda_check.h"
#include "support/cuda/cuda_module.h"

namespace saddleback {

/// The caller asked to stop.
struct Stopped {};
/// The processor had better do it.
struct LeftOver {};

/// Runs the work of a call of the CUDA module: nothing that it throws crosses the module's border.
template <class Work>
CudaStatus cuda_status(CudaReason& reason, Work&& work) {
  try {
    work();
    return CudaStatus::done;
  } catch (const Stopped&) {
    return CudaStatus::stopped;
  } catch (const LeftOver&) {
    return CudaStatus::left;
  } catch (const std::exception& failure) {
    reason = failure.what();
    return CudaStatus::failed;
  }
}

/// Returns what several devices took together: of each part, the longest.
inline DeviceTimes slowest(const std::vector<DeviceTimes>& parts) {
  DeviceTimes all;
  for (const DeviceTimes& part : parts) {
    all.upload = std::max(all.upload, part.upload);
    all.order = std::max(all.order, part.order);
    all.find = std::max(all.find, part.find);
    all.unite = std::max(all.unite, part.unite);
    all.download = std::max(all.download, part.download);
    all.second_pass += part.second_pass;
    all.by_processor += part.by_processor;
  }
  return all;
}

/// Time between two moments of a stream.
class Stopwatch {
 public:
  explicit Stopwatch(cudaStream_t stream) : stream_(stream) {
    check_cuda(cudaEventCreate(&from_), "making an event");
    check_cuda(cudaEventCreate(&to_), "making an event");
    check_cuda(cudaEventRecord(from_, stream), "recording an event");
  }
  ~Stopwatch() {
    (void)cudaEventDestroy(from_);
    (void)cudaEventDestroy(to_);
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  /// Seconds since the last lap; waits for the stream.
  double lap() {
    end();
    return read();
  }
  void start() { check_cuda(cudaEventRecord(from_, stream_), "recording an event"); }
  /// Records where the stream is now; `read` waits for it.
  void end() { check_cuda(cudaEventRecord(to_, stream_), "recording an event"); }
  double read() {
    check_cuda(cudaEventSynchronize(to_), "waiting for the device");
    float milliseconds = 0;
    check_cuda(cudaEventElapsedTime(&milliseconds, from_, to_), "reading the clock");
    std::swap(from_, to_);
    return milliseconds * 1e-3;
  }

 private:
  cudaStream_t stream_;
  cudaEvent_t from_ = nullptr, to_ = nullptr;
};

class Stream {
 public:
  Stream() { check_cuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "making a stream"); }
  ~Stream() {
    (void)cudaStreamSynchronize(stream_);
    (void)cudaStreamDestroy(stream_);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  operator cudaStream_t() const { return stream_; }

 private:
  cudaStream_t stream_ = nullptr;
};

/// A moment of a stream.
class StreamEvent {
 public:
  StreamEvent() { check_cuda(cudaEventCreateWithFlags(&event_, cudaEventDisableTiming), "making an event"); }
  ~StreamEvent() {
    if (event_) (void)cudaEventDestroy(event_);
  }
  StreamEvent(StreamEvent&& other) noexcept : event_(std::exchange(other.event_, nullptr)) {}
  StreamEvent& operator=(StreamEvent&&) = delete;
  operator cudaEvent_t() const { return event_; }
  void record(cudaStream_t stream) const { check_cuda(cudaEventRecord(event_, stream), "recording an event"); }

 private:
  cudaEvent_t event_ = nullptr;
};

inline cudaError_t state_of(cudaStream_t stream) { return cudaStreamQuery(stream); }
inline cudaError_t state_of(cudaEvent_t event) { return cudaEventQuery(event); }

/// Waits for a stream or an event; calls poll() now and then, which may throw.
template <class Awaited, class Poll>
void wait_polling(const Awaited& awaited, Poll&& poll) {
  using Clock = std::chrono::steady_clock;
  using namespace std::chrono_literals;
  for (auto asked = Clock::now();;) {
    const cudaError_t state = state_of(awaited);
    if (state == cudaSuccess) return;
    if (state != cudaErrorNotReady) check_cuda(state, "waiting for the device");
    if (Clock::now() - asked < 20ms) continue;
    poll();
    asked = Clock::now();
    std::this_thread::sleep_for(500us);
  }
}

/// Does the same, with another stream for poll(stream). When that throws, stop(stream) has to see to it that the work
/// ends soon, and what was thrown goes on once it has.
template <class Poll, class Stop>
void wait_polling(cudaStream_t stream, Poll&& poll, Stop&& stop) {
  std::optional<Stream> other;  // making one takes longer than most waits
  const auto aside = [&]() -> cudaStream_t {
    if (!other) other.emplace();
    return *other;
  };
  try {
    wait_polling(stream, [&] { poll(aside()); });
  } catch (...) {
    stop(aside());
    (void)cudaStreamSynchronize(stream);
    throw;
  }
}

/// Lets the device's pool keep what is freed: asking the driver for memory takes longer than most kernels.
inline void keep_freed_memory(int device) {
  cudaMemPool_t pool = nullptr;
  check_cuda(cudaDeviceGetDefaultMemPool(&pool, device), "asking for the memory pool");
  std::uint64_t everything = ~std::uint64_t{0};
  check_cuda(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &everything), "setting up the memory pool");
}

/// \throw std::runtime_error, before anything runs, when less than that is free or allowed (0: whatever is free).
inline void check_device_room(const char* what, std::uint64_t needed, std::uint64_t allowed) {
  std::size_t free = 0, total = 0;
  check_cuda(cudaMemGetInfo(&free, &total), "asking for free memory");
  const std::uint64_t room = allowed > 0 ? std::min<std::uint64_t>(allowed, free) : free;
  if (needed <= room) return;
  const auto megabytes = [](std::uint64_t bytes) { return std::to_string((bytes + (1 << 20) - 1) >> 20); };
  throw std::runtime_error(std::string(what) + " needs about " + megabytes(needed) +
                           " MB of the device's memory, and " + megabytes(room) + " MB are free");
}

}  // namespace saddleback
