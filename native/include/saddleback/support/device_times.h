#pragma once
// How long CUDA devices took.

#include <cstdint>

namespace saddleback {

/// Holds how long the parts of a build took, in seconds by the device's clock, and how its sources or sites went. A
/// plane's diagram is ordered, found and united; a graph is found and united; a field is found and united into the
/// order of the vertices.
struct DeviceTimes {
  double upload = 0, order = 0, find = 0, unite = 0, download = 0;
  std::int64_t second_pass = 0, by_processor = 0;  ///< what overflowed: done again there, or here
};

}  // namespace saddleback
