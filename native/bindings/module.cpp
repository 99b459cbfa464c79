// The module's doorway: errors, then one bind_* per public header.

#include <string_view>
#include <utility>

#include "saddleback/error.h"

#include "convert/convert.h"
#include "convert/interrupt.h"

namespace saddleback::bindings {

void bind_bake_cells(py::module_& m);
void bind_barriers(py::module_& m);
void bind_cell_polygons(py::module_& m);
void bind_charts(py::module_& m);
void bind_check(py::module_& m);
void bind_devices(py::module_& m);
void bind_distribution(py::module_& m);
void bind_exact(py::module_& m);
void bind_fields(py::module_& m);
void bind_job(py::module_& m);
void bind_mesh(py::module_& m);
void bind_paths(py::module_& m);
void bind_placements(py::module_& m);
void bind_predicates(py::module_& m);
void bind_write_file(py::module_& m);
void bind_read_mesh(py::module_& m);
void bind_periodic_voronoi_2d(py::module_& m);
void bind_relax_2d(py::module_& m);
void bind_hausdorff_distance(py::module_& m);
void bind_repair(py::module_& m);
void bind_safe_distance(py::module_& m);
void bind_shape_maps(py::module_& m);
void bind_shapes(py::module_& m);
void bind_states(py::module_& m);
void bind_stepped_sweep(py::module_& m);
void bind_stroke_map(py::module_& m);
void bind_surface(py::module_& m);
void bind_graph(py::module_& m);
void bind_graph_parts(py::module_& m);
void bind_relaxation(py::module_& m);
void bind_tessellation(py::module_& m);
void bind_dual_mesh(py::module_& m);
void bind_triangle_arrays(py::module_& m);
void bind_device_voronoi_2d(py::module_& m);
void bind_voronoi_2d(py::module_& m);

namespace {

// The error types, kept for the life of the process: errors may be thrown until its end.
struct ErrorTypes {
  PyObject *root, *mesh, *input, *version, *cancelled, *device;
};
ErrorTypes error_types;

// A message may hold the bytes of a file name, which need not be UTF-8.
void raise(PyObject* type, const std::exception& error) {
  const std::string_view text = error.what();
  PyObject* const decoded = PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "backslashreplace");
  if (!decoded) return;
  PyErr_SetObject(type, decoded);
  Py_DECREF(decoded);
}

void translate(std::exception_ptr error) {
  try {
    std::rethrow_exception(std::move(error));
  } catch (const MeshError& e) {
    raise(error_types.mesh, e);
  } catch (const VersionError& e) {
    raise(error_types.version, e);
  } catch (const InputError& e) {
    raise(error_types.input, e);
  } catch (const Cancelled& e) {
    if (PyErr_CheckSignals() != 0) return;  // it was Ctrl-C: KeyboardInterrupt, or what the program's handler raises
    raise(error_types.cancelled, e);
  } catch (const DeviceError& e) {
    raise(error_types.device, e);
  } catch (const Error& e) {
    raise(error_types.root, e);
  }
}

PyObject* bind_error(py::module_& m, const char* name, const py::object& bases, const char* doc) {
  PyObject* const type =
      PyErr_NewExceptionWithDoc((std::string("saddleback.") + name).c_str(), doc, bases.ptr(), nullptr);
  if (!type) throw py::error_already_set();
  m.attr(name) = py::handle(type);
  return type;
}

// Translated for this module alone, so that a second copy of it in one process (an installed add-on beside a build
// folder) raises its own.
void bind_errors(py::module_& m) {
  const auto borrowed = [](PyObject* object) { return py::reinterpret_borrow<py::object>(object); };
  error_types.root = bind_error(m, "Error", borrowed(PyExc_Exception), "Root of all errors of this library.");
  const py::object root = borrowed(error_types.root);
  const py::tuple bad_value = py::make_tuple(root, borrowed(PyExc_ValueError));
  error_types.mesh = bind_error(m, "MeshError", bad_value, "The mesh cannot be used as it is; `repair` may help.");
  error_types.input = bind_error(m, "InputError", bad_value, "An argument is wrong; the message names it.");
  error_types.version = bind_error(m, "VersionError", borrowed(error_types.input),
                                   "A newer version of this library wrote the file; nothing is wrong with it.");
  error_types.cancelled = bind_error(m, "Cancelled", root, "The job was cancelled.");
  error_types.device = bind_error(m, "DeviceError", root, "The wanted device cannot be used.");
  py::register_local_exception_translator(&translate);
}

PyObject* refuse_to_make(PyTypeObject* type, PyObject*, PyObject*) {
  return PyErr_Format(PyExc_TypeError, "a %s is made by the calls that return one", type->tp_name);
}

/// Returns what to do instead with an object that stays where it was made.
std::string_view instead_of_copying(const std::string& type) {
  constexpr std::pair<std::string_view, std::string_view> k_advice[] = {
      {"Job", "it belongs to the calls that it was given to; make another one there"},
      {"ExactField", "send its mesh and sources, and make it again there"},
      {"SafeDistanceTable", "send its two shapes, and make it again there"},
      {"SweepCircle", "it is still going on; send its sites and center, and grow another one to the same radius"},
      {"SweepCircles", "they are still going on; send their sites and centers, and grow others to the same radius"},
      {"DirectionFieldEditor", "send its mesh, and make another one there"},
      {"CellCache", "it is for calls in this process; make an empty one there"},
      {"RelaxationWatch", "it is for calls in this process; make another one there"},
      {"DeviceArray", "it lies in a device's memory; send what numpy() gives"},
      {"DeviceVoronoi2d", "it lies in a device's memory; send what numpy() of its arrays gives"},
  };
  for (const auto& [name, advice] : k_advice)
    if (name == type) return advice;
  return "send what it was made from, and make it again there";
}

// An object that C++ never made holds whatever was in its memory before. The oldest pickle protocols and Class.__new__
// would make such objects: they are refused, by classes that nobody constructs altogether.
void refuse_empty_objects(const py::module_& m) {
  for (const auto& [name, value] : py::reinterpret_borrow<py::dict>(m.attr("__dict__"))) {
    if (!PyType_Check(value.ptr()) || PyExceptionClass_Check(value.ptr())) continue;
    const py::object own = value.attr("__dict__");
    const bool is_constructed = own.contains("__init__") && PyInstanceMethod_Check(py::object(own["__init__"]).ptr());
    if (!is_constructed) reinterpret_cast<PyTypeObject*>(value.ptr())->tp_new = refuse_to_make;
    if (own.contains("__reduce__") || own.contains("_state")) continue;
    const auto refuse = [](const py::object& self) -> py::object {
      const auto type = py::cast<std::string>(py::type::of(self).attr("__name__"));
      throw py::type_error(message("cannot pickle or copy a saddleback.", type, ": ", instead_of_copying(type)));
    };
    py::setattr(value, "__reduce__", py::cpp_function(refuse, py::is_method(value), py::name("__reduce__")));
  }
}

}  // namespace
}  // namespace saddleback::bindings

