// SafeDistanceTable.

#include "saddleback/distribution/safe_distance.h"

#include "convert/shapes.h"

namespace saddleback::bindings {
namespace {

constexpr const char* k_table_doc =
    R"(Distances from which on two shapes in the plane are certainly apart, at any angles and scales.

Two shapes slid together from afar first meet where their fronts do. The table keeps fronts over whole ranges of angles (720
to a turn) and strips (256 to a shape), so that what it tells can only be too large: by about one percent, by up to
8.4 % for needles.

Args:
    a, b: Shapes.
    threads: 0 for all cores; never changes the result.
    job: progress and cancellation.

Raises:
    InputError: anything but Shapes.
    Cancelled: the job was.

Notes:
    Some 20 ms of one core and 2.5 MB; a multiple with thousands of corners.
)";

constexpr const char* k_distance_doc = R"(A distance between the centers from which on the shapes have no common point.

Args:
    alpha: where the center of b is, seen in the plane of a: angle from a's x axis, radians.
    beta: where the center of a is, seen in the plane of b.
    scale_a, scale_b: lengths of one unit of the shapes' planes, > 0.

Returns:
    float, or (n,) float64 where any argument is (n,).

Raises:
    InputError: angles that are not finite, scales that are not positive, lengths that differ.

Notes:
    O(1) at equal scales, else O(strips).
)";

/// One value or one for each of several.
struct Column {
  ArrayIn<double> array;
  double at(Index i) const { return array.values[array.count == 1 ? 0 : i]; }
};

Column as_column(const py::object& value, const char* name, Index& count, bool& is_single) {
  if (py::isinstance<py::float_>(value) || py::isinstance<py::int_>(value) || py::len_hint(value) == 0) {
    const double single = as_real(value, name);
    return {as_reals(py::make_tuple(single), name)};
  }
  Column column{as_reals(value, name)};
  is_single = false;
  if (count != 1 && column.array.count != count && column.array.count != 1)
    throw InputError(message(name, " has ", column.array.count, " values, wanted ", count));
  if (column.array.count != 1) count = column.array.count;
  return column;
}

py::object distance_of(const SafeDistanceTable& table, const py::object& alpha, const py::object& beta,
                       const py::object& scale_a, const py::object& scale_b) {
  Index count = 1;
  bool is_single = true;
  const Column alphas = as_column(alpha, "alpha", count, is_single), betas = as_column(beta, "beta", count, is_single),
               scales_a = as_column(scale_a, "scale_a", count, is_single),
               scales_b = as_column(scale_b, "scale_b", count, is_single);
  std::vector<double> result(static_cast<std::size_t>(count));
  without_gil([&] {
    for (Index i = 0; i < count; ++i)
      result[i] = table.distance(alphas.at(i), betas.at(i), scales_a.at(i), scales_b.at(i));
  });
  if (is_single) return py::float_(result[0]);
  return to_array(std::move(result));
}

}  // namespace

void bind_safe_distance(py::module_& m) {
  py::class_<SafeDistanceTable>(m, "SafeDistanceTable", py::module_local(), k_table_doc)
      .def(py::init([](const py::object& a, const py::object& b, const py::object& threads, const py::object& job) {
             const Shape first = as_shape(a, "a"), second = as_shape(b, "b");
             const int team = as_integer(threads, "threads");
             const JobIn token(job);
             return without_gil([&] { return std::make_unique<SafeDistanceTable>(first, second, team, token); });
           }),
           py::arg("a"), py::arg("b"), py::kw_only(), py::arg("threads") = 0, py::arg("job") = py::none())
      .def("distance", &distance_of, py::arg("alpha"), py::arg("beta"), py::arg("scale_a") = 1.0,
           py::arg("scale_b") = 1.0, k_distance_doc)
      .def_property_readonly("nbytes", &SafeDistanceTable::byte_count, "Memory of the table and its fronts.");
}

}  // namespace saddleback::bindings
