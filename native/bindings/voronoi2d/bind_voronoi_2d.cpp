// Voronoi diagrams of the plane.

#include "saddleback/voronoi2d/power_diagram_2d.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

#include "convert/devices.h"
#include "convert/fields.h"
#include "convert/planar.h"
#include "convert/state.h"
#include "support/memory/large_memory.h"
#include "voronoi2d/sites/site_order.h"

namespace saddleback::bindings {
namespace {

/// The diagram and, if the caller gave a domain, its cells in there.
struct Diagram {
  Voronoi2d result;
  py::object clipped;
};

py::tuple save_diagram(const py::object& self) {
  const auto& diagram = py::cast<const Diagram&>(self);
  return py::make_tuple(state_of(diagram.result), diagram.clipped, state_of(diagram.result.device_times));
}

Diagram load_diagram(const py::tuple& state) {
  const py::tuple parts = as_state(state, 3);
  Diagram diagram{{}, parts[1]};
  restore(parts[0], diagram.result);
  restore(parts[2], diagram.result.device_times);
  return diagram;
}

/// The shares of a call that finds a diagram and, in a domain, its cells.
struct Shares {
  Job finding, clipping;
  Shares(const Job& whole, bool has_domain)
      : finding(whole.part(0, has_domain ? 0.7 : 1)), clipping(whole.part(0.7, 1)) {}
};

Voronoi2d find(const ArrayIn<double>& sites, const std::vector<double>& radii, const Voronoi2dOptions& options,
               Job* job) {
  static_assert(sizeof(Vec2) == 2 * sizeof(double));
  const std::span all(reinterpret_cast<const Vec2*>(sites.values.data()), static_cast<std::size_t>(sites.count));
  const bool has_weights = !radii.empty();
  // The devices do with sites that somebody changes meanwhile, and a copy here would take longer than theirs.
  if (!options.cuda_devices.empty() && !has_weights) return without_gil([&] { return voronoi_2d(all, options, job); });
  LargeArray<Vec2> own(all.size());
  copy_large(own.data(), all.data(), all.size_bytes(), options.threads);
  return without_gil(
      [&] { return has_weights ? voronoi_2d(own, radii, options, job) : voronoi_2d(std::move(own), options, job); });
}

Diagram find_diagram(const py::object& sites, const py::object& weights, const py::object& domain,
                     const py::object& circles, const py::object& threads, const std::string& device,
                     const py::object& job, bool pinned) {
  Voronoi2dOptions options{
      .circles = as_integer(circles, "circles"), .threads = as_integer(threads, "threads"), .is_pinned = pinned};
  const ArrayIn<double> points = as_points2(sites, "sites");
  voronoi2d::check_site_count(static_cast<std::size_t>(points.count));  // before they are copied
  const std::vector<double> radii = as_weights(weights, static_cast<std::size_t>(points.count));
  std::optional<PlanarDomain> within;
  if (!domain.is_none()) within = as_domain(domain, "domain");
  const JobIn token(job);
  Shares shares(*static_cast<Job*>(token), within.has_value());
  constexpr Index k_worth_a_device = 50'000;
  Voronoi2d diagram = run_on(device, points.count >= k_worth_a_device, [&](const std::vector<int>& devices) {
    options.cuda_devices = devices;
    return find(points, radii, options, &shares.finding);
  });
  if (!within) return {std::move(diagram), py::none()};
  ClippedCells clipped = without_gil([&] { return diagram.clip(*within, options.threads, &shares.clipping); });
  return {std::move(diagram), py::cast(std::move(clipped))};
}

Diagram find_powers(const py::object& sites, const py::object& weights, const py::object& domain,
                    const py::object& threads, const py::object& job) {
  const std::vector<Vec2> points = as_points_2d(sites, "sites");
  const ArrayIn<double> given = as_reals(weights, "weights", static_cast<Index>(points.size()));
  std::optional<PlanarDomain> within;
  if (!domain.is_none()) within = as_domain(domain, "domain");
  const int count = as_integer(threads, "threads");
  const JobIn token(job);
  Shares shares(*static_cast<Job*>(token), within.has_value());
  Voronoi2d diagram = without_gil([&] { return power_diagram_2d(points, given.values, count, &shares.finding); });
  if (!within) return {std::move(diagram), py::none()};
  ClippedCells clipped = without_gil([&] { return diagram.clip(*within, count, &shares.clipping); });
  return {std::move(diagram), py::cast(std::move(clipped))};
}

template <auto Member, class Scalar>
py::array rows(const py::object& self) {
  const auto& vector = py::cast<const Diagram&>(self).result.*Member;
  return view_of_rows<Scalar>(std::span(vector), self);
}
template <auto Member>
py::array array(const py::object& self) {
  const auto& vector = py::cast<const Diagram&>(self).result.*Member;
  return view_of(std::span(vector), self);
}

template <auto Member>
py::array clipped_array(const py::object& self) {
  const auto& vector = py::cast<const ClippedCells&>(self).*Member;
  return view_of(std::span(vector), self);
}
py::array clipped_points(const py::object& self) {
  return view_of_rows<double>(std::span(py::cast<const ClippedCells&>(self).points), self);
}
py::array clipped_centroids(const py::object& self) {
  return view_of_rows<double>(std::span(py::cast<const ClippedCells&>(self).centroids), self);
}

Index as_site(const Voronoi2d& diagram, const py::object& site) {
  const Index i = as_integer(site, "site"), count = static_cast<Index>(diagram.sites.size());
  if (i < 0 || i >= count) throw InputError(message("site: wanted 0 to ", count - 1, ", got ", i));
  return i;
}

constexpr const char* k_doc = R"(Voronoi diagram of points or disks of the plane.

Which cells touch, and where more than three meet in one vertex, is exact; only coordinates are rounded. With weights a
point x belongs to the site with the smallest |x - site| - weight: edges are branches of hyperbolas, two cells may share
several edges, and a site whose disk lies in another's is hidden.

Parameters
----------
sites : (n, 2) float array
    Any finite numbers in any order. Equal sites (of equal weight) share one cell.
weights : (n,) float array, optional
    Radii of the sites; negative ones too, since only differences matter.
domain : (m, 2) float array or list of such, optional
    A simple polygon, or an outline and its holes: `clipped` then holds the cells within.
circles : int
    How many sweep circles, or parts of weighted sites, share the work; 0: as many as are good. The result does not
    depend on it.
threads : int
    0: all cores. The result does not depend on it.
device : str
    "auto", "cpu", "cuda" or, for another than the first CUDA device, "cuda:1"; "cuda:0,1" and "cuda:all" let several
    share the work. The result does not depend on it; what a device is not made for (few or scattered sites,
    weighted ones that share a place) runs on the processor.
job : Job, optional
pinned : bool
    Whether results come into memory that a CUDA device writes by itself, for one diagram after the other: the first
    takes longer, the others up to a quarter less. See `release_pinned_memory`. Sites in such memory (CuPy's, PyTorch's)
    are always read by the device itself.

Returns
-------
Voronoi2d

Raises
------
InputError
    A coordinate or weight that is not finite, a wrong number of weights, coordinates so different in size that exact arithmetic cannot take them, a domain
    that is not a simple polygon with holes.
Cancelled
    The job was cancelled.

Notes
-----
O(n log n) time (with weights: expected, for evenly spread sites), O(n) memory. H. Tong: the sweep circle that needs
no transformation.)";

constexpr const char* k_power_doc =
    R"(Power diagram of points of the plane (Laguerre's): weights move the borders between cells, which stay straight.

A point x belongs to the site with the least power |x - site|^2 - weight. With the weight r^2 a site is a circle of radius
r, and where two circles cross, the border runs through both crossings. A site may lie outside of its cell. Which cells
there are, which touch, and where more than three meet in one vertex, is exact; only coordinates are rounded.

Parameters
----------
sites : (n, 2) float array
    Any finite numbers in any order. Of sites at one place the heaviest has a cell; equal ones share it.
weights : (n,) float array
    Squares of lengths; negative ones too, since only differences matter.
domain : (m, 2) float array or list of such, optional
    A simple polygon, or an outline and its holes: `clipped` then holds the cells within.
threads : int
    Of all but the triangulation, which takes one. 0: all cores. The result does not depend on it.
job : Job, optional

Returns
-------
Voronoi2d
    Its `powers` are the weights, its `delaunay` the regular triangulation, and `hidden` the sites without a cell, or with
    one without an area.

Raises
------
InputError
    A coordinate or weight that is not finite, a wrong number of weights, coordinates or weights so different in size that
    exact arithmetic cannot take them, a domain that is not a simple polygon with holes.
Cancelled
    The job was cancelled.

Notes
-----
O(n log n) expected, O(n) memory. F. Aurenhammer: Power diagrams, 1987. H. Edelsbrunner, N. Shah: Incremental topological
flipping works for regular triangulations, 1996.)";

