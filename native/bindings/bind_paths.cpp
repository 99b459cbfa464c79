// Curves on the surface, paths in the graph, log map and polar coordinates.

#include "saddleback/surface_curve.h"

#include "points.h"

namespace saddleback::bindings {
namespace {

constexpr const char* k_curve_doc =
    R"(A polyline on the surface: straight between consecutive points, each pair of which shares a face. Immutable.

The points of a GeodesicPath or a TracedPath (`path.surface`) are such a curve.

Args:
    mesh: the mesh, kept alive by the curve.
    points: (n,) vertices or a SurfacePoints, n >= 2, in order; repeated points are harmless. A point within 1e-6
        (barycentric) of an edge counts as on it where its neighbour needs that.
    closed: the curve runs on from the last point to the first, which then need not be repeated.

Raises:
    InputError: fewer than two points, a point off the mesh, consecutive points that share no face (their indices are
        named), a curve without length.
)";

std::unique_ptr<SurfaceCurve> make_curve(const py::object& mesh_object, const py::object& points, bool closed) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  SurfacePoints given = as_surface_points(points, mesh, "points");
  return without_gil([&] { return std::make_unique<SurfaceCurve>(mesh, std::move(given), closed); });
}

void bind_curve(py::module_& m) {
  py::class_<SurfaceCurve>(m, "SurfaceCurve", py::module_local(), k_curve_doc)
      .def(py::init(&make_curve), py::arg("mesh"), py::arg("points"), py::arg("closed") = false,
           py::keep_alive<1, 2>())
      .def_property_readonly(
          "points", [](const SurfaceCurve& curve) { return curve.points(); }, "The points as a SurfacePoints.")
      .def_property_readonly("closed", &SurfaceCurve::closed, "Whether the curve runs on to its first point.")
      .def_property_readonly("length", &SurfaceCurve::length, "Mesh units.")
      .def("__len__", [](const SurfaceCurve& curve) { return curve.points().size(); })
      .def("__repr__", [](const SurfaceCurve& curve) {
        return message("<SurfaceCurve: ", curve.points().size(), " points, ", curve.closed() ? "closed, " : "",
                       "length ", curve.length(), ">");
      });
}

}  // namespace

void bind_paths(py::module_& m) { bind_curve(m); }

}  // namespace saddleback::bindings
