#pragma once
// What all callers of a twin on a CUDA device share: exceptions do not cross the border between modules.

#include <exception>
#include <string>

#include "saddleback/cuda_twins.h"
#include "saddleback/error.h"

namespace saddleback {

/// Keeps what a call back threw until the twin has come back.
class TwinGuard {
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
  void check(TwinStatus status, const TwinReason& reason) const {
    rethrow();
    if (status != TwinStatus::done) throw DeviceError(message("device: ", reason.text));
  }

 private:
  std::exception_ptr failure_;
};

/// \throw DeviceError when there are none.
inline const CudaTwins& loaded_twins() {
  const CudaTwins* const twins = cuda_twins();
  if (!twins) throw DeviceError("device: the CUDA module is not loaded");
  return *twins;
}

}  // namespace saddleback