constexpr const char* k_clip_doc = R"(The cells within a simple polygon with holes: ClippedCells.

Parameters
----------
polygon : (m, 2) float array or list of such
    A simple polygon, or an outline and its holes, in any direction. Corners may be repeated in a row, and loops may touch
    other loops in points.
gap : float
    How far neighboring cells are apart; the polygon's own sides stay. A cell narrower than that has no loop, one with a
    waist several. With weights each cell keeps half of it from all others, within the tolerance.
tolerance : float
    How far polylines may be from curved edges; 0: a thousandth of a mean cell's width. One finer than 3.7e-9 of
    that width is taken as that, with which an edge as long as a cell is wide has some thousands of points. Neighbors
    share their points, so that areas, which are those of the polygons, sum to the domain's all the same.
threads : int
    0: all cores.
job : Job, optional

Raises
------
InputError
    Fewer than three corners, loops that touch themselves, cross or share a part of a side, a hole outside the outline, a
    gap that is negative or not finite.
Cancelled
    The job was cancelled.

Notes
-----
O(n), and O(m) for each cell at the polygon's edges.)";

constexpr const char* k_polyline_doc = R"(Points along an edge, from its first to its second vertex.

Parameters
----------
edge : int
tolerance : float
    How far any point of the curve, a branch of a hyperbola where the weights differ, may be from the polyline. One
    finer than 1e-12 of what the curve spans is taken as that, which takes up to 500,000 points.
