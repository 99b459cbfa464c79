#pragma once
// The code that all callers of the CUDA module share: exceptions do not cross the border between modules.

#include <exception>
#include <string>

#include "saddleback/error.h"

#include "support/cuda/cuda_module.h"

namespace saddleback {

/// Keeps what a call back threw until the CUDA module has returned.
class CudaGuard {
 public:
  /// \return false when it throws.
  template <class Work>
  bool run(Work&& work) {
    try {
      work();
      return true;
    } catch (...) {
      failure_ = std::current_exception();
      return false;
    }
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }
  /// \throw what was kept, or DeviceError unless it is done.
  void check(CudaStatus status, const CudaReason& reason) const {
    rethrow();
    if (status != CudaStatus::done) throw DeviceError(message("device: ", reason.text));
  }

 private:
  std::exception_ptr failure_;
};

/// \throw DeviceError when there are none.
inline const CudaModule& loaded_cuda_module() {
  const CudaModule* const module = cuda_module();
  if (!module) throw DeviceError("device: the CUDA module is not loaded");
  return *module;
}

}  // namespace saddleback
