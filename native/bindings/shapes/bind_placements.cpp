// Placements: where shapes lie.

#include "convert/points.h"
#include "convert/shapes.h"

namespace saddleback::bindings {

const Placements& as_placements(const py::object& value, const char* argument) {
  if (!py::isinstance<Placements>(value))
    throw InputError(message(argument, ": wanted a Placements, got a ",
                             py::cast<std::string>(py::type::of(value).attr("__name__"))));
  return py::cast<const Placements&>(value);
}

Placements as_placements(const py::object& value, const Mesh& mesh, std::size_t shape_count) {
  const Placements& placements = as_placements(value, "placements");
  check_placements(mesh, shape_count, placements);
  return placements;
}

namespace {

constexpr const char* k_placements_doc = R"(The places of copies of shapes on a surface.

A point (x, y) of a shape's plane is laid at the distance scale * |(x, y)| from the center, in the direction
angle + atan2(y, x).

Args:
    shape: (n,) integers, which of a list of shapes.
    center: SurfacePoints, n.
    angle: (n,) radians, the direction of the shape's x axis at the center, counter-clockwise seen from outside, from the
        first edge (corner 0 to corner 1) of the center's face.
    scale: (n,) mesh units for one unit of the shape's plane.
    mirrored: (n,) booleans: y of the shape's plane is negated first. None: no shape is.

Raises:
    InputError: lengths that differ, a negative shape, an angle that is not finite, a scale that is not positive.
)";

Placements make_placements(const py::object& shape, const py::object& center, const py::object& angle,
                           const py::object& scale, const py::object& mirrored) {
  if (!py::isinstance<SurfacePoints>(center)) throw InputError("center: wanted a SurfacePoints");
  const SurfacePoints& points = py::cast<const SurfacePoints&>(center);
  const auto count = static_cast<Index>(points.size());
  const ArrayIn<Index> shapes = as_indices(shape, "shape");
  if (shapes.count != count) throw InputError(message("shape has ", shapes.count, " values, wanted ", count));
  const ArrayIn<double> angles = as_reals(angle, "angle", count), scales = as_reals(scale, "scale", count);
  const std::vector<std::uint8_t> flags =
      mirrored.is_none() ? std::vector<std::uint8_t>(count, 0) : as_flags(mirrored, "mirrored");
  if (std::ssize(flags) != count) throw InputError(message("mirrored has ", flags.size(), " values, wanted ", count));
  Placements result;
  for (Index i = 0; i < count; ++i) {
    if (shapes.values[i] < 0) throw InputError(message("shape: ", shapes.values[i], " at [", i, "] is negative"));
    if (!std::isfinite(angles.values[i]))
      throw InputError(message("angle: ", angles.values[i], " at [", i, "] is not finite"));
    if (!(scales.values[i] > 0) || !std::isfinite(scales.values[i]))
      throw InputError(message("scale: ", scales.values[i], " at [", i, "] is not positive and finite"));
    result.push_back({shapes.values[i], points[i], angles.values[i], scales.values[i], flags[i] != 0});
  }
  return result;
}

/// Returns those of an index, a slice, or an array of booleans or indices, as NumPy picks them.
Placements picked(const Placements& self, const py::object& index) {
  const py::object numbers = py::module_::import("numpy").attr("arange")(self.size());
  const ArrayIn<Index> chosen = as_indices(py::module_::import("numpy").attr("atleast_1d")(numbers[index]), "index");
  Placements result;
  for (const Index number : chosen.values) result.push_back(self[static_cast<std::size_t>(number)]);
  return result;
}

/// One value of every placement.
template <class T, class Get>
py::array column(const Placements& placements, Get get) {
  std::vector<T> values;
  values.reserve(placements.size());
  for (const Placement& placement : placements) values.push_back(get(placement));
  return to_array(std::move(values));
}

}  // namespace

void bind_placements(py::module_& m) {
  py::class_<Placements>(m, "Placements", py::module_local(), k_placements_doc)
      .def(py::init(&make_placements), py::arg("shape"), py::arg("center"), py::arg("angle"), py::arg("scale"),
           py::arg("mirrored") = py::none())
      .def_property_readonly(
          "shape",
          [](const Placements& self) { return column<Index>(self, [](const Placement& p) { return p.shape; }); },
          "(n,) int32: which of the shapes.")
      .def_property_readonly(
          "center",
          [](const Placements& self) {
            SurfacePoints points;
            for (const Placement& placement : self) points.push_back(placement.center);
            return points;
          },
          "SurfacePoints.")
      .def_property_readonly(
          "angle",
          [](const Placements& self) { return column<double>(self, [](const Placement& p) { return p.angle; }); },
          "(n,) float64: radians from the first edge of the center's face.")
      .def_property_readonly(
          "scale",
          [](const Placements& self) { return column<double>(self, [](const Placement& p) { return p.scale; }); },
          "(n,) float64: mesh units for one unit of the shape's plane.")
      .def_property_readonly(
          "mirrored",
          [](const Placements& self) {
            return column<std::uint8_t>(self, [](const Placement& p) { return p.mirrored; }).attr("astype")("bool");
          },
          "(n,) bool.")
      .def("__len__", &Placements::size)
      .def("__getitem__", &picked, py::arg("index"),
           "Placements of some: an integer, a slice, or an array of indices or booleans, as NumPy takes them.")
      .def("__repr__", [](const Placements& self) { return message("<Placements: ", self.size(), ">"); });
}

}  // namespace saddleback::bindings
