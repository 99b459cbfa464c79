#pragma once
// Memory of a CUDA device, freed in the order of a stream.

#include <cstddef>
#include <span>
#include <utility>

#include "support/cuda/cuda_check.h"

namespace saddleback {

/// `count` numbers on the device. Memory comes from the device's pool, which keeps what was freed for the next one.
template <class Number>
class DeviceBuffer {
 public:
  DeviceBuffer() = default;
  DeviceBuffer(std::size_t count, cudaStream_t stream) : count_(count), stream_(stream) {
    if (count > 0) check_cuda(cudaMallocAsync(&data_, count * sizeof(Number), stream), "allocating device memory");
  }
  /// Makes one with a copy of what is in host memory; complete when the stream has run.
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
  void read(std::span<Number> to) const { read(to, stream_); }
  /// Waits for another stream, and reads what there is by then.
  void read(std::span<Number> to, cudaStream_t stream) const {
    if (!to.empty())
      check_cuda(cudaMemcpyAsync(to.data(), data_, to.size_bytes(), cudaMemcpyDeviceToHost, stream),
                 "copying from the device");
    check_cuda(cudaStreamSynchronize(stream), "waiting for the device");
  }

  /// One of them; waits for the stream.
  Number value_at(std::size_t place) const { return value_at(place, stream_); }
  /// Waits for another stream, and reads what there is by then.
  Number value_at(std::size_t place, cudaStream_t stream) const {
    Number value{};
    check_cuda(cudaMemcpyAsync(&value, data_ + place, sizeof value, cudaMemcpyDeviceToHost, stream),
               "copying from the device");
    check_cuda(cudaStreamSynchronize(stream), "waiting for the device");
    return value;
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

}  // namespace saddleback
