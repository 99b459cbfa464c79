#pragma once
// The errors that the library throws. Every message is one sentence that names the culprit: which argument, index and
// value.

#include <sstream>
#include <stdexcept>
#include <string>

namespace saddleback {

/// Root of all errors of this library.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The mesh cannot be used as it is (non-manifold, degenerate, not finite ...); `repair` may help.
struct MeshError : Error {
  using Error::Error;
};

/// Any other argument is wrong.
struct InputError : Error {
  using Error::Error;
};

/// A file that a newer version of this library wrote: nothing is wrong with it, but it cannot be read.
struct VersionError : InputError {
  using InputError::InputError;
};

/// The caller's Job was cancelled.
struct Cancelled : Error {
  Cancelled() : Error("cancelled") {}
};

/// The wanted device cannot be used.
struct DeviceError : Error {
  using Error::Error;
};

/// Joins its arguments into one string: message("face ", f, " has vertex ", v).
template <class... Parts>
std::string message(const Parts&... parts) {
  std::ostringstream out;
  out.precision(9);
  (out << ... << parts);
  return out.str();
}

}  // namespace saddleback
