// Flat maps of surfaces, and plane diagrams brought to the surface by them.

#include "saddleback/charts/chart.h"
#include "saddleback/charts/disk_map.h"
#include "saddleback/charts/lifted_voronoi.h"

#include "convert/fields.h"
#include "convert/planar.h"
#include "convert/points.h"
#include "convert/state.h"

namespace saddleback::bindings {
namespace {

constexpr const char* k_harmonic_doc = R"(Places in the unit disk for the vertices of a disk-like surface.

The border goes once around the circle, every inner vertex to the weighted mean of its neighbors: no face flips.

Parameters
----------
mesh : Mesh
    One part with one border and no handles.
job : Job, optional

Returns
-------
(V, 2) float64 array

Raises
------
InputError
    The mesh is not a disk, or so long or deep that faces vanish in the rounding of doubles.
Cancelled
    The job was cancelled.

Notes
-----
O(V^1.5) time. Cotangent weights, raised where they are not positive. U. Pinkall, K. Polthier: Computing discrete
minimal surfaces and their conjugates, 1993. M. Floater: One-to-one piecewise linear mappings over triangulations, 2003.)";

constexpr const char* k_chart_doc = R"(A surface laid out in the plane: a UV map, of one or several islands. Immutable.

Parameters
----------
mesh : Mesh
uv : (V, 2) or (3 F, 2) float array
    A place for each vertex, or for each corner of each face in order.
job : Job, optional

Raises
------
InputError
    The wrong number of places, one that is not finite, a face that is flipped or without area in the plane, two faces
    that overlap by more than float32 rounding. Faces are named.
Cancelled
    The job was cancelled.

Notes
-----
O(F log F).)";

constexpr const char* k_lift_doc = R"(Brings a diagram of the plane to the surface: a LiftedVoronoi.

Each point of the surface gets the cell that its place lies in. Edges are cut at every mesh edge that they cross, end at
the map's border and may come in again.

Parameters
----------
diagram : Voronoi2d
    Of any kind; edges between weighted sites are polylines along the curves, by which their cells are divided.
tolerance : float
    In the plane: no point of a curved edge is farther from its polyline. 0: a thousandth of a mean cell's width.
threads : int
    0: all cores. The result does not depend on it.
job : Job, optional

Raises
------
InputError
    A diagram without sites, a tolerance that is negative.
Cancelled
    The job was cancelled.

Notes
-----
O((F + pieces) log F).)";

/// The pieces of the surface and the chart that they came by.
struct Lifted {
  LiftedVoronoi result;
  py::object chart;
  const Mesh& mesh() const { return py::cast<const Chart&>(chart).mesh(); }
};

py::tuple save_lifted(const py::object& self) {
  const auto& lifted = py::cast<const Lifted&>(self);
  return py::make_tuple(lifted.chart, state_of(lifted.result));
}

Lifted load_lifted(const py::tuple& state) {
  const py::tuple parts = as_state(state, 2);
  if (!py::isinstance<Chart>(parts[0])) refuse_state("a Chart", parts[0]);
  Lifted lifted{{}, parts[0]};
  restore(parts[1], lifted.result);
  return lifted;
}

template <auto Member>
py::array array(const py::object& self) {
  const auto& vector = py::cast<const Lifted&>(self).result.*Member;
  return view_of(std::span(vector), self);
}

SurfacePoints taken(const SurfacePoints& points, const std::vector<Index>& indices) {
  SurfacePoints result;
  for (const Index i : indices) result.push_back(points[i]);
  return result;
}

std::vector<Vec3> edge_positions(const LiftedVoronoi& lifted) {
  std::vector<Vec3> result;
  result.reserve(lifted.edge_points.size());
  for (const Index i : lifted.edge_points) result.push_back(lifted.positions[i]);
  return result;
}

py::tuple locate(const Chart& chart, const py::object& places, const py::object& threads, const py::object& job) {
  const std::vector<Vec2> where = as_points_2d(places, "places");
  const int count = as_integer(threads, "threads");
  const JobIn token(job);
  const SurfacePoints points = without_gil([&] { return chart.locate(where, count, token); });
  SurfacePoints found;
  py::array_t<bool> inside(static_cast<py::ssize_t>(points.size()));
  bool* flag = inside.mutable_data();
  for (const SurfacePoint& point : points) {
    *flag++ = point.face != k_none;
    if (point.face != k_none) found.push_back(point);
  }
  return py::make_tuple(std::move(found), inside);
}

