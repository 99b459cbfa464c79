#include "devices.h"

#include <charconv>
#include <string_view>

#include "saddleback/cuda_twins.h"

#include "convert.h"

namespace saddleback::bindings {
namespace {

/// The package knows how to find the CUDA module; it answers with a device's number, or a sentence.
std::optional<int> ask_package(int wanted, bool is_asked_for) {
  const py::object answer = py::module_::import("saddleback._devices").attr("_usable_cuda_device")(wanted);
  if (!py::isinstance<py::str>(answer)) return answer.cast<int>();
  if (is_asked_for) throw DeviceError(message("device: ", answer.cast<std::string>()));
  return std::nullopt;
}

}  // namespace

std::optional<int> cuda_device_of(const std::string& device, bool is_worth_it) {
  constexpr std::string_view k_cuda = "cuda";
  if (device == "cpu") return std::nullopt;
  if (device == "auto") return is_worth_it ? ask_package(0, false) : std::nullopt;
  if (device == k_cuda) return ask_package(0, true);
  if (device.starts_with("cuda:")) {
    int number = -1;
    const char *const begin = device.data() + k_cuda.size() + 1, *const end = device.data() + device.size();
    const auto [rest, error] = std::from_chars(begin, end, number);
    if (error == std::errc() && rest == end && number >= 0) return ask_package(number, true);
  }
  throw InputError(message("device: wanted 'auto', 'cpu', 'cuda' or 'cuda:' and a number, got '", device, "'"));
}

py::dict as_dict(const DeviceTimes& times) {
  return py::dict(py::arg("upload") = times.upload, py::arg("order") = times.order, py::arg("find") = times.find,
                  py::arg("unite") = times.unite, py::arg("download") = times.download,
                  py::arg("second_pass") = times.second_pass, py::arg("by_processor") = times.by_processor);
}

void bind_devices(py::module_& m) {
  m.def(
      "set_cuda_twins",
      [](const py::capsule& twins) { set_cuda_twins(static_cast<const CudaTwins*>(twins.get_pointer())); },
      py::arg("twins"), "Tell the library what the CUDA module offers.");
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
}

}  // namespace saddleback::bindings
