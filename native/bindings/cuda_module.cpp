// The optional module `_saddleback_cuda`: everything that needs CUDA, and nothing that works without.

#include "support/cuda/cuda_module.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <stdexcept>

#include "geodesics/cuda/device_arcs.h"
#include "geodesics/cuda/device_search.h"
#include "support/cuda/cuda_devices.h"
#include "support/cuda/host_pinning.h"
#include "voronoi2d/cuda/device_signs.h"
#include "voronoi2d/cuda/device_voronoi.h"

namespace py = pybind11;

namespace {

using Points = py::array_t<double, py::array::c_style | py::array::forcecast>;

py::array_t<std::int8_t> plane_signs(const Points& points, int device) {
  if (points.ndim() != 3 || points.shape(1) != 4 || points.shape(2) != 2)
    throw py::value_error("points: wanted an (n, 4, 2) array");
  using saddleback::PlaneSigns;
  const auto fours = static_cast<std::size_t>(points.shape(0));
  py::array_t<std::int8_t> signs({points.shape(0), py::ssize_t{PlaneSigns::k_count}});
  static_assert(sizeof(PlaneSigns) == PlaneSigns::k_count);
  saddleback::CudaReason reason;
  if (saddleback::plane_signs_on_device(device, points.data(), fours,
                                        reinterpret_cast<PlaneSigns*>(signs.mutable_data()),
                                        reason) != saddleback::CudaStatus::done)
    throw std::runtime_error(reason.text);
  return signs;
}

}  // namespace

PYBIND11_MODULE(_saddleback_cuda, module) {
  using saddleback::CudaDevice;
  using saddleback::CudaDevices;
  module.attr("__version__") = SADDLEBACK_VERSION;

  py::class_<CudaDevice>(module, "CudaDevice", py::module_local())
      .def_readonly("index", &CudaDevice::index)
      .def_readonly("name", &CudaDevice::name)
      .def_readonly("memory", &CudaDevice::memory)
      .def_readonly("compute_major", &CudaDevice::compute_major)
      .def_readonly("compute_minor", &CudaDevice::compute_minor);
  py::class_<CudaDevices>(module, "CudaDevices", py::module_local())
      .def_readonly("usable", &CudaDevices::usable)
      .def_readonly("reason", &CudaDevices::reason);
  static const saddleback::CudaModule functions{.find_arcs = &saddleback::find_arcs_on_device,
                                                .find_voronoi = &saddleback::find_voronoi_on_device,
                                                .drop_voronoi = &saddleback::drop_voronoi_on_device,
                                                .copy_back = &saddleback::copy_back_from_device,
                                                .pin = &saddleback::pin_host_memory,
                                                .unpin = &saddleback::unpin_host_memory,
                                                .put_graph = &saddleback::put_graph_on_device,
                                                .drop_graph = &saddleback::drop_graph_on_device,
                                                .search = &saddleback::search_on_device};
  module.attr("functions") = py::capsule(&functions);
  module.def("cuda_devices", &saddleback::cuda_devices, py::call_guard<py::gil_scoped_release>());
  module.def("plane_signs", &plane_signs, py::arg("points"), py::arg("device") = 0,
             R"(Returns what a device decides about each four points; for tests.

Parameters
----------
points : (n, 4, 2) float array
    Corners of a triangle a, b, c and another point d. Any unit.
device : int
    The driver's number of it.

Returns
-------
(n, 5) int8 array of -1, 0 and 1: `orient_2d(a, b, c)` and whether a is nearer to b than to c (-1); as diagrams ask for
them the first, `in_circle(a, b, c, d)`, which may be unknown, 2, and the second.

Raises
------
ValueError
    `points` has another shape.
RuntimeError
    The device cannot be used.)");
}
