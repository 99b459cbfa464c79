// DualMesh and TriangleQuality.

#include <algorithm>
#include <numbers>
#include <numeric>
#include <optional>
#include <pybind11/stl.h>
#include <span>

#include "saddleback/tessellation/cell_polygons.h"
#include "saddleback/tessellation/triangle_quality.h"

#include "convert/cells.h"
#include "convert/curves.h"
#include "convert/dual.h"
#include "convert/points.h"

namespace saddleback::bindings {
namespace {

template <auto Member, class Owner>
py::array member_array(const py::object& self) {
  return view_of(std::span(py::cast<const Owner&>(self).*Member), self);
}

double mean(const std::vector<double>& values) {
  return values.empty() ? 0 : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}
double least(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::min_element(values.begin(), values.end());
}

TriangleQuality measure(const py::object& vertices, const py::object& triangles) {
  const ArrayIn<double> xyz = as_points3(vertices, "vertices");
  const ArrayIn<Index> indices = as_triangles(triangles, "triangles");
  const JobIn job{py::none()};
  return without_gil([&] {
    const std::span positions(reinterpret_cast<const Vec3*>(xyz.values.data()), xyz.values.size() / 3);
    const std::span faces(reinterpret_cast<const Triangle*>(indices.values.data()), indices.values.size() / 3);
    return triangle_quality(positions, faces, job);
  });
}

void bind_issue(py::module_& m) {
  py::class_<DualIssue>(m, "DualIssue", py::module_local(), "A place where cells have no triangulation as their dual.")
      .def_property_readonly(
          "kind", [](const DualIssue& issue) { return to_string(issue.kind); },
          "\"not_a_disk\", \"two_borders\", \"closed_boundary\", \"double_boundary\", \"cell_meets_itself\" or "
          "\"few_corners\".")
      .def_readonly("cell", &DualIssue::cell, "The cell concerned.")
      .def_property_readonly(
          "other",
          [](const DualIssue& issue) -> std::optional<Index> {
            return issue.other == k_none ? std::nullopt : std::optional(issue.other);
          },
          "The other cell, None where one is concerned.")
      .def_property_readonly(
          "place", [](const DualIssue& issue) { return SurfacePoints{issue.place}; },
          "SurfacePoints (1): where one more site mends it.")
      .def("__repr__", [](const DualIssue& issue) { return "<saddleback.DualIssue: " + to_string(issue) + ">"; })
      .def("__str__", [](const DualIssue& issue) { return to_string(issue); });
}

py::array edge_lengths(const py::object& self) {
  auto& dual = py::cast<Dual&>(self);
  if (!dual.edge_lengths) {
    const JobIn token{py::none()};
    const auto& graph = py::cast<const SaddleVertexGraph&>(dual.graph);
    std::vector<double> lengths;
    for (const GeodesicPath& path : without_gil([&] { return dual_edge_paths(graph, *dual.cells, 0, token); }))
      lengths.push_back(path.length);
    if (!dual.edge_lengths) dual.edge_lengths = std::move(lengths);  // another thread may have been sooner
  }
  return view_of(std::span<const double>(*dual.edge_lengths), self);
}

py::object cells_of(const Dual& dual) {
  if (!dual.repaired) return dual.owner;
  return make_cells(GeodesicVoronoi(*dual.repaired), dual.graph, false);
}

py::tuple quads(const Dual& dual, const py::object& curves) {
  const CurvesIn lines = as_curves(curves);
  DualQuads made = without_gil([&] { return dual_quads(*dual.mesh, *dual.cells, lines.curves); });
  return py::make_tuple(std::move(made.points), to_rows<Index>(std::move(made.quads)));
}

constexpr const char* k_quads_doc = R"(Cut each triangle into three quads, with all vertices on the surface.

The triangles' middles are the branch points of the cells, the edges' middles lie on the boundaries between cells: one
step of Catmull-Clark without its smoothing, on the surface.

Parameters
----------
curves : sequence of SurfaceCurve, optional
    Along which edges of the mesh run: an edge between two sites on them has its middle where the boundary between their
    cells crosses them.

Returns
-------
tuple of SurfacePoints and (q, 4) int32
    Points: the sites, the middle of each of `edges`, the branch points. Quads: counter-clockwise, from the branch
    point. Between sites on the mesh's border the middle is where the boundary of their cells ends.

Raises
------
InputError
    Curves of another mesh.

Notes
-----
O(cells + boundaries). After E. Catmull, J. Clark: Recursively generated B-spline surfaces, 1978.)";

void bind_dual(py::module_& m) {
  py::class_<Dual>(m, "DualMesh", py::module_local(),
                   "The triangulation of the sites that is dual to cells; made by `GeodesicVoronoi.dual`. Unpacks "
                   "into vertices, triangles and issues.")
      .def_property_readonly(
          "sites", [](const Dual& d) { return d.sites; }, "SurfacePoints (n): those that repair added come last.")
      .def_property_readonly("vertices", &member_array<&DualMesh::vertices, Dual>,
                             "(n, 3) float64: the sites' positions, on the surface.")
      .def_property_readonly("triangles", &member_array<&DualMesh::triangles, Dual>,
                             "(t, 3) int32: one for each branch point, counter-clockwise.")
      .def_property_readonly(
          "edges",
          [](const py::object& self) {
            return view_of_rows<Index>(std::span<const std::array<Index, 2>>(py::cast<const Dual&>(self).edges), self);
          },
          "(e, 2) int32: the sites on both sides of each boundary between cells.")
      .def_property_readonly("edge_lengths", &edge_lengths,
                             "(e,) float64, mesh units: of the locally shortest way from site to site across that "
                             "boundary, which `GeodesicVoronoi.dual_paths` leads along. Found when first asked for, "
                             "O(faces crossed) each.")
      .def_property_readonly("cells", &cells_of, "GeodesicVoronoi: the cells of its sites.")
      .def("quads", &quads, py::arg("curves") = py::none(), k_quads_doc)
      .def_readonly("issues", &Dual::issues, "List of DualIssue; empty: a triangulation of the surface.")
      .def_readonly("added", &Dual::added, "Number of sites that repair added.")
      .def_readonly("euler_characteristic", &Dual::euler_characteristic, "Vertices - edges + triangles.")
      .def("__iter__",
           [](const py::object& self) {
             return py::iter(py::make_tuple(self.attr("vertices"), self.attr("triangles"), self.attr("issues")));
           })
      .def("__repr__", [](const Dual& d) {
        return message("<saddleback.DualMesh of ", d.vertices.size(), " vertices, ", d.triangles.size(), " triangles, ",
                       d.issues.size(), " issues>");
      });
}

}  // namespace

