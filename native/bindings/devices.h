#pragma once
// Which device a call runs on.

#include <optional>
#include <string>

#include "saddleback/cuda_twins.h"

#include "convert.h"

namespace saddleback::bindings {

/// The number of the CUDA device that the argument `device` means: "cpu" none, "cuda" the first and "cuda:1" the
/// second, "auto" the first where there is one and `is_worth_it`. \throw DeviceError with the reason when CUDA is asked
/// for and cannot be used; InputError for any other word.
std::optional<int> cuda_device_of(const std::string& device, bool is_worth_it);

/// Seconds of a device's part by its own clock, and how often it needed help.
py::dict as_dict(const DeviceTimes& times);

/// Runs work(device number, or -1 for the processor); with device="auto", what a CUDA device fails at is left to the
/// processor.
template <class Work>
auto run_on(const std::string& device, bool is_worth_it, Work&& work) {
  constexpr int k_processor = -1;
  const std::optional<int> number = cuda_device_of(device, is_worth_it);
  if (!number) return work(k_processor);
  try {
    return work(*number);
  } catch (const DeviceError&) {
    if (device != "auto") throw;
    return work(k_processor);
  }
}

}  // namespace saddleback::bindings
