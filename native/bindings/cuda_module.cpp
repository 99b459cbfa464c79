// The optional module `_saddleback_cuda`: everything that needs CUDA, and nothing that works without.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "saddleback/cuda_devices.h"
#include "saddleback/cuda_twins.h"

#include "geodesics/device_arcs.h"
#include "geodesics/device_search.h"
#include "voronoi2d/device_voronoi.h"

namespace py = pybind11;

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
  static const saddleback::CudaTwins twins{.find_arcs = &saddleback::find_arcs_on_device,
                                           .find_voronoi = &saddleback::find_voronoi_on_device,
                                           .drop_voronoi = &saddleback::drop_voronoi_on_device,
                                           .copy_back = &saddleback::copy_back_from_device,
                                           .put_graph = &saddleback::put_graph_on_device,
                                           .drop_graph = &saddleback::drop_graph_on_device,
                                           .search = &saddleback::search_on_device};
  module.attr("twins") = py::capsule(&twins);
  module.def("cuda_devices", &saddleback::cuda_devices, py::call_guard<py::gil_scoped_release>());
}
