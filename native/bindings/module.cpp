// The module's doorway: errors, then one bind_* per public header.

#include "convert.h"

namespace saddleback::bindings {

void bind_job(py::module_& m);
void bind_mesh(py::module_& m);
void bind_read_mesh(py::module_& m);
void bind_repair(py::module_& m);
void bind_surface(py::module_& m);
void bind_graph(py::module_& m);
void bind_tessellation(py::module_& m);

namespace {

// Registered for this module alone, so that a second copy of it in one process (an installed add-on beside a build
// folder) raises its own. The last registered is tried first: roots come before what derives from them.
template <class CppError>
py::object bind_error(py::module_& m, const char* name, const py::object& bases, const char* doc) {
  py::register_local_exception<CppError>(m, name, bases);
  py::object type = m.attr(name);
  type.attr("__module__") = "saddleback";
  type.attr("__doc__") = doc;
  return type;
}

void bind_errors(py::module_& m) {
  const auto exception = py::reinterpret_borrow<py::object>(PyExc_Exception);
  const auto value_error = py::reinterpret_borrow<py::object>(PyExc_ValueError);
  const py::object error = bind_error<Error>(m, "Error", exception, "Root of all errors of this library.");
  const py::tuple bad_value = py::make_tuple(error, value_error);
  bind_error<MeshError>(m, "MeshError", bad_value, "The mesh cannot be used as it is; `repair` may help.");
  bind_error<InputError>(m, "InputError", bad_value, "An argument is wrong; the message names it.");
  bind_error<Cancelled>(m, "Cancelled", error, "The job was cancelled.");
  bind_error<DeviceError>(m, "DeviceError", error, "The wanted device cannot be used.");
}

}  // namespace
}  // namespace saddleback::bindings

PYBIND11_MODULE(_saddleback, m) {
  using namespace saddleback::bindings;
  m.doc() = "Compiled part of saddleback; import saddleback instead.";
  m.attr("__version__") = SADDLEBACK_VERSION;
  bind_errors(m);
  bind_job(m);
  bind_mesh(m);
  bind_read_mesh(m);
  bind_repair(m);
  bind_surface(m);
  bind_graph(m);
  bind_tessellation(m);
}
