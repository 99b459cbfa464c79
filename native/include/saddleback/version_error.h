#pragma once
// What comes of reading tomorrow's files today.

#include "saddleback/error.h"

namespace saddleback {

/// A file that a newer version of this library wrote: nothing is wrong with it, but it cannot be read.
struct VersionError : InputError {
  using InputError::InputError;
};

}  // namespace saddleback
