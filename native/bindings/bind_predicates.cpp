// The predicates, for tests only: they are no part of the Python API.

#include "convert/convert.h"
#include "predicates/predicates.h"
#include "support/hypotenuse.h"

namespace saddleback::bindings {
namespace {

using predicates::Point2;

Point2 row2(const ArrayIn<double>& points, Index i) { return {points.values[2 * i], points.values[2 * i + 1]}; }
Vec3 row3(const ArrayIn<double>& points, Index i) {
  return Vec3(points.values[3 * i], points.values[3 * i + 1], points.values[3 * i + 2]);
}

template <class... Rest>
void check_counts(const ArrayIn<double>& first, const Rest&... rest) {
  if (((rest.count != first.count) || ...)) throw InputError("points: wanted arrays of equal length");
}

py::array orient_2d(const py::object& a, const py::object& b, const py::object& c) {
  const ArrayIn<double> p = as_points2(a, "a"), q = as_points2(b, "b"), r = as_points2(c, "c");
  check_counts(p, q, r);
  std::vector<Index> signs;
  for (Index i = 0; i < p.count; ++i)
    signs.push_back(static_cast<Index>(predicates::orient_2d(row2(p, i), row2(q, i), row2(r, i))));
  return to_array(std::move(signs));
}

py::array in_circle(const py::object& a, const py::object& b, const py::object& c, const py::object& d) {
  const ArrayIn<double> p = as_points2(a, "a"), q = as_points2(b, "b"), r = as_points2(c, "c"), s = as_points2(d, "d");
  check_counts(p, q, r, s);
  std::vector<Index> signs;
  for (Index i = 0; i < p.count; ++i)
    signs.push_back(static_cast<Index>(predicates::in_circle(row2(p, i), row2(q, i), row2(r, i), row2(s, i))));
  return to_array(std::move(signs));
}

py::array collinear_3d(const py::object& a, const py::object& b, const py::object& c) {
  const ArrayIn<double> p = as_points3(a, "a"), q = as_points3(b, "b"), r = as_points3(c, "c");
  check_counts(p, q, r);
  std::vector<Index> flags;
  for (Index i = 0; i < p.count; ++i) flags.push_back(predicates::collinear_3d(row3(p, i), row3(q, i), row3(r, i)));
  return to_array(std::move(flags));
}

py::array lengths_2d(const py::object& vectors) {
  const ArrayIn<double> v = as_points2(vectors, "vectors");
  std::vector<double> lengths;
  for (Index i = 0; i < v.count; ++i) lengths.push_back(hypotenuse(v.values[2 * i], v.values[2 * i + 1]));
  return to_array(std::move(lengths));
}

}  // namespace

void bind_predicates(py::module_& m) {
  py::module_ sub = m.def_submodule("predicates", "Exact geometric predicates on arrays of points; for tests.");
  sub.def("orient_2d", &orient_2d, py::arg("a"), py::arg("b"), py::arg("c"));
  sub.def("in_circle", &in_circle, py::arg("a"), py::arg("b"), py::arg("c"), py::arg("d"));
  sub.def("collinear_3d", &collinear_3d, py::arg("a"), py::arg("b"), py::arg("c"));
  sub.def("lengths_2d", &lengths_2d, py::arg("vectors"));
}

}  // namespace saddleback::bindings
