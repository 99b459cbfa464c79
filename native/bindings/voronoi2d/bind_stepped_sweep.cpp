// A sweep circle to be looked at.

#include "saddleback/voronoi2d/stepped_sweep.h"

#include "convert/planar.h"

namespace saddleback::bindings {
namespace {

using Event = SteppedSweep::Event;
using Edge = SteppedSweep::Edge;
using Arc = SteppedSweep::Arc;

SteppedSweep make(const py::object& sites, const py::object& center, const py::object& weights) {
  const std::vector<Vec2> points = as_points_2d(sites, "sites");
  const std::vector<double> radii = as_weights(weights, points.size());
  const ArrayIn<double> middle = as_reals(center, "center", 2);
  const JobIn token(py::none{});
  return without_gil([&] { return SteppedSweep(points, {middle.values[0], middle.values[1]}, radii, token); });
}

SweepCircles make_circles(const py::object& sites, const py::object& centers, const py::object& weights,
                          const py::object& domain) {
  const std::vector<Vec2> points = as_points_2d(sites, "sites"), middles = as_points_2d(centers, "centers");
  const std::vector<double> radii = as_weights(weights, points.size());
  std::optional<PlanarDomain> within;
  if (!domain.is_none()) within = as_domain(domain, "domain");
  const JobIn token(py::none{});
  return without_gil([&] { return SweepCircles(points, middles, radii, within ? &*within : nullptr, token); });
}

Index as_circle(const SweepCircles& sweep, const py::object& circle) {
  const Index k = as_integer(circle, "circle");
  if (k < 0 || k >= sweep.count()) throw InputError(message("circle: wanted 0 to ", sweep.count() - 1, ", got ", k));
  return k;
}

py::array point_array(const Vec2& point) { return to_array(std::vector<double>{point.x(), point.y()}); }

// Columns of the edges: ends, sites, whether finished.
py::tuple edge_arrays(const std::vector<Edge>& edges) {
  const py::ssize_t count = static_cast<py::ssize_t>(edges.size());
  py::array_t<double> ends(std::vector<py::ssize_t>{count, 2, 2});
  py::array_t<Index> sites(std::vector<py::ssize_t>{count, 2});
  py::array_t<bool> finished(count);
  double* end = ends.mutable_data();
  Index* site = sites.mutable_data();
  bool* is_finished = finished.mutable_data();
  for (const Edge& edge : edges) {
    for (const double value : {edge.begin.x(), edge.begin.y(), edge.end.x(), edge.end.y()}) *end++ = value;
    for (const Index i : edge.sites) *site++ = i;
    *is_finished++ = edge.is_finished;
  }
  return py::make_tuple(ends, sites, finished);
}

py::list arc_list(const std::vector<Arc>& arcs) {
  py::list result;
  for (const Arc& arc : arcs) result.append(py::make_tuple(arc.site, arc.begin, arc.end));
  return result;
}

py::list line_list(std::vector<std::vector<Vec2>> lines) {
  py::list result;
  for (std::vector<Vec2>& line : lines) result.append(to_array(std::move(line)));
  return result;
}

constexpr const char* k_doc = R"(A sweep circle, one event at a time, to be looked at.

The same step computes `voronoi_2d`, from centers of its own choice. Positions are rounded, and so is the order of nearly
simultaneous events. With weights, and where rounding would lose a vertex, the events are told from the diagram; hidden
sites have none, and a vertex of many cells is one event.

Parameters
----------
sites : (n, 2) float array
center : (2,) float array
    Anywhere: among the sites, outside, on one of them.
weights : (n,) float array, optional
    Radii of the sites. The circle touches a site sooner by its weight, at a radius below 0 when its disk holds the
    center.

Raises
------
InputError
    A coordinate that is not finite; what `voronoi_2d` refuses.

Notes
-----
O(n log n) to make and for the first step, O(1) expected for another.)";

constexpr const char* k_circles_doc = R"(Sweep circles that grow together, to be looked at.

Each grows about its own center until it has found the cells of the sites nearest to it, as much of them as lies in the
domain. Without a domain one with an open cell among these goes on to the last vertex; with one each circle does without
the events that the others tell.

Parameters
----------
sites : (n, 2) float array
centers : (m, 2) float array
weights : (n,) float array, optional
    Radii of the sites.
domain : (m, 2) float array or list of such, optional
    Corners of a polygon and of its holes: what of the plane is wanted.

Raises
------
InputError
    No center, a coordinate that is not finite; what `voronoi_2d` refuses, of a domain, too.

Notes
-----
O(m n log n) to make, O(m) for a step. Circles stop by theorem 3.3 of X. Ying: Parallel geodesic computing,
chapter 3, exactly: where the beach curve is around the cells.)";

constexpr const char* k_edges_doc =
    "(E, 2, 2) float64 ends, (E, 2) int32 sites, (E,) bool finished: the others grow at their end, or at both. After "
    "the last event there are as many as the diagram has.";

}  // namespace