PYBIND11_MODULE(_saddleback, m) {
  using namespace saddleback::bindings;
  m.doc() = "Compiled part of saddleback; import saddleback instead.";
  m.attr("__version__") = SADDLEBACK_VERSION;
  prepare_interrupts();
  bind_errors(m);
  bind_job(m);
  bind_mesh(m);
  bind_predicates(m);
  bind_write_file(m);
  bind_read_mesh(m);
  bind_repair(m);
  bind_stepped_sweep(m);
  bind_surface(m);
  bind_barriers(m);
  bind_exact(m);
  bind_graph(m);
  bind_graph_parts(m);
  bind_paths(m);
  bind_cell_polygons(m);
  bind_dual_mesh(m);
  bind_triangle_arrays(m);
  bind_hausdorff_distance(m);
  bind_fields(m);
  bind_tessellation(m);
  bind_bake_cells(m);
  bind_relaxation(m);
  bind_device_voronoi_2d(m);
  bind_voronoi_2d(m);
  bind_devices(m);
  bind_charts(m);
  bind_stroke_map(m);
  bind_periodic_voronoi_2d(m);
  bind_relax_2d(m);
  bind_shapes(m);
  bind_placements(m);
  bind_safe_distance(m);
  bind_shape_maps(m);
  bind_check(m);
  bind_distribution(m);
  bind_states(m);
  refuse_empty_objects(m);
}
