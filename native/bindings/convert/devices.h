#pragma once
// The choice of the device on which a call runs.

#include <string>
#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "convert/convert.h"
#include "support/cuda/cuda_module.h"

namespace saddleback::bindings {

/// The numbers of the CUDA devices that the argument `device` means: "cpu" none, "cuda" the first, "cuda:1" the second,
/// "cuda:0,1" these two and "cuda:all" all of them, "auto" the first where there is one and `is_worth_it`.
/// \throw DeviceError with the reason when CUDA is asked for and cannot be used; InputError for any other word.
std::vector<int> cuda_devices_of(const std::string& device, bool is_worth_it);

/// Vertices of a mesh below which what a device gains is lost on the way there.
inline constexpr Index k_vertices_worth_a_device = 20'000;

/// Tells whether a search in the graph is worth it with device="auto": where a CUDA device built the graph or keeps it.
inline bool is_search_worth_a_device(const SaddleVertexGraph& graph) {
  return (graph.built_by_cuda() || graph.is_on_device()) && graph.mesh().vertex_count() >= k_vertices_worth_a_device;
}

/// Number of the device that searches, of those chosen; -1: the processor.
inline int first_device(const std::vector<int>& devices) { return devices.empty() ? -1 : devices.front(); }

/// Seconds of a device's part by its own clock, and how often it needed help.
py::dict as_dict(const DeviceTimes& times);

/// Runs work(numbers of CUDA devices; none for the processor); with device="auto", what a CUDA device fails at is left
/// to the processor.
template <class Work>
auto run_on(const std::string& device, bool is_worth_it, Work&& work) {
  const std::vector<int> processor, numbers = cuda_devices_of(device, is_worth_it);
  if (numbers.empty()) return work(processor);
  try {
    return work(numbers);
  } catch (const DeviceError&) {
    if (device != "auto") throw;
    return work(processor);
  }
}

}  // namespace saddleback::bindings
