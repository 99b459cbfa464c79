// Voronoi diagrams that stay on a CUDA device, and how other libraries reach them.

#include <pybind11/stl.h>

#include "convert/devices.h"
#include "convert/dlpack.h"
#include "voronoi2d/device_voronoi_2d.h"

namespace saddleback::bindings {
namespace {

/// Sites in host memory, or on a device: what says so by `__cuda_array_interface__`.
struct SitesIn {
  ArrayIn<double> host;
  const double* data = nullptr;
  std::int64_t count = 0;
  bool are_there = false;
};

SitesIn as_sites_anywhere(const py::object& value) {
  SitesIn sites;
  if (!py::hasattr(value, "__cuda_array_interface__")) {
    sites.host = as_points2(value, "sites");
    sites.data = sites.host.values.data();
    sites.count = sites.host.count;
    return sites;
  }
  const py::dict described = value.attr("__cuda_array_interface__");
  const auto shape = described["shape"].cast<std::vector<std::int64_t>>();
  const auto type = described["typestr"].cast<std::string>();
  const bool is_packed = !described.contains("strides") || described["strides"].is_none();
  if (shape.size() != 2 || shape[1] != 2 || type != "<f8" || !is_packed) {
    throw InputError(message("sites: wanted an (n, 2) float64 array in row order on the device, got one of shape ",
                             py::str(described["shape"]).cast<std::string>(), " and type ", type));
  }
  const py::object address = described["data"].cast<py::tuple>()[0];
  if (!py::isinstance<py::int_>(address)) throw InputError("sites: their address on the device is not a number");
  sites.data = static_cast<const double*>(PyLong_AsVoidPtr(address.ptr()));
  if (PyErr_Occurred()) throw py::error_already_set();
  sites.count = shape[0];
  sites.are_there = true;
  return sites;
}

DeviceVoronoi2d find_on_device(const py::object& sites, const std::string& device, bool only_triangles,
                               const py::object& job) {
  const SitesIn in = as_sites_anywhere(sites);
  if (device == "cpu" || device == "auto")
    throw InputError(message("device: wanted 'cuda' or 'cuda:' and a number, got '", device, "'"));
  const std::vector<int> devices = cuda_devices_of(device, true);
  const DeviceVoronoi2dOptions options{devices.front(), only_triangles, in.are_there};
  const JobIn token(job);
  std::optional<DeviceVoronoi2d> found =
      without_gil([&] { return voronoi_2d_on_device(in.data, in.count, options, token); });
  if (!found) {
    throw DeviceError(
        "device: it is not made for such sites (fewer than three, all on a line or circle, or coordinates that are not "
        "finite or beyond 1e75); voronoi_2d takes them");
  }
  return std::move(*found);
}

py::tuple shape_of(const DeviceArray& array) {
  if (array.columns == 1) return py::make_tuple(array.rows);
  return py::make_tuple(array.rows, array.columns);
}

py::dict interface_of(const DeviceArray& array) {
  const auto address = reinterpret_cast<std::uintptr_t>(array.data);
  return py::dict(py::arg("shape") = shape_of(array), py::arg("typestr") = array.is_real ? "<f8" : "<i4",
                  py::arg("data") = py::make_tuple(address, false), py::arg("strides") = py::none(),
                  py::arg("stream") = py::none(), py::arg("version") = 3);
}

py::array in_host_memory(const DeviceArray& array) {
  const py::tuple shape = shape_of(array);
  const py::array copy(py::dtype(array.is_real ? "<f8" : "<i4"), shape.cast<std::vector<py::ssize_t>>());
  void* const to = copy.request(true).ptr;
  without_gil([&] { array.copy_to(to); });
  return copy;
}

constexpr const char* k_array_doc = R"(Numbers in a CUDA device's memory, complete: there is nothing to wait for.

CuPy, PyTorch, JAX, Numba and others take it as it is, without a copy, by `__cuda_array_interface__` or DLPack; it lives
as long as they hold it. Write to a copy only.)";

constexpr const char* k_doc = R"(Voronoi diagram of the plane that stays on the CUDA device that finds it.

Parameters
----------
sites : (n, 2) float array, or one on the device
    Whatever has `__cuda_array_interface__` (CuPy, PyTorch, Numba) is taken where it is: float64, in row order.
device : str
    "cuda", or "cuda:1" for the second one.
only_triangles : bool
    The Delaunay triangles and nothing else: less memory and less time.
job : Job, optional

Returns
-------
DeviceVoronoi2d

Raises
------
InputError
    Sites of another shape or type.
DeviceError
    No usable device, too little memory, sites that a device is not made for or that are on another device.
Cancelled
    The job was cancelled.

Notes
-----
The same numbers as voronoi_2d, to the bit. O(n log n) time, O(n) memory: about 360 bytes a site meanwhile, 144 then, 24
of triangles alone.)";

}  // namespace