void bind_dual_mesh(py::module_& m) {
  bind_issue(m);
  bind_dual(m);
  using Quality = TriangleQuality;
  py::class_<Quality>(m, "Quality", py::module_local(), "Measures of a triangle mesh; made by `triangle_quality`.")
      .def_property_readonly(
          "quality", &member_array<&Quality::quality, Quality>,
          "(T,) float64: 6 S / (sqrt(3) p h) of area S, half perimeter p, longest edge h; 1 is best.")
      .def_property_readonly("least_angle", &member_array<&Quality::least_angle, Quality>, "(T,) float64, radians.")
      .def_property_readonly("greatest_angle", &member_array<&Quality::greatest_angle, Quality>,
                             "(T,) float64, radians.")
      .def_property_readonly("valence", &member_array<&Quality::valence, Quality>, "(V,) int32: edges at each vertex.")
      .def_readonly("irregular", &Quality::irregular,
                    "Share of vertices whose valence is not 6 (on the boundary not 4).")
      .def_property_readonly(
          "mean_quality", [](const Quality& q) { return mean(q.quality); }, "Mean quality of the triangles.")
      .def_property_readonly(
          "min_quality", [](const Quality& q) { return least(q.quality); }, "Least quality of the triangles.")
      .def_property_readonly(
          "mean_angle", [](const Quality& q) { return mean(q.least_angle); }, "Mean of the least angles, radians.")
      .def_property_readonly(
          "min_angle", [](const Quality& q) { return least(q.least_angle); }, "The least angle of all, radians.")
      .def("__repr__", [](const Quality& q) {
        return message("<saddleback.Quality: mean ", mean(q.quality), ", least ", least(q.quality), ", mean angle ",
                       mean(q.least_angle) * 180 / std::numbers::pi, " degrees, ", 100 * q.irregular, " % irregular>");
      });
  m.def("triangle_quality", &measure, py::arg("vertices"), py::arg("triangles"),
        R"(Measure how near triangles are to equilateral ones.

Parameters
----------
vertices : (V, 3) float array
triangles : (T, 3) int array
    Any triangles, manifold or not.

Returns
-------
Quality

Raises
------
InputError
    An index out of range, a coordinate that is not finite.

Notes
-----
O(V + T log T). After [frey1999].)");
}

}  // namespace saddleback::bindings