extent : float
    Where an infinite end is cut off: so much farther from the middle of the curve, the point between the two sites, than
    the edge's vertex is, or than the middle itself if that comes later. 0: twice the distance of the sites.

Returns
-------
(k, 2) float64 array, k = 2 for a straight edge

Raises
------
InputError
    An edge that does not exist, lengths that are not positive.

Notes
-----
O(k).)";

constexpr const char* k_locate_doc = R"(Nearest site of each point, exactly; of equally near ones the smallest index.

With weights the one with the smallest distance less its weight; of a power diagram the one with the least power. Hidden
sites, whose cells have no area, are not found.

Parameters
----------
points : (m, 2) float array
threads : int
    0: all cores.
job : Job, optional

Returns
-------
(m,) int32 array

Raises
------
InputError
    A coordinate that is not finite, or a diagram without sites.
Cancelled
    The job was cancelled.

Notes
-----
O(n + m) expected.)";

}  // namespace

const Voronoi2d& as_voronoi_2d(const py::object& value, const char* name) {
  if (!py::isinstance<Diagram>(value)) throw InputError(message(name, ": wanted a Voronoi2d, as voronoi_2d gives"));
  return py::cast<const Diagram&>(value).result;
}

void bind_voronoi_2d(py::module_& m) {
  py::class_<ClippedCells>(m, "ClippedCells", py::module_local(), "Cells within a domain; made by `Voronoi2d.clip`.")
      .def_property_readonly("points", &clipped_points, "(P, 2) float64: corners of all loops, one after another.")
      .def_property_readonly("loop_offsets", &clipped_array<&ClippedCells::loop_offsets>,
                             "(L + 1,) int32: loop i is [offsets[i], offsets[i + 1]).")
      .def_property_readonly("loop_sites", &clipped_array<&ClippedCells::loop_sites>,
                             "(L,) int32, ascending: outlines turn counter-clockwise, holes clockwise.")
      .def_property_readonly(
          "areas", &clipped_array<&ClippedCells::areas>,
          "(n,) float64: 0 outside, and for sites equal to an earlier one. They sum to the domain's.")
      .def_property_readonly("centroids", &clipped_centroids, "(n, 2) float64: not a number where the area is 0.")
      .def("__repr__", [](const ClippedCells& c) {
        return message("<saddleback.ClippedCells in ", c.loop_sites.size(), " loops>");
      });
  py::class_<Diagram>(m, "Voronoi2d", py::module_local(), "Voronoi diagram of the plane; made by `voronoi_2d`.")
      .def_property_readonly("sites", &rows<&Voronoi2d::sites, double>, "(n, 2) float64: as given.")
      .def_property_readonly("weights", &array<&Voronoi2d::weights>,
                             "(n,) float64: as given, or (0,) if they are equal.")
      .def_property_readonly("powers", &array<&Voronoi2d::powers>,
                             "(n,) float64: the weights of a power diagram as given, or (0,) of others.")
      .def_property_readonly("site_of", &array<&Voronoi2d::site_of>,
                             "(n,) int32: smallest index of an equal site; only such sites have a cell.")
      .def_property_readonly("hidden", &array<&Voronoi2d::hidden>,
                             "(h,) int32, ascending: sites without a cell, since heavier ones leave them none.")
      .def_property_readonly("vertices", &rows<&Voronoi2d::vertices, double>, "(V, 2) float64.")
      .def_property_readonly("edges", &rows<&Voronoi2d::edges, Index>,
                             "(E, 2) int32 vertices; -1 at infinity: (v, -1) is a ray, (-1, -1) a line.")
      .def_property_readonly("edge_sites", &rows<&Voronoi2d::edge_sites, Index>,
                             "(E, 2) int32: the sites left and right of the edge.")
      .def_property_readonly(
          "edge_directions", [](const Diagram& d) { return to_array(d.result.edge_directions()); },
          "(E, 2) float64 unit vectors from first to second vertex; of a ray outwards, where a curved one goes at "
          "last.")
      .def_property_readonly(
          "delaunay", [](const Diagram& d) { return to_array(without_gil([&] { return d.result.delaunay(); })); },
          "(T, 3) int32 sites, counter-clockwise: the Delaunay triangulation. Triangles about one vertex share its "
          "smallest site.")
      .def_property_readonly(
          "cells",
          [](const Diagram& d) {
            CellRows cells = without_gil([&] { return d.result.cells(); });
            return py::make_tuple(to_array(std::move(cells.offsets)), to_array(std::move(cells.vertices)));
          },
          "(n + 1,) int32 offsets and int32 vertices: the cell of site i is vertices[offsets[i]:offsets[i + 1]], "
          "counter-clockwise, -1 where it is open; empty for a site equal to an earlier one.")
      .def(
          "cell_vertices",
          [](const py::object& self, const py::object& site) {
            const Voronoi2d& d = py::cast<const Diagram&>(self).result;
            return view_of(d.cell_vertices(as_site(d, site)), self);
          },
          py::arg("site"), "(k,) int32: vertices around a site's cell, counter-clockwise; -1 where it is open.")
      .def(
          "cell_edges",
          [](const py::object& self, const py::object& site) {
            const Voronoi2d& d = py::cast<const Diagram&>(self).result;
            return view_of(d.cell_edges(as_site(d, site)), self);
          },
          py::arg("site"), "(k,) int32: edges around a site's cell; edge k leads to vertex k of `cell_vertices`.")
      .def_property_readonly(
          "areas", [](const Diagram& d) { return to_array(d.result.areas()); },
          "(n,) float64: areas of the cells, inf for open ones, 0 for hidden sites. Equal sites have the same cell.")
      .def_property_readonly(
          "centroids", [](const Diagram& d) { return to_array(d.result.centroids()); },
          "(n, 2) float64: centers of mass of the cells, not a number for open ones.")
      .def(
          "edge_polyline",
          [](const Diagram& d, const py::object& edge, const py::object& tolerance, const py::object& extent) {
            return to_array(d.result.edge_polyline(as_integer(edge, "edge"), as_real(tolerance, "tolerance"),
                                                   as_real(extent, "extent")));
          },
          py::arg("edge"), py::arg("tolerance"), py::arg("extent") = 0.0, k_polyline_doc)
      .def_property_readonly(
          "device", [](const Diagram& d) { return d.result.device_times ? "cuda" : "cpu"; },
          "The device that found the diagram: \"cpu\" or \"cuda\".")
      .def_property_readonly(
          "device_times",
          [](const Diagram& d) {
            return d.result.device_times ? py::object(as_dict(*d.result.device_times)) : py::none();
          },
          "Seconds of the device's part by its own clock (upload, order, find, unite, download), and the numbers of "
          "sites "
          "that took a second pass or the processor; None when no device found it.")
      .def_readonly("clipped", &Diagram::clipped, "ClippedCells within the domain given to `voronoi_2d`, or None.")
      .def(
          "clip",
          [](const Diagram& d, const py::object& polygon, const py::object& gap, const py::object& tolerance,
             const py::object& threads, const py::object& job) {
            const PlanarDomain domain = as_domain(polygon, "polygon");
            const ClipOptions options{.gap = as_real(gap, "gap"),
                                      .tolerance = as_real(tolerance, "tolerance"),
                                      .threads = as_integer(threads, "threads")};
            const JobIn token(job);
            return without_gil([&] { return d.result.clip(domain, options, {token, "Clipping cells"}); });
          },
          py::arg("polygon"), py::kw_only(), py::arg("gap") = 0.0, py::arg("tolerance") = 0.0, py::arg("threads") = 0,
          py::arg("job") = py::none(), k_clip_doc)
      .def(
          "locate",
          [](const Diagram& d, const py::object& points, const py::object& threads, const py::object& job) {
            const std::vector<Vec2> queries = as_points_2d(points, "points");
            const int count = as_integer(threads, "threads");
            const JobIn token(job);
            return to_array(without_gil([&] { return d.result.locate(queries, count, token); }));
          },
          py::arg("points"), py::kw_only(), py::arg("threads") = 0, py::arg("job") = py::none(), k_locate_doc)
      .def("__repr__", [](const Diagram& self) {
        const Voronoi2d& d = self.result;
        return message("<saddleback.Voronoi2d of ", d.cell_sites.size(), " cells, ", d.vertices.size(), " vertices>");
      });
  m.def("voronoi_2d", &find_diagram, py::arg("sites"), py::arg("weights") = py::none(), py::arg("domain") = py::none(),
        py::arg("circles") = 0, py::arg("threads") = 0, py::arg("device") = "auto", py::arg("job") = py::none(),
        py::kw_only(), py::arg("pinned") = false, k_doc);
  m.def("power_diagram_2d", &find_powers, py::arg("sites"), py::arg("weights"), py::arg("domain") = py::none(),
        py::kw_only(), py::arg("threads") = 0, py::arg("job") = py::none(), k_power_doc);
  let_travel<Diagram>(m, "Voronoi2d", &save_diagram, &load_diagram, 1);
}

}  // namespace saddleback::bindings
