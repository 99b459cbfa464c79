// CellPolygons.

#include <algorithm>
#include <span>

#include "saddleback/tessellation/cell_polygons.h"

#include "convert/points.h"

namespace saddleback::bindings {
namespace {

template <auto Member>
py::array array_of(const py::object& self) {
  return view_of(std::span(py::cast<const CellPolygons&>(self).*Member), self);
}

}  // namespace

void bind_cell_polygons(py::module_& m) {
  py::class_<CellPolygons>(m, "CellPolygons", py::module_local(),
                           "A polygon for each cell; made by `GeodesicVoronoi.polygons`.")
      .def_property_readonly(
          "points", [](const CellPolygons& p) { return p.points; }, "SurfacePoints (n): the vertices.")
      .def_property_readonly(
          "vertices",
          [](const py::object& self) {
            return view_of(std::span<const Vec3>(py::cast<const CellPolygons&>(self).vertices), self);
          },
          "(n, 3) float64: their positions.")
      .def_property_readonly("corners", &array_of<&CellPolygons::corners>,
                             "(m,) int32: the vertices of all polygons, one after another, counter-clockwise.")
      .def_property_readonly("offsets", &array_of<&CellPolygons::offsets>,
                             "(p + 1,) int32: polygon i is [offsets[i], offsets[i + 1]).")
      .def_property_readonly("polygon_cell", &array_of<&CellPolygons::polygon_cell>, "(p,) int32, ascending.")
      .def_property_readonly("missing", &array_of<&CellPolygons::missing>,
                             "(k,) int32: cells that have an area but no polygon.")
      .def_property_readonly(
          "sites", [](const CellPolygons& p) { return p.sites; },
          "SurfacePoints: of the cells; those that repair added come last.")
      .def_property_readonly(
          "is_barrier",
          [](const CellPolygons& p) {
            py::array_t<bool> result(static_cast<py::ssize_t>(p.is_barrier.size()));
            std::copy(p.is_barrier.begin(), p.is_barrier.end(), result.mutable_data());
            return result;
          },
          "(m,) bool: by `corners`, whether the side from there on runs along a barrier.")
      .def_readonly("added", &CellPolygons::added, "Number of sites that repair added.")
      .def(
          "triangles",
          [](const CellPolygons& p) { return to_array(without_gil([&] { return polygon_triangles(p); })); },
          "The polygons cut into triangles between their corners, (t, 3) int32: a polygon of n corners into n - 2, in "
          "the "
          "order of the polygons; a fan where none of its triangles is turned over, else as Delaunay's as can be.")
      .def("__len__", [](const CellPolygons& p) { return p.polygon_cell.size(); })
      .def("__repr__", [](const CellPolygons& p) {
        return message("<saddleback.CellPolygons of ", p.polygon_cell.size(), " polygons, ", p.vertices.size(),
                       " vertices>");
      });
}

}  // namespace saddleback::bindings