void bind_stepped_sweep(py::module_& m) {
  py::class_<Event>(m, "SweepEvent", py::module_local(), "An event in a step of a SweepCircle.")
      .def_property_readonly(
          "kind", [](const Event& e) { return e.is_touch ? "touch" : "vanish"; },
          "\"touch\": the circle reached a site. \"vanish\": an arc shrank to a vertex.")
      .def_readonly("radius", &Event::radius, "Radius of the circle.")
      .def_property_readonly(
          "sites", [](const Event& e) { return to_array(std::vector<Index>(e.sites)); },
          "(1,) int32 the site touched, or those about the vertex, counter-clockwise: (3,), with weights or several "
          "circles also more.")
      .def_property_readonly(
          "point", [](const Event& e) { return point_array(e.point); }, "(2,) float64: the site, or the vertex.")
      .def("__repr__", [](const Event& e) {
        return message("<saddleback.SweepEvent ", e.is_touch ? "touch" : "vanish", " at radius ", e.radius, ">");
      });
  py::class_<SteppedSweep>(m, "SweepCircle", py::module_local(), k_doc)
      .def(py::init(&make), py::arg("sites"), py::arg("center"), py::arg("weights") = py::none())
      .def(
          "step",
          [](SteppedSweep& s) -> py::object {
            std::optional<Event> event = s.is_begun() ? s.step() : s.step(JobIn(py::none()));
            return event ? py::cast(std::move(*event)) : py::none();
          },
          "Go on to the next event and return it; None after the last.")
      .def(
          "grow",
          [](SteppedSweep& s, const py::object& radius) { s.grow(as_real(radius, "radius"), JobIn(py::none())); },
          py::arg("radius"), "Grow to a radius, through all events on the way; a smaller radius changes nothing.")
      .def_property_readonly("radius", &SteppedSweep::radius, "Radius of the circle.")
      .def_property_readonly(
          "center", [](const SteppedSweep& s) { return point_array(s.center()); }, "(2,) float64.")
      .def_property_readonly(
          "arcs", [](const SteppedSweep& s) { return arc_list(s.arcs()); },
          "List of (site, begin, end): ellipse arcs and their directions from the center, radians, counter-clockwise.")
      .def(
          "beach_curve",
          [](const SteppedSweep& s, const py::object& samples) {
            return to_array(s.beach_curve(as_integer(samples, "samples")));
          },
          py::arg("samples"),
          "(samples, 2) float64: points in directions equally far apart, up to 100,000; none before the start.")
      .def_property_readonly(
          "edges", [](const SteppedSweep& s) { return edge_arrays(s.edges()); }, k_edges_doc)
      .def(
          "edge_polylines",
          [](const SteppedSweep& s, const py::object& tolerance) {
            return line_list(s.edge_polylines(as_real(tolerance, "tolerance")));
          },
          py::arg("tolerance"),
          "List of (k, 2) float64: points along each of `edges`, within a tolerance; one finer than 1.5e-8 of the "
          "radius is "
          "taken as that.")
      .def("__repr__",
           [](const SteppedSweep& s) { return message("<saddleback.SweepCircle, radius ", s.radius(), ">"); });
  py::class_<SweepCircles>(m, "SweepCircles", py::module_local(), k_circles_doc)
      .def(py::init(&make_circles), py::arg("sites"), py::arg("centers"), py::arg("weights") = py::none(),
           py::kw_only(), py::arg("domain") = py::none())
      .def(
          "step",
          [](SweepCircles& s) -> py::object {
            std::optional<SweepCircles::Event> next = s.step();
            return next ? py::object(py::make_tuple(next->circle, std::move(next->event))) : py::none();
          },
          "Go on to the next event of any circle: (circle, event); None after the last.")
      .def(
          "grow", [](SweepCircles& s, const py::object& radius) { s.grow(as_real(radius, "radius")); },
          py::arg("radius"), "Grow all circles to a radius, through all events; a smaller radius changes nothing.")
      .def_property_readonly(
          "centers",
          [](const SweepCircles& s) { return to_array(std::vector(s.centers().begin(), s.centers().end())); },
          "(m, 2) float64.")
      .def_property_readonly(
          "radii",
          [](const SweepCircles& s) {
            std::vector<double> radii;
            for (Index k = 0; k < s.count(); ++k) radii.push_back(s.radius(k));
            return to_array(std::move(radii));
          },
          "(m,) float64: where each circle is, or stopped; -inf for one to which no site is nearest.")
      .def_property_readonly(
          "done",
          [](const SweepCircles& s) {
            py::array_t<bool> done(s.count());
            for (Index k = 0; k < s.count(); ++k) done.mutable_at(k) = s.is_done(k);
            return done;
          },
          "(m,) bool: circles that have closed their cells.")
      .def(
          "arcs",
          [](const SweepCircles& s, const py::object& circle) { return arc_list(s.arcs(as_circle(s, circle))); },
          py::arg("circle"), "List of (site, begin, end), as of a SweepCircle.")
      .def(
          "beach_curve",
          [](const SweepCircles& s, const py::object& circle, const py::object& samples) {
            return to_array(s.beach_curve(as_circle(s, circle), as_integer(samples, "samples")));
          },
          py::arg("circle"), py::arg("samples"), "(samples, 2) float64, as of a SweepCircle.")
      .def(
          "edges",
          [](const SweepCircles& s, const py::object& circle) { return edge_arrays(s.edges(as_circle(s, circle))); },
          py::arg("circle"), k_edges_doc)
      .def(
          "edge_polylines",
          [](const SweepCircles& s, const py::object& circle, const py::object& tolerance) {
            return line_list(s.edge_polylines(as_circle(s, circle), as_real(tolerance, "tolerance")));
          },
          py::arg("circle"), py::arg("tolerance"), "List of (k, 2) float64: points along each of `edges`.")
      .def("__repr__",
           [](const SweepCircles& s) { return message("<saddleback.SweepCircles, ", s.count(), " of them>"); });
}

}  // namespace saddleback::bindings