void bind_lifted(py::module_& m) {
  py::class_<Lifted>(m, "LiftedVoronoi", py::module_local(), "A plane diagram on a surface; made by `Chart.lift`.")
      .def_property_readonly("areas", &array<&LiftedVoronoi::areas>,
                             "(n,) float64: of the cells, on the surface; they sum to the mesh's area.")
      .def_property_readonly(
          "centroids",
          [](const py::object& self) {
            return view_of_rows<double>(std::span(py::cast<const Lifted&>(self).result.centroids), self);
          },
          "(n, 2) float64: centers of mass in the plane, by area on the surface; not a number where that is 0.")
      .def_property_readonly("face_cell", &array<&LiftedVoronoi::face_cell>,
                             "(F,) int32: the cell of each face, -1 where several share it.")
      .def_property_readonly(
          "edge_points", [](const Lifted& l) { return to_array(edge_positions(l.result)); },
          "(m, 3) float64: the points of all edges' polylines, one after another.")
      .def_property_readonly(
          "edge_surface", [](const Lifted& l) { return taken(l.result.points, l.result.edge_points); },
          "These points as SurfacePoints; consecutive ones of a polyline share a face.")
      .def_property_readonly("edge_offsets", &array<&LiftedVoronoi::edge_offsets>,
                             "(e + 1,) int32: polyline i is [offsets[i], offsets[i + 1]).")
      .def_property_readonly("edge_of", &array<&LiftedVoronoi::edge_of>,
                             "(e,) int32: the diagram's edge of each polyline, ascending.")
      .def_property_readonly(
          "edge_cells",
          [](const py::object& self) {
            return view_of_rows<Index>(std::span(py::cast<const Lifted&>(self).result.edge_cells), self);
          },
          "(e, 2) int32: the cells on the left and on the right.")
      .def(
          "locate",
          [](const Lifted& l, const py::object& points) {
            const SurfacePoints where = as_surface_points(points, l.mesh(), "points");
            return to_array(without_gil([&] { return l.result.locate(l.mesh(), where); }));
          },
          py::arg("points"), "(m,) int32: the cell of each surface point. O(m log F).")
      .def(
          "split",
          [](const Lifted& l) {
            const Mesh& mesh = l.mesh();
            return without_gil([&] { return l.result.split(mesh); });
          },
          "Cut the mesh along the edges: a SplitMesh. O(V + F).")
      .def("__repr__", [](const Lifted& l) {
        return message("<saddleback.LiftedVoronoi of ", l.result.areas.size(), " cells, ", l.result.edge_of.size(),
                       " polylines>");
      });
}

void bind_chart(py::module_& m) {
  py::class_<Chart>(m, "Chart", py::module_local(), k_chart_doc)
      .def(py::init([](const py::object& mesh, const py::object& uv, const py::object& job) {
             const Mesh& surface = as_mesh(mesh, "mesh");
             const std::vector<Vec2> places = as_points_2d(uv, "uv");
             const JobIn token(job);
             return without_gil([&] { return std::make_unique<Chart>(surface, places, token); });
           }),
           py::arg("mesh"), py::arg("uv"), py::kw_only(), py::arg("job") = py::none(), py::keep_alive<1, 2>())
      .def_property_readonly(
          "corners",
          [](const py::object& self) { return view_of_rows<double>(py::cast<const Chart&>(self).corners(), self); },
          "(3 F, 2) float64: the place of each corner of each face.")
      .def_property_readonly("area", &Chart::area, "Area in the plane.")
      .def("locate", &locate, py::arg("places"), py::kw_only(), py::arg("threads") = 0, py::arg("job") = py::none(),
           "The surface points at places of the plane (m, 2): a SurfacePoints of those that there are, and (m,) bool "
           "saying which. O(m log F).")
      .def(
          "places",
          [](const Chart& chart, const py::object& points) {
            return to_rows<double>(chart.places(as_surface_points(points, chart.mesh(), "points")));
          },
          py::arg("points"), "(m, 2) float64: where surface points lie in the plane.")
      .def(
          "lift",
          [](const py::object& self, const py::object& diagram, const py::object& tolerance, const py::object& threads,
             const py::object& job) {
            const Chart& chart = py::cast<const Chart&>(self);
            const Voronoi2d& cells = as_voronoi_2d(diagram, "diagram");
            const LiftOptions options{.tolerance = as_real(tolerance, "tolerance"),
                                      .threads = as_integer(threads, "threads")};
            const JobIn token(job);
            return Lifted{without_gil([&] { return lift(chart, cells, options, token); }), self};
          },
          py::arg("diagram"), py::kw_only(), py::arg("tolerance") = 0.0, py::arg("threads") = 0,
          py::arg("job") = py::none(), k_lift_doc)
      .def("__repr__",
           [](const Chart& chart) { return message("<saddleback.Chart of ", chart.mesh().face_count(), " faces>"); });
}

}  // namespace

void bind_charts(py::module_& m) {
  bind_lifted(m);
  bind_chart(m);
  let_travel<Lifted>(m, "LiftedVoronoi", &save_lifted, &load_lifted);
  let_travel<Chart>(
      m, "Chart",
      [](const py::object& self) {
        const py::object mesh =
            py::cast(py::cast<const Chart&>(self).mesh(), py::return_value_policy::reference);  // that it keeps alive
        return py::make_tuple(mesh, self.attr("corners"));
      },
      [](const py::tuple& state) { return py::type::of<Chart>()(*as_state(state, 2)); });
  m.def(
      "harmonic_map",
      [](const py::object& mesh, const py::object& job) {
        const Mesh& surface = as_mesh(mesh, "mesh");
        const JobIn token(job);
        return to_rows<double>(without_gil([&] { return harmonic_map(surface, token); }));
      },
      py::arg("mesh"), py::kw_only(), py::arg("job") = py::none(), k_harmonic_doc);
}

}  // namespace saddleback::bindings
