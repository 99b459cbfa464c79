// A sweep circle to be looked at.

#include "saddleback/stepped_sweep.h"

#include "convert.h"

namespace saddleback::bindings {
namespace {

using Event = SteppedSweep::Event;
using Edge = SteppedSweep::Edge;
using Arc = SteppedSweep::Arc;

SteppedSweep make(const py::object& sites, const py::object& centre, const py::object& weights) {
  if (!weights.is_none()) throw InputError("weights: not supported yet");
  const ArrayIn<double> in = as_points2(sites, "sites");
  const ArrayIn<double> middle = as_reals(centre, "centre", 2);
  std::vector<Vec2> points(in.count);
  for (Index i = 0; i < in.count; ++i) points[i] = {in.values[2 * i], in.values[2 * i + 1]};
  return {points, {middle.values[0], middle.values[1]}};
}

py::array point_array(const Vec2& point) { return to_array(std::vector<double>{point.x(), point.y()}); }

// Columns of the edges: ends, sites, whether finished.
py::tuple edge_arrays(const SteppedSweep& sweep) {
  const std::vector<Edge> edges = sweep.edges();
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

constexpr const char* k_doc = R"(A sweep circle, one event at a time, to be looked at.

The same step computes `voronoi_2d`, from centres of its own choice. Positions are rounded, and so is the order of nearly
simultaneous events.

Parameters
----------
sites : (n, 2) float array
centre : (2,) float array
    Anywhere: among the sites, outside, on one of them.

Raises
------
InputError
    A coordinate that is not finite; what `voronoi_2d` refuses.

Notes
-----
O(n log n) to make, O(1) expected for a step.)";

}  // namespace

void bind_stepped_sweep(py::module_& m) {
  py::class_<Event>(m, "SweepEvent", py::module_local(), "What happened in a step of a SweepCircle.")
      .def_property_readonly(
          "kind", [](const Event& e) { return e.is_touch ? "touch" : "vanish"; },
          "\"touch\": the circle reached a site. \"vanish\": an arc shrank to a vertex.")
      .def_readonly("radius", &Event::radius, "Radius of the circle.")
      .def_property_readonly(
          "sites", [](const Event& e) { return to_array(std::vector<Index>(e.sites)); },
          "(1,) int32 the site touched, or (3,) those about the vertex, counter-clockwise.")
      .def_property_readonly(
          "point", [](const Event& e) { return point_array(e.point); }, "(2,) float64: the site, or the vertex.")
      .def("__repr__", [](const Event& e) {
        return message("<saddleback.SweepEvent ", e.is_touch ? "touch" : "vanish", " at radius ", e.radius, ">");
      });
  py::class_<SteppedSweep>(m, "SweepCircle", py::module_local(), k_doc)
      .def(py::init(&make), py::arg("sites"), py::arg("centre"), py::arg("weights") = py::none())
      .def(
          "step",
          [](SteppedSweep& s) -> py::object {
            std::optional<Event> event = s.step();
            return event ? py::cast(std::move(*event)) : py::none();
          },
          "Go on to the next event and return it; None after the last.")
      .def(
          "grow", [](SteppedSweep& s, const py::object& radius) { s.grow(as_real(radius, "radius")); },
          py::arg("radius"), "Grow to a radius, through all events on the way; a smaller radius changes nothing.")
      .def_property_readonly("radius", &SteppedSweep::radius, "Radius of the circle.")
      .def_property_readonly(
          "centre", [](const SteppedSweep& s) { return point_array(s.centre()); }, "(2,) float64.")
      .def_property_readonly(
          "arcs",
          [](const SteppedSweep& s) {
            py::list result;
            for (const Arc& arc : s.arcs()) result.append(py::make_tuple(arc.site, arc.begin, arc.end));
            return result;
          },
          "List of (site, begin, end): ellipse arcs and their directions from the centre, radians, counter-clockwise.")
      .def(
          "beach_curve",
          [](const SteppedSweep& s, const py::object& samples) {
            return to_array(s.beach_curve(as_integer(samples, "samples")));
          },
          py::arg("samples"), "(samples, 2) float64: points in directions equally far apart; none before the start.")
      .def_property_readonly(
          "edges", &edge_arrays,
          "(E, 2, 2) float64 ends, (E, 2) int32 sites, (E,) bool finished: the others grow at their end, or at both.")
      .def("__repr__",
           [](const SteppedSweep& s) { return message("<saddleback.SweepCircle, radius ", s.radius(), ">"); });
}

}  // namespace saddleback::bindings
