#pragma once
// Memory of a CUDA device, freed in the order of a stream.

#include <cstddef>
#include <span>
#include <utility>

#include "support/cuda_check.h"

namespace saddleback {

/// Host memory that the device reads and writes by itself as long as this lives: many times faster than through a
/// buffer of the driver's. Where it cannot be had, copies go the slow way. Small ranges are not worth it.
class PinnedRange {
 public:
  PinnedRange(const void* data, std::size_t size) {
    constexpr std::size_t k_worth_pinning = std::size_t{1} << 22;
    if (size < k_worth_pinning || !data) return;
    if (cudaHostRegister(const_cast<void*>(data), size, cudaHostRegisterDefault) == cudaSuccess) {
      data_ = const_cast<void*>(data);
    } else {
      (void)cudaGetLastError();
    }
  }
  ~PinnedRange() {
    if (data_) (void)cudaHostUnregister(data_);
  }
  PinnedRange(const PinnedRange&) = delete;
  PinnedRange& operator=(const PinnedRange&) = delete;

 private:
  void* data_ = nullptr;
};

/// `count` numbers on the device. Memory comes from the device's pool, which keeps what was freed for the next one.
template <class Number>
class DeviceBuffer {
 public:
  DeviceBuffer() = default;
  DeviceBuffer(std::size_t count, cudaStream_t stream) : count_(count), stream_(stream) {
    if (count > 0) check_cuda(cudaMallocAsync(&data_, count * sizeof(Number), stream), "allocating device memory");
  }
  /// With a copy of what is in host memory; complete when the stream has run.
  DeviceBuffer(std::span<const Number> values, cudaStream_t stream) : DeviceBuffer(values.size(), stream) {
    if (!values.empty())
      check_cuda(cudaMemcpyAsync(data_, values.data(), values.size_bytes(), cudaMemcpyHostToDevice, stream),
                 "copying to the device");
  }
  ~DeviceBuffer() {
    if (data_) (void)cudaFreeAsync(data_, stream_);
  }
  DeviceBuffer(DeviceBuffer&& other) noexcept { swap(other); }
  DeviceBuffer& operator=(DeviceBuffer&& other) noexcept {
    swap(other);
    return *this;
  }

  Number* data() { return data_; }
  const Number* data() const { return data_; }
  std::size_t size() const { return count_; }
  void fill_bytes(int value) {
    if (count_ > 0) check_cuda(cudaMemsetAsync(data_, value, count_ * sizeof(Number), stream_), "clearing memory");
  }
  /// Waits for the stream.
  void read(std::span<Number> to) const {
    if (!to.empty())
      check_cuda(cudaMemcpyAsync(to.data(), data_, to.size_bytes(), cudaMemcpyDeviceToHost, stream_),
                 "copying from the device");
    check_cuda(cudaStreamSynchronize(stream_), "waiting for the device");
  }

 private:
  void swap(DeviceBuffer& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(count_, other.count_);
    std::swap(stream_, other.stream_);
  }
  Number* data_ = nullptr;
  std::size_t count_ = 0;
  cudaStream_t stream_ = nullptr;
};

/// Copies to host memory beside the work of a stream.
class CopiesAside {
 public:
  explicit CopiesAside(cudaStream_t stream) : stream_(stream) {
    check_cuda(cudaStreamCreateWithFlags(&aside_, cudaStreamNonBlocking), "making a stream");
    check_cuda(cudaEventCreateWithFlags(&ready_, cudaEventDisableTiming), "making an event");
  }
  ~CopiesAside() {
    (void)cudaStreamSynchronize(aside_);
    (void)cudaEventDestroy(ready_);
    (void)cudaStreamDestroy(aside_);
  }
  CopiesAside(const CopiesAside&) = delete;
  CopiesAside& operator=(const CopiesAside&) = delete;

  /// Of what the stream has written so far and does not change any more; none to nowhere.
  template <class Number>
  void start(const Number* from, std::size_t count, void* to) {
    if (count == 0 || !to) return;
    check_cuda(cudaEventRecord(ready_, stream_), "recording an event");
    check_cuda(cudaStreamWaitEvent(aside_, ready_), "waiting for the device");
    check_cuda(cudaMemcpyAsync(to, from, count * sizeof(Number), cudaMemcpyDeviceToHost, aside_),
               "copying from the device");
  }
  void finish() const { check_cuda(cudaStreamSynchronize(aside_), "copying from the device"); }

 private:
  cudaStream_t stream_, aside_ = nullptr;
  cudaEvent_t ready_ = nullptr;
};

}  // namespace saddleback
