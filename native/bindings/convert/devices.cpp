#include "convert/devices.h"

#include <charconv>
#include <optional>
#include <pybind11/stl.h>
#include <string_view>

#include "convert/convert.h"
#include "support/cuda/cuda_module.h"
#include "support/cuda/pinned_memory.h"

namespace saddleback::bindings {
namespace {

/// The package knows how to find the CUDA module; it answers with the devices' numbers, or a sentence.
/// \param wanted which of the usable ones; null: all
std::vector<int> ask_package(const std::optional<std::vector<int>>& wanted, bool is_asked_for) {
  const py::object answer = py::module_::import("saddleback._devices").attr("_usable_cuda_devices")(wanted);
  if (!py::isinstance<py::str>(answer)) return answer.cast<std::vector<int>>();
  if (is_asked_for) throw DeviceError(message("device: ", answer.cast<std::string>()));
  return {};
}

/// "0,2"; nothing when it is no such list.
std::optional<std::vector<int>> numbers_in(std::string_view list) {
  std::vector<int> numbers;
  for (const char *at = list.data(), *const end = at + list.size();; ++at) {
    int number = -1;
    const auto [rest, error] = std::from_chars(at, end, number);
    if (error != std::errc() || number < 0) return std::nullopt;
    numbers.push_back(number);
    if (rest == end) return numbers;
    if (*rest != ',') return std::nullopt;
    at = rest;
  }
}

}  // namespace

std::vector<int> cuda_devices_of(const std::string& device, bool is_worth_it) {
  constexpr std::string_view k_cuda = "cuda", k_listed = "cuda:";
  const std::vector<int> first{0};
  if (device == "cpu") return {};
  if (device == "auto") return is_worth_it ? ask_package(first, false) : std::vector<int>();
  if (device == k_cuda) return ask_package(first, true);
  if (device == "cuda:all") return ask_package(std::nullopt, true);
  if (device.starts_with(k_listed)) {
    const auto numbers = numbers_in(std::string_view(device).substr(k_listed.size()));
    if (numbers) return ask_package(numbers, true);
  }
  throw InputError(message("device: wanted 'auto', 'cpu', 'cuda', 'cuda:all' or 'cuda:' and numbers like '0,1', got '",
                           device, "'"));
}

py::dict as_dict(const DeviceTimes& times) {
  return py::dict(py::arg("upload") = times.upload, py::arg("order") = times.order, py::arg("find") = times.find,
                  py::arg("unite") = times.unite, py::arg("download") = times.download,
                  py::arg("second_pass") = times.second_pass, py::arg("by_processor") = times.by_processor);
}

void bind_devices(py::module_& m) {
  m.def(
      "set_cuda_module",
      [](const py::capsule& module) { set_cuda_module(static_cast<const CudaModule*>(module.get_pointer())); },
      py::arg("module"), "Tell the library what the CUDA module offers.");
  m.def(
      "limit_device_memory", [](const py::object& bytes) { limit_cuda_memory(as_seed(bytes, "bytes")); },
      py::arg("bytes"), R"(Say how much of a CUDA device's memory may be taken, from the next call on.

Others may need the rest: a renderer, or another program.

Parameters
----------
bytes : int
    0: what is free.

Raises
------
InputError
    A negative number.

Notes
-----
What needs more raises DeviceError with the figure before anything runs; with device="auto" it runs on the processor.)");
  m.def("release_pinned_memory", &release_pinned_memory, py::call_guard<py::gil_scoped_release>(),
        R"(Give back to the system what `pinned=True` keeps for results to come: up to 2 GiB of what was freed.)");
}

}  // namespace saddleback::bindings
