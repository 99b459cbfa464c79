#pragma once
// The response of calls to jobs and Ctrl-C.

#include <csignal>
#include <pybind11/pybind11.h>

#include "saddleback/job.h"

namespace saddleback::bindings {

/// Looks up what the others need of Python; once, when the module is loaded.
void prepare_interrupts();

/// Cancels the job at once when Ctrl-C is pressed while this lives, beside what Python does with it. Python's own
/// handler only notes the signal and raises KeyboardInterrupt between bytecodes, and a native call is one long
/// bytecode.
///
/// Only in the main thread, to which the signal belongs, and only where Python would raise KeyboardInterrupt: a handler
/// of the program's own may want the call to go on.
class CancelOnInterrupt {
 public:
  explicit CancelOnInterrupt(Job& job);
  ~CancelOnInterrupt();
  CancelOnInterrupt(const CancelOnInterrupt&) = delete;
  CancelOnInterrupt& operator=(const CancelOnInterrupt&) = delete;

 private:
  bool is_installed_ = false;
  Job* outer_ = nullptr;
};

/// The argument `job` of a call: the caller's, or one of the call's own that only Ctrl-C cancels.
class JobIn {
 public:
  /// \throw InputError for what is neither a saddleback.Job nor None.
  explicit JobIn(const pybind11::object& value);
  operator Job*() const { return job_; }  // NOLINT(google-explicit-constructor): stands for the job everywhere

 private:
  Job own_;
  Job* job_;
  CancelOnInterrupt interrupt_;
};

/// Takes Python's lock again, however the interpreter fares meanwhile; see without_gil.
void lock_python_again(PyThreadState* state) noexcept;

}  // namespace saddleback::bindings
