// Diagrams of a plane that repeats itself.

#include "saddleback/voronoi2d/periodic_voronoi_2d.h"

#include "convert/fields.h"
#include "convert/planar.h"
#include "convert/state.h"

namespace saddleback::bindings {
namespace {

constexpr const char* k_doc =
    R"(Voronoi diagram of sites that repeat themselves in both directions: on a torus, for seamless tiles.

Sites are brought into the box and rounded to 2^-51 of what it and its neighbors span, so that their copies by whole
periods are copies to the bit. Of these, which cells touch and where more than three meet is exact; only vertices are
rounded. Cells may touch themselves, and two cells may share several edges.

Parameters
----------
sites : (n, 2) float array
    Anywhere; equal ones, a period apart or not, share a cell.
box : (2, 2) float array
    The lower left and the upper right corner.
weights : (n,) float array, optional
    Of a power diagram, as `power_diagram_2d` takes them. None: all alike.
threads : int
    0: all cores. The result does not depend on it.
job : Job, optional

Returns
-------
PeriodicVoronoi2d

Raises
------
InputError
    No sites, numbers that are not finite, a box without an area or thinner than 2^-41 of its coordinates, what
    `voronoi_2d` and `power_diagram_2d` refuse.
Cancelled
    The job was cancelled.

Notes
-----
O(n log n) time, O(n) memory: copies as far around the box as circles about its vertices reach, in most cases four
spacings of the sites, are part of the diagram, at most all eight neighbors.)";

constexpr const char* k_locate_doc =
    R"(The site of which a copy is nearest to each point, or has the least power there; of equally near ones any.

Parameters
----------
points : (m, 2) float array
    Exactly what they are in the box; others are brought there by whole periods, to rounding.
threads : int
    0: all cores.
job : Job, optional

Returns
-------
(m,) int32 array

Raises
------
InputError
    A coordinate that is not finite.
Cancelled
    The job was cancelled.

Notes
-----
O(n + m) expected.)";

const PeriodicVoronoi2d& of(const py::object& self) { return py::cast<const PeriodicVoronoi2d&>(self); }

PeriodicVoronoi2d find(const py::object& sites, const py::object& box, const py::object& weights,
                       const py::object& threads, const py::object& job) {
  const std::vector<Vec2> points = as_points_2d(sites, "sites"), corners = as_points_2d(box, "box");
  if (corners.size() != 2) throw InputError(message("box: wanted two corners, got ", corners.size()));
  ArrayIn<double> given;
  if (!weights.is_none()) given = as_reals(weights, "weights", static_cast<Index>(points.size()));
  const int count = as_integer(threads, "threads");
  const JobIn token(job);
  return without_gil([&] { return periodic_voronoi_2d(points, corners[0], corners[1], given.values, count, token); });
}

template <auto Member>
py::array array(const py::object& self) {
  return view_of(std::span(of(self).*Member), self);
}
template <auto Member, class Scalar>
py::array rows(const py::object& self) {
  return view_of_rows<Scalar>(std::span(of(self).*Member), self);
}

}  // namespace