void bind_device_voronoi_2d(py::module_& m) {
  py::class_<DeviceArray>(m, "DeviceArray", py::module_local(), k_array_doc)
      .def_property_readonly("shape", &shape_of, "Rows, and columns where there are several.")
      .def_property_readonly(
          "dtype", [](const DeviceArray& array) { return py::dtype(array.is_real ? "<f8" : "<i4"); },
          "float64 or int32.")
      .def_property_readonly("nbytes", &DeviceArray::nbytes)
      .def_property_readonly("__cuda_array_interface__", &interface_of)
      .def("__len__", [](const DeviceArray& array) { return array.rows; })
      .def(
          "__dlpack__", [](const DeviceArray& array, const py::args&, const py::kwargs&) { return dlpack_of(array); },
          "A capsule for from_dlpack. Whatever stream is named: the numbers are complete.")
      .def("__dlpack_device__", [](const DeviceArray& array) { return py::make_tuple(k_dlpack_cuda, array.device); })
      .def("numpy", &in_host_memory, "A copy in host memory.\n\nRaises\n------\nDeviceError\n    The device was lost.")
      .def("__repr__", [](const DeviceArray& array) {
        return message("<saddleback.DeviceArray of ", array.rows, " x ", array.columns,
                       array.is_real ? " float64" : " int32", " on cuda:", array.device, ">");
      });
  py::class_<DeviceVoronoi2d>(
      m, "DeviceVoronoi2d", py::module_local(),
      "A diagram on a CUDA device; made by `voronoi_2d_on_device`. Arrays as Voronoi2d has them.")
      .def_readonly("vertices", &DeviceVoronoi2d::vertices, "(V, 2) float64.")
      .def_readonly("edges", &DeviceVoronoi2d::edges, "(E, 2) int32 vertices; -1 at infinity.")
      .def_readonly("edge_sites", &DeviceVoronoi2d::edge_sites, "(E, 2) int32: the sites left and right of the edge.")
      .def_readonly("site_of", &DeviceVoronoi2d::site_of, "(n,) int32: smallest index of an equal site.")
      .def_readonly("cell_places", &DeviceVoronoi2d::cell_places, "(n,) int32: which cell is a site's.")
      .def_readonly("cell_sites", &DeviceVoronoi2d::cell_sites, "(C,) int32: whose a cell is.")
      .def_readonly("cell_offsets", &DeviceVoronoi2d::cell_offsets,
                    "(C + 1,) int32: cell i has the corners and sides [offsets[i], offsets[i + 1]).")
      .def_readonly("corner_vertices", &DeviceVoronoi2d::corner_vertices,
                    "(2 E,) int32 vertices of the cells, counter-clockwise; -1 where a cell is open.")
      .def_readonly("side_edges", &DeviceVoronoi2d::side_edges, "(2 E,) int32: the edge before each corner.")
      .def_readonly("triangles", &DeviceVoronoi2d::triangles,
                    "(T, 3) int32 sites, as Voronoi2d.delaunay; none unless only_triangles.")
      .def_property_readonly(
          "device_times", [](const DeviceVoronoi2d& d) { return as_dict(d.times); },
          "Seconds of the parts by the device's clock.");
  m.def("voronoi_2d_on_device", &find_on_device, py::arg("sites"), py::kw_only(), py::arg("device") = "cuda",
        py::arg("only_triangles") = false, py::arg("job") = py::none(), k_doc);
}

}  // namespace saddleback::bindings
