// Python: coordinates along a curve that do not fold.

#include "saddleback/charts/stroke_map.h"
#include "saddleback/geodesics/geodesic_paths.h"

#include "convert/points.h"
#include "convert/state.h"

namespace saddleback {

// NOLINTNEXTLINE(readability-identifier-naming)
static auto fields_of(StrokeMap& of) {
  auto& [triangles, face_origin, points, vertices, uv, length, area, coverage] = of;
  return std::tie(triangles, face_origin, points, vertices, uv, length, area, coverage);
}

}  // namespace saddleback

namespace saddleback::bindings {
namespace {

constexpr const char* k_map_doc = "The surface about a curve, laid flat without folds; made by `stroke_map`.";

constexpr const char* k_stroke_doc = R"(Map the surface beside a curve one to one to the plane, for pictures along it.

`polar_coordinates` tells the truth about single vertices, but whole triangles fold where ways from two parts of the
curve meet, and have no width about its bends and behind saddle vertices. Here none does: the patch is cut along the
curve, across its ends at right angles, at the radius and along the cut locus, and large faces are divided. The distance
is exact at the mesh's vertices, up to 1e-4 of the radius, and linear between them; the coordinate along the curve is the arc length on it, and off
it harmonic, so that it passes over bends and bumps smoothly.

Args:
    mesh: the Mesh.
    curve: a SurfaceCurve, a GeodesicPath, or its points as a SurfacePoints or vertices (taken as an open curve). A
        closed one is cut open where it starts.
    radius: mesh units, finite and at least 1/8000 of the curve's length.
    job: progress and cancellation.

Returns:
    A StrokeMap: a triangle mesh on the surface with a place in the plane for every vertex. All its triangles have
    the same orientation there, by exact sign, and no two overlap. Left out is what lies beyond the ends of the curve and
    what no such map holds, about places where the distance is largest; `coverage` tells how much is there.

Raises:
    InputError: a radius that is not finite and above 0, or less than 1/8000 of the curve's length, for which the map may
        take more than a million triangles (the message tells the least that works); no curve, a curve of another mesh, a
        curve that crosses or touches itself (the message tells where).
    Cancelled: the job was.

Notes:
    O(n^1.5) for n vertices of the patch, and O(F). Fermi coordinates as in [ying2014] sections 6.1 to 6.3, by convex
    combinations [tutte1963], [floater2003] that keep the distances of exact windows.
)";

StrokeMap stroke_map_of(const py::object& mesh_object, const py::object& curve, const py::object& radius,
                        const py::object& job) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const double wanted = as_real(radius, "radius");
  const JobIn token(job);
  if (py::isinstance<SurfaceCurve>(curve)) {
    const auto& given = py::cast<const SurfaceCurve&>(curve);
    return without_gil([&] { return stroke_map(mesh, given, wanted, token); });
  }
  SurfacePoints points = py::isinstance<GeodesicPath>(curve) ? py::cast<const GeodesicPath&>(curve).surface
                                                             : as_surface_points(curve, mesh, "curve");
  return without_gil(
      [&] { return stroke_map(mesh, SurfaceCurve(mesh, std::move(points), false, "curve"), wanted, token); });
}

template <class T>
auto rows_of(const std::vector<T> StrokeMap::*member) {
  return [member](const py::object& self) {
    return view_of(std::span<const T>(py::cast<const StrokeMap&>(self).*member), self);
  };
}

}  // namespace

void bind_stroke_map(py::module_& m) {
  py::class_<StrokeMap>(m, "StrokeMap", py::module_local(), k_map_doc)
      .def_property_readonly("vertices", rows_of(&StrokeMap::vertices), "(n, 3) float64: of the patch, in space.")
      .def_property_readonly("triangles", rows_of(&StrokeMap::triangles),
                             "(m, 3) int32: of the patch, oriented as the mesh; those right of the curve come first.")
      .def_property_readonly(
          "uv",
          [](const py::object& self) {
            return view_of_rows<double>(std::span<const Vec2>(py::cast<const StrokeMap&>(self).uv), self);
          },
          "(n, 2) float64: along the curve, 0 to `length`, and distance from it, positive on its left; mesh units.")
      .def_property_readonly(
          "points", [](const StrokeMap& map) { return map.points; }, "SurfacePoints (n): the vertices on the mesh.")
      .def_property_readonly("face_origin", rows_of(&StrokeMap::face_origin),
                             "(m,) int32: face of the mesh that each triangle is a part of.")
      .def_readonly("length", &StrokeMap::length, "Of the curve, mesh units.")
      .def_readonly("area", &StrokeMap::area, "Of the patch, square mesh units.")
      .def_readonly("coverage", &StrokeMap::coverage,
                    "Share that the patch is of all that lies beside the curve within the radius.")
      .def("__len__", [](const StrokeMap& map) { return map.triangles.size(); })
      .def("__repr__", [](const StrokeMap& map) {
        return message("<saddleback.StrokeMap: ", map.points.size(), " vertices, ", map.triangles.size(),
                       " triangles, ", map.length, " long>");
      });
  m.def("stroke_map", &stroke_map_of, py::arg("mesh"), py::arg("curve"), py::arg("radius"), py::kw_only(),
        py::arg("job") = py::none(), k_stroke_doc);
  let_travel<StrokeMap>(m, "StrokeMap");
}

}  // namespace saddleback::bindings