void bind_periodic_voronoi_2d(py::module_& m) {
  using P = PeriodicVoronoi2d;
  py::class_<P>(m, "PeriodicVoronoi2d", py::module_local(),
                "Voronoi diagram of a plane that repeats itself; made by `periodic_voronoi_2d`.")
      .def_property_readonly(
          "box",
          [](const py::object& self) {
            return to_array(std::vector<Vec2>{of(self).low, of(self).low + of(self).size});
          },
          "(2, 2) float64: its corners, rounded as the sites are.")
      .def_property_readonly("sites", &rows<&P::sites, double>,
                             "(n, 2) float64: in the box, its low sides included, rounded.")
      .def_property_readonly("powers", &array<&P::powers>,
                             "(n,) float64: the weights of a power diagram as given, or (0,) of others.")
      .def_property_readonly("site_of", &array<&P::site_of>,
                             "(n,) int32: smallest index of an equal site; only such sites have a cell.")
      .def_property_readonly("hidden", &array<&P::hidden>,
                             "(h,) int32, ascending: sites without a cell, since heavier ones leave them none.")
      .def_property_readonly("vertices", &rows<&P::vertices, double>, "(V, 2) float64: in the box.")
      .def_property_readonly("edges", &rows<&P::edges, Index>, "(E, 2) int32 vertices.")
      .def_property_readonly("edge_shifts", &rows<&P::edge_shifts, Index>,
                             "(E, 2) int32: by how many periods, to the right and up, the second vertex lies elsewhere "
                             "than in the box, as seen from the first.")
      .def_property_readonly("edge_sites", &rows<&P::edge_sites, Index>,
                             "(E, 2) int32: the sites left and right of the edge; they may be the same.")
      .def_property_readonly("edge_site_shifts", &rows<&P::edge_site_shifts, Index>,
                             "(E, 2) int32: the periods to the right site, as seen from the left one.")
      .def_property_readonly(
          "cells",
          [](const py::object& self) {
            return py::make_tuple(view_of(std::span(of(self).cell_offsets), self), to_array(of(self).corner_places()));
          },
          "(n + 1,) int32 offsets and (2 E, 2) float64 places: the cell of site i, around it and perhaps partly beside "
          "the box, is places[offsets[i]:offsets[i + 1]], counter-clockwise; empty for a site equal to an earlier one.")
      .def_property_readonly("corner_vertices", &array<&P::corner_vertices>,
                             "(2 E,) int32: the vertices at the corners of all cells.")
      .def_property_readonly("corner_shifts", &rows<&P::corner_shifts, Index>,
                             "(2 E, 2) int32: the periods to them, as seen from the cell's site.")
      .def_property_readonly("side_edges", &array<&P::side_edges>,
                             "(2 E,) int32: the edge that ends at each corner of all cells.")
      .def_property_readonly("delaunay", &rows<&P::triangles, Index>,
                             "(T, 3) int32 sites, counter-clockwise: the triangulation of the torus; 2 for each site.")
      .def_property_readonly(
          "delaunay_shifts",
          [](const py::object& self) {
            return view_of_rows<Index>(std::span(of(self).triangle_shifts), self).attr("reshape")(-1, 3, 2);
          },
          "(T, 3, 2) int32: the periods to each corner, as seen from the first.")
      .def_property_readonly(
          "areas", [](const P& p) { return to_array(p.areas()); },
          "(n,) float64: of the cells; 0 for hidden sites. Equal sites have the same cell; the others' sum is the "
          "box's.")
      .def_property_readonly(
          "centroids", [](const P& p) { return to_array(p.centroids()); },
          "(n, 2) float64: centers of mass as seen from the sites, perhaps beside the box; not a number for hidden "
          "sites.")
      .def(
          "locate",
          [](const P& p, const py::object& points, const py::object& threads, const py::object& job) {
            const std::vector<Vec2> queries = as_points_2d(points, "points");
            const int count = as_integer(threads, "threads");
            const JobIn token(job);
            return to_array(without_gil([&] { return p.locate(queries, count, token); }));
          },
          py::arg("points"), py::kw_only(), py::arg("threads") = 0, py::arg("job") = py::none(), k_locate_doc)
      .def("__repr__", [](const P& p) {
        return message("<saddleback.PeriodicVoronoi2d of ", p.around.site_of.empty() ? 0 : p.sites.size(), " sites, ",
                       p.vertices.size(), " vertices>");
      });
  m.def("periodic_voronoi_2d", &find, py::arg("sites"),
        py::arg("box") = py::make_tuple(py::make_tuple(0.0, 0.0), py::make_tuple(1.0, 1.0)),
        py::arg("weights") = py::none(), py::kw_only(), py::arg("threads") = 0, py::arg("job") = py::none(), k_doc);
  let_travel<PeriodicVoronoi2d>(m, "PeriodicVoronoi2d");
}

}  // namespace saddleback::bindings
