#pragma once
// numpy in and out. Every argument arrives as a py::object, so that what is wrong with it can be said by its name;
// results leave without a copy.

#include <memory>
#include <optional>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "saddleback/error.h"
#include "saddleback/job.h"
#include "saddleback/types.h"

#include "convert/interrupt.h"

namespace saddleback::bindings {

namespace py = pybind11;

/// A C-contiguous array and the view of it; keep it alive while the view is used. When the caller's array already had
/// the right type and layout this is the caller's memory: copy what another thread must not change under you.
template <class T>
struct ArrayIn {
  py::array_t<T, py::array::c_style> array;
  std::span<const T> values;  ///< flat
  Index count = 0;            ///< rows
};

// Each throws InputError "NAME: wanted ..., got ...". Reals are any float or integer type; indices any integer type,
// and every value must fit 32 bits.
py::array as_array(const py::object& value, const char* name, const std::string& wanted);  ///< of any shape and type
ArrayIn<double> as_points3(const py::object& value, const char* name);                     ///< (n, 3) reals
ArrayIn<double> as_points(const py::object& value, const char* name);                      ///< (n, d) reals, d >= 2
/// (face_count, 3) or (n,) reals, flat.
ArrayIn<double> as_sides(const py::object& value, const char* name, Index face_count);
ArrayIn<double> as_points2(const py::object& value, const char* name);                          ///< (n, 2) reals
ArrayIn<double> as_reals(const py::object& value, const char* name);                            ///< (n,) reals
ArrayIn<double> as_reals(const py::object& value, const char* name, Index count);               ///< (count,) reals
ArrayIn<double> as_rows(const py::object& value, const char* name, const std::string& wanted);  ///< (n, k) reals
std::vector<std::uint8_t> as_flags(const py::object& value, const char* name);  ///< (n,) booleans, or 0 and 1
ArrayIn<Index> as_indices(const py::object& value, const char* name);           ///< (n,) integers
ArrayIn<Index> as_edges(const py::object& value, const char* name);             ///< (n, 2) integers
ArrayIn<Index> as_triangles(const py::object& value, const char* name);         ///< (n, 3) integers
Vec3 as_vec3(const py::object& value, const char* name);                        ///< three reals

double as_real(const py::object& value, const char* name);    ///< a float or int, numpy's too
Index as_integer(const py::object& value, const char* name);  ///< an int (not a float), numpy's too
/// Works as as_integer, for seeds: 0 to 2^64 - 1.
std::uint64_t as_seed(const py::object& value, const char* name);
/// Converts a str, bytes or os.PathLike to the bytes that the operating system knows the file by.
std::string as_path(const py::object& value, const char* name);
/// A saddleback.Job. Calls take their argument `job` as a JobIn instead.
Job* as_job(const py::object& value);
/// Tells whether the array-like's elements, if any, are integers: vertex indices where points are taken.
bool holds_integers(const py::object& value, const char* name);

/// The result as a Python object that keeps another one alive. Not py::keep_alive<0, ...>, which pybind11 3.1 also
/// applies where it has refused the arguments, to a result that is no object.
template <class T>
py::object keeping(const py::handle& kept, T&& result) {
  py::object object = py::cast(std::forward<T>(result));
  py::detail::keep_alive_impl(object, kept);
  return object;
}

/// numpy array that owns the moved vector.
template <class T>
py::array_t<T> to_array(std::vector<T>&& values) {
  auto owned = std::make_unique<std::vector<T>>(std::move(values));
  std::vector<T>* const vector = owned.get();
  const py::capsule owner(vector, [](void* p) { delete static_cast<std::vector<T>*>(p); });
  owned.release();
  return py::array_t<T>(static_cast<py::ssize_t>(vector->size()), vector->data(), owner);
}

/// (n, N) numpy array that owns the moved vector of N-component rows: Vec3, Vec2, Triangle.
template <class Scalar, class Row>
py::array_t<Scalar> to_rows(std::vector<Row>&& rows) {
  static_assert(sizeof(Row) % sizeof(Scalar) == 0);
  auto owned = std::make_unique<std::vector<Row>>(std::move(rows));
  std::vector<Row>* const vector = owned.get();
  const py::capsule owner(vector, [](void* p) { delete static_cast<std::vector<Row>*>(p); });
  owned.release();
  const std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(vector->size()),
                                       static_cast<py::ssize_t>(sizeof(Row) / sizeof(Scalar))};
  return py::array_t<Scalar>(shape, reinterpret_cast<const Scalar*>(vector->data()), owner);
}
inline py::array_t<double> to_array(std::vector<Vec3>&& rows) { return to_rows<double>(std::move(rows)); }
inline py::array_t<double> to_array(std::vector<Vec2>&& rows) { return to_rows<double>(std::move(rows)); }
inline py::array_t<Index> to_array(std::vector<Triangle>&& rows) { return to_rows<Index>(std::move(rows)); }

/// Forbids writing: for views of immutable objects.
py::array read_only(py::array array);

/// Read-only view of memory that `owner` (the Python object) keeps alive. Shape (n,) or, for rows, (n, N).
template <class T>
py::array view_of(std::span<const T> values, const py::object& owner) {
  return read_only(py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data(), owner));
}
template <class Scalar, class Row>
py::array view_of_rows(std::span<const Row> rows, const py::object& owner) {
  const std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(rows.size()),
                                       static_cast<py::ssize_t>(sizeof(Row) / sizeof(Scalar))};
  return read_only(py::array_t<Scalar>(shape, reinterpret_cast<const Scalar*>(rows.data()), owner));
}
inline py::array view_of(std::span<const Vec3> rows, const py::object& owner) {
  return view_of_rows<double>(rows, owner);
}
inline py::array view_of(std::span<const Triangle> rows, const py::object& owner) {
  return view_of_rows<Index>(rows, owner);
}

/// Calls `work` without the GIL; it must not touch Python.
template <class Work>
auto without_gil(Work&& work) {
  struct Unlocked {
    PyThreadState* state = PyEval_SaveThread();
    ~Unlocked() { lock_python_again(state); }
  } const unlocked;
  return work();
}

}  // namespace saddleback::bindings
