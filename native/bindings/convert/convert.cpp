#include "convert/convert.h"

#include <cstdint>
#include <limits>

namespace saddleback::bindings {
namespace {

std::string shape_of(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t i = 0; i < array.ndim(); ++i) text += (i ? ", " : "") + std::to_string(array.shape(i));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

std::string type_of(const py::handle& value) { return py::cast<std::string>(py::type::of(value).attr("__name__")); }

// wanted: what the caller should have given, "shape (n, 3) of real numbers".
[[noreturn]] void refuse(const char* name, const std::string& wanted, const std::string& got) {
  throw InputError(message(name, ": wanted ", wanted, ", got ", got));
}

/// Tells whether some of a numpy masked array's elements are masked: numbers behind the mask are none of the caller's.
bool has_masked(const py::object& value) {
  return py::isinstance<py::array>(value) && py::hasattr(value, "mask") &&
         py::cast<bool>(value.attr("mask").attr("any")());
}

// columns: 0 for a flat array, else the number that each row must have. An empty list has no columns to show: it
// passes.
py::array shaped(const py::object& value, const char* name, py::ssize_t columns, const std::string& wanted) {
  py::array array = as_array(value, name, wanted);
  if (columns > 0 && array.ndim() == 1 && array.size() == 0) return array.reshape({py::ssize_t{0}, columns});
  const bool fits = columns == 0 ? array.ndim() == 1 : array.ndim() == 2 && array.shape(1) == columns;
  if (!fits) refuse(name, wanted, shape_of(array));
  return array;
}

std::string dtype_name(const py::array& array) { return py::cast<std::string>(py::str(array.dtype())); }

Index row_count(const py::array& array, const char* name) {
  const py::ssize_t rows = array.shape(0);
  if (rows >= std::numeric_limits<Index>::max())
    throw InputError(
        message(name, ": ", rows, " rows are too many; 32-bit indices allow ", std::numeric_limits<Index>::max() - 1));
  return static_cast<Index>(rows);
}

ArrayIn<double> reals(const py::object& value, const char* name, py::ssize_t columns, const std::string& wanted) {
  const py::array array = shaped(value, name, columns, wanted);
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u') refuse(name, wanted, "type " + dtype_name(array));
  ArrayIn<double> result;
  result.array = py::array_t<double, py::array::c_style | py::array::forcecast>(array);
  result.count = row_count(array, name);
  result.values = std::span(result.array.data(), static_cast<std::size_t>(result.array.size()));
  return result;
}

template <class Wide>
void check_range(const py::array& array, const char* name, py::ssize_t columns) {
  const py::array_t<Wide, py::array::c_style | py::array::forcecast> wide(array);
  const Wide* const values = wide.data();
  for (py::ssize_t i = 0; i < wide.size(); ++i) {
    if (std::in_range<Index>(values[i])) continue;
    const std::string place = columns ? message(i / columns, ", ", i % columns) : message(i);
    throw InputError(message(name, ": value ", values[i], " at [", place, "] does not fit a 32-bit index"));
  }
}

ArrayIn<Index> integers(const py::object& value, const char* name, py::ssize_t columns, const std::string& wanted) {
  py::array array = shaped(value, name, columns, wanted);
  const char kind = array.dtype().kind();
  if (array.size() > 0 && kind != 'i' && kind != 'u') refuse(name, wanted, "type " + dtype_name(array));
  if (kind == 'u' && array.itemsize() >= 4) check_range<std::uint64_t>(array, name, columns);
  if (kind == 'i' && array.itemsize() > 4) check_range<std::int64_t>(array, name, columns);
  ArrayIn<Index> result;
  result.array = py::array_t<Index, py::array::c_style | py::array::forcecast>(array);
  if (result.array.data() == array.data())  // the caller's memory: another thread may write once they are checked
    result.array = py::array_t<Index, py::array::c_style>(result.array.request());
  result.count = row_count(array, name);
  result.values = std::span(result.array.data(), static_cast<std::size_t>(result.array.size()));
  return result;
}

// A numpy scalar or a Python number; refuses bool, which is an int only by inheritance.
py::object whole_number(const py::object& value, const char* name) {
  if (py::isinstance<py::bool_>(value) || !PyIndex_Check(value.ptr()))
    refuse(name, "an integer", "a " + type_of(value));
  PyObject* const number = PyNumber_Index(value.ptr());
  if (!number) {
    PyErr_Clear();
    refuse(name, "an integer", "a " + type_of(value));
  }
  return py::reinterpret_steal<py::object>(number);
}

}  // namespace

py::array as_array(const py::object& value, const char* name, const std::string& wanted) {
  if (has_masked(value)) refuse(name, wanted, "masked elements");
  if (value.is_none() || py::isinstance<py::str>(value) || py::isinstance<py::dict>(value))
    refuse(name, wanted, value.is_none() ? "None" : "a " + type_of(value));
  try {
    return py::array::ensure(py::module_::import("numpy").attr("asarray")(value));
  } catch (py::error_already_set& error) {
    if (error.matches(PyExc_KeyboardInterrupt) || error.matches(PyExc_MemoryError)) throw;
    refuse(name, wanted, "a " + type_of(value) + " that numpy makes no array of");
  }
}

ArrayIn<double> as_points3(const py::object& value, const char* name) {
  return reals(value, name, 3, "shape (n, 3) of real numbers");
}

ArrayIn<double> as_points(const py::object& value, const char* name) {
  const std::string wanted = "shape (n, d) of real numbers, d at least 2";
  const py::array array = as_array(value, name, wanted);
  if (array.ndim() == 1 && array.size() == 0) return as_points3(array, name);
  if (array.ndim() != 2 || array.shape(1) < 2) refuse(name, wanted, shape_of(array));
  return reals(array, name, array.shape(1), wanted);
}

ArrayIn<double> as_sides(const py::object& value, const char* name, Index face_count) {
  const std::string wanted = message("shape (", face_count, ", 3) or (edges,) of real numbers");
  const py::array array = as_array(value, name, wanted);
  if (array.ndim() != 2) return reals(array, name, 0, wanted);
  ArrayIn<double> result = reals(array, name, 3, wanted);
  if (result.count != face_count) refuse(name, wanted, shape_of(array));
  return result;
}

ArrayIn<double> as_points2(const py::object& value, const char* name) {
  return reals(value, name, 2, "shape (n, 2) of real numbers");
}

ArrayIn<double> as_reals(const py::object& value, const char* name) {
  return reals(value, name, 0, "shape (n,) of real numbers");
}

ArrayIn<double> as_reals(const py::object& value, const char* name, Index count) {
  const std::string wanted = message("shape (", count, ",) of real numbers");
  ArrayIn<double> result = reals(value, name, 0, wanted);
  if (result.count != count) refuse(name, wanted, shape_of(result.array));
  return result;
}

ArrayIn<double> as_rows(const py::object& value, const char* name, const std::string& wanted) {
  const py::array array = as_array(value, name, wanted);
  if (array.ndim() != 2) refuse(name, wanted, shape_of(array));
  if (array.size() == 0)
    return {py::array_t<double, py::array::c_style>({array.shape(0), array.shape(1)}), {}, row_count(array, name)};
  return reals(array, name, array.shape(1), wanted);
}

std::vector<std::uint8_t> as_flags(const py::object& value, const char* name) {
  const std::string wanted = "shape (n,) of booleans";
  const py::array array = shaped(value, name, 0, wanted);
  if (array.dtype().kind() == 'b') {
    const py::array_t<bool, py::array::c_style | py::array::forcecast> flags(array);
    return {flags.data(), flags.data() + flags.size()};
  }
  const ArrayIn<Index> numbers = integers(array, name, 0, wanted);
  std::vector<std::uint8_t> result;
  for (const Index number : numbers.values) {
    if (number != 0 && number != 1) refuse(name, wanted, message("the number ", number));
    result.push_back(static_cast<std::uint8_t>(number));
  }
  return result;
}

ArrayIn<Index> as_indices(const py::object& value, const char* name) {
  return integers(value, name, 0, "shape (n,) of integers");
}

ArrayIn<Index> as_edges(const py::object& value, const char* name) {
  return integers(value, name, 2, "shape (n, 2) of integers");
}

ArrayIn<Index> as_triangles(const py::object& value, const char* name) {
  return integers(value, name, 3, "shape (n, 3) of integers");
}

Vec3 as_vec3(const py::object& value, const char* name) {
  const char* const wanted = "shape (3,) of real numbers";
  const ArrayIn<double> result = reals(value, name, 0, wanted);
  if (result.count != 3) refuse(name, wanted, shape_of(result.array));
  return Vec3(result.values[0], result.values[1], result.values[2]);
}

double as_real(const py::object& value, const char* name) {
  const bool is_number =
      PyFloat_Check(value.ptr()) || PyIndex_Check(value.ptr()) ||
      (PyNumber_Check(value.ptr()) && py::hasattr(value, "__float__") && !py::hasattr(value, "__len__"));
  const auto kind = py::cast<std::string>(py::getattr(py::getattr(value, "dtype", py::none()), "kind", py::str()));
  if (py::isinstance<py::bool_>(value) || kind == "b" || kind == "c" || !is_number)  // "c": would lose a part
    refuse(name, "a real number", "a " + type_of(value));
  const double number = PyFloat_AsDouble(value.ptr());
  if (number == -1.0 && PyErr_Occurred()) {
    PyErr_Clear();
    refuse(name, "a real number", "a " + type_of(value));
  }
  return number;
}

Index as_integer(const py::object& value, const char* name) {
  const py::object number = whole_number(value, name);
  int overflow = 0;
  const long long wide = PyLong_AsLongLongAndOverflow(number.ptr(), &overflow);
  if (overflow || !std::in_range<Index>(wide))
    throw InputError(message(name, ": ", py::cast<std::string>(py::str(number)), " does not fit 32 bits"));
  return static_cast<Index>(wide);
}

std::uint64_t as_seed(const py::object& value, const char* name) {
  const py::object number = whole_number(value, name);
  const unsigned long long wide = PyLong_AsUnsignedLongLong(number.ptr());
  if (PyErr_Occurred()) {
    PyErr_Clear();
    throw InputError(message(name, ": ", py::cast<std::string>(py::str(number)), " is not within 0 to 2**64 - 1"));
  }
  return wide;
}

std::string as_path(const py::object& value, const char* name) {
  try {
    std::string path = py::cast<std::string>(py::module_::import("os").attr("fsencode")(value));
    if (path.find('\0') != path.npos) refuse(name, "a file's name", "one with a zero in it");
    return path;
  } catch (py::error_already_set& error) {
    if (!error.matches(PyExc_TypeError) && !error.matches(PyExc_ValueError)) throw;
    refuse(name, "a str or os.PathLike", "a " + type_of(value));
  }
}

Job* as_job(const py::object& value) {
  if (!py::isinstance<Job>(value)) refuse("job", "a saddleback.Job or None", "a " + type_of(value));
  return py::cast<Job*>(value);
}

bool holds_integers(const py::object& value, const char* name) {
  const py::array array = as_array(value, name, "vertex indices or a SurfacePoints");
  const char kind = array.dtype().kind();
  return kind == 'i' || kind == 'u' || array.size() == 0;
}

py::array read_only(py::array array) {
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

}  // namespace saddleback::bindings
