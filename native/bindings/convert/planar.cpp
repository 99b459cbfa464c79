#include "convert/planar.h"

namespace saddleback::bindings {

std::vector<Vec2> as_points_2d(const py::object& value, const char* name) {
  const ArrayIn<double> in = as_points2(value, name);
  std::vector<Vec2> points(in.count);
  for (Index i = 0; i < in.count; ++i) points[i] = {in.values[2 * i], in.values[2 * i + 1]};
  return points;
}

std::vector<double> as_weights(const py::object& value, std::size_t site_count) {
  if (value.is_none()) return {};
  const ArrayIn<double> in = as_reals(value, "weights", static_cast<Index>(site_count));
  return std::vector<double>(in.values.begin(), in.values.end());
}

PlanarDomain as_domain(const py::object& value, const char* name) {
  std::vector<std::vector<Vec2>> loops;
  const bool is_list = py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value);
  const py::object first = is_list && py::len(value) > 0 ? py::object(value[py::int_(0)]) : py::none();
  const bool holds_loops = !first.is_none() && py::hasattr(first, "__len__") && py::len(first) > 0 &&
                           py::hasattr(first[py::int_(0)], "__len__");
  if (holds_loops) {
    for (const py::handle loop : value) loops.push_back(as_points_2d(py::reinterpret_borrow<py::object>(loop), name));
  } else {
    loops.push_back(as_points_2d(value, name));
  }
  return PlanarDomain(std::move(loops), name);
}

}  // namespace saddleback::bindings
