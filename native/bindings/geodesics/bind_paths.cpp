// Curves on the surface, paths in the graph, log map and polar coordinates.

#include "saddleback/geodesics/curve_through.h"
#include "saddleback/geodesics/geodesic_paths.h"
#include "saddleback/geodesics/log_map.h"
#include "saddleback/geodesics/polar_coordinates.h"
#include "saddleback/geodesics/shortened_curve.h"
#include "saddleback/mesh/feature_curves.h"
#include "saddleback/mesh/surface_curve.h"

#include "convert/points.h"
#include "convert/state.h"

namespace saddleback::bindings {
namespace {

constexpr const char* k_curve_doc =
    R"(A polyline on the surface: straight between consecutive points, each pair of which shares a face. Immutable.

The points of a GeodesicPath or a TracedPath (`path.surface`) are such a curve.

Args:
    mesh: the mesh, kept alive by the curve.
    points: (n,) vertices or a SurfacePoints, n >= 2, in order; repeated points are harmless. A point within 1e-6
        (barycentric) of an edge counts as on it where its neighbor needs that.
    closed: the curve runs on from the last point to the first, which then need not be repeated.

Raises:
    InputError: fewer than two points, a point off the mesh, consecutive points that share no face (their indices are
        named), a curve without length.
)";

constexpr const char* k_paths_doc =
    R"(Many paths in flat arrays; also a sequence of GeodesicPath, each made when asked for.

Path i has the points `points[offsets[i]:offsets[i + 1]]`.
)";

constexpr const char* k_path_doc = R"(The path between two points, whose length is their distance in the graph.

Every arc is unfolded into the faces that it crosses: a polyline with one point for each edge crossed, straight in between,
that bends at vertices only. Consecutive points share a face. A shortest path bends at saddle vertices alone, with at
least pi on either side, as paths in an exact graph do; all other bends are what the graph is inexact by.

Args:
    a, b: a vertex or a point anywhere on the surface each.
    shorten: straighten those bends, to a local geodesic (straight to rounding, at least pi on either side of every
        vertex that it meets), which is never longer than the distance in the graph.
    job: progress and cancellation.

Raises:
    InputError: a point off the mesh; points on two components of the mesh, between which there is no path.
    Cancelled: the job was.

Notes:
    A distance field from `a`, then O(faces crossed); `paths` shares one field among many targets.
)";

constexpr const char* k_many_paths_doc = R"(Paths to many targets, each from its nearest source, by one distance field.

Args:
    sources, targets: vertices or SurfacePoints.
    shorten: as in `path`.
    threads: 0 for all cores; never changes the result.
    job: progress and cancellation.

Returns:
    GeodesicPaths in the order of the targets; a target that no source reaches has a path without points, of length inf
    and source -1.

Raises:
    InputError: no sources, a point off the mesh.
    Cancelled: the job was.
)";

constexpr const char* k_shorten_doc = R"(Pulls a curve tight on the surface, without leaving its homotopy class.

The ends of an open curve stay where they are. A closed curve becomes a closed geodesic, such as the ring about the
narrowest place of a neck, or contracts to a point where nothing holds it.

Args:
    curve: a SurfaceCurve.
    job: progress and cancellation.

Returns:
    GeodesicPath: straight but at vertices, which it passes with at least pi on either side (but at the boundary). The
    points of a closed curve are listed once: `SurfaceCurve(mesh, path.surface, closed=True)`. One that contracts is one
    point, of length 0.

Raises:
    InputError: no curve.
    Cancelled: the job was.

Notes:
    O(faces crossed) a step. As the edge flips of [sharp2020], on the faces themselves; closed curves in a strip of faces
    by the least value of a convex function.
)";

constexpr const char* k_through_doc = R"(The curve through points that may be far apart.

Shortest ways join them (`SaddleVertexGraph.path`, `shorten=True`) or, if it is to be smooth, cubic Bezier curves along the
bisector of the directions at each point.

Args:
    graph: the graph of the mesh.
    points: vertices or SurfacePoints, at least two (three, if closed), in order.
    closed: the curve runs on from the last point to the first.
    smooth: without corners at the points.
    halvings: 0 to 10; a smooth piece is drawn as 2^halvings pieces.
    job: progress and cancellation.

Returns:
    SurfaceCurve.

Raises:
    InputError: too few points, a point off the mesh, two neighbors that are the same or on different components (their
        indices are named), halvings out of range.
    Cancelled: the job was.

Notes:
    A distance field a point, then O(faces crossed) each time that a piece is halved.
)";

constexpr const char* k_bezier_doc = R"(The Bezier curve of control points on the surface.

De Casteljau's construction with shortest ways in place of straight lines: it begins and ends at the first and the last
point, in the directions of those next to them.

Args:
    graph: the graph of the mesh.
    controls: vertices or SurfacePoints, at least two, in order; four make a cubic curve.
    halvings: 0 to 10; the curve is drawn as 2^halvings pieces.
    job: progress and cancellation.

Returns:
    SurfaceCurve.

Raises:
    InputError: as `curve_through`.
    Cancelled: the job was.

Notes:
    A distance field a point, then O(faces crossed) each time that a piece is halved. After [morera2007], by halves as in [mancinelli2022]; ways stay in
    their homotopy class, so that the curve does not jump.
)";

constexpr const char* k_log_map_doc = R"(Length and direction of the shortest path to every vertex about a point.

Exact (window propagation, no graph involved). Shortest paths that bend at a saddle vertex all leave in the direction of
the path to it: such vertices are marked in `shadowed`. Every vertex has the coordinates of its shortest path; where there
are several (the cut locus: the far side of a sphere, the seam behind a bump) those of one of them, so that neighbors on
either side of it may lie far apart in the map.

`uv` is `distance` times the unit vector of the angle. Angles are measured as `trace` does: in the chart of the point's face
(corner 0 to corner 1 is 0) or, at a vertex, on the surface about it from its first edge. About an interior vertex they
are scaled in `uv` so that its total angle becomes 2 pi; `angle` holds them unscaled, as `trace` takes them.
A cone's tip or any other vertex with less than 2 pi throws such a seam: the two ways past it meet behind it.

Args:
    center: a vertex or one surface point; one within 1e-10 (barycentric) of a vertex is that vertex.
    radius: mesh units, above 0; inf for the whole component.
    job: progress and cancellation.

Raises:
    InputError: a point off the mesh, a radius that is not above 0.
    Cancelled: the job was.

Notes:
    O(n sqrt(n) log n) for n vertices within the radius.
)";

constexpr const char* k_exp_map_doc = R"(Returns where straightest geodesics from a point end: the inverse of `log_map`.

Args:
    center: a vertex or one surface point.
    uv: (n, 2) vectors as in `LogMap.uv`: length and (about a vertex scaled) direction of departure.
    threads: 0 for all cores; never changes the result.
    job: progress and cancellation.

Returns:
    SurfacePoints, n of them. A curve that the boundary stops ends there; it goes on along a straight border and past
    corners of it that it touches. Through vertices it goes on with half of the total angle on either side, unlike a shortest path that touches a saddle vertex: there alone, and where `log_map`
    says `shadowed`, the maps are not each other's inverse.

Raises:
    InputError: a point off the mesh, a vector that is not finite, a curve over more than a million faces.
    Cancelled: the job was.
)";

constexpr const char* k_polar_doc = R"(Coordinates along a curve for every vertex about it.

Exact: rays leave the curve at right angles to its segments and as fans from its bends. It may cross itself, double back,
run through vertices and along edges or the boundary. Where the nearest point of the curve is not unique (the cut locus)
one of them is taken, so that neighbors on either side of it may lie far apart; vertices on the curve itself have
distance 0 and the arc length where it first meets them. Behind a saddle vertex (`shadowed`) the foot is that of the way
there. Beyond the ends of an open curve the foot is its end, and left and right are told by the curve run straight on.

Args:
    graph: the graph of the mesh.
    curve: a SurfaceCurve, a GeodesicPath, or its points as a SurfacePoints or vertices (taken as an open curve).
    radius: mesh units, above 0; inf for everything that the curve reaches.
    job: progress and cancellation.

Raises:
    InputError: no curve, a curve of another mesh, a radius that is not above 0.
    Cancelled: the job was.

Notes:
    O(n sqrt(n) log n) for n vertices within the radius. After [ying2014] section 6.1, with exact rays instead of arc
    lengths along offset curves.
)";

/// A method for a class that another file binds.
template <class Function, class... Extra>
void add_method(py::module_& m, const char* type, const char* name, Function&& function, const Extra&... extra) {
  const py::object owner = m.attr(type);
  owner.attr(name) = py::cpp_function(std::forward<Function>(function), py::name(name), py::is_method(owner), extra...);
}

GeodesicPath path_between(const SaddleVertexGraph& graph, const py::object& a, const py::object& b, bool shorten,
                          const py::object& job) {
  const SurfacePoint from = as_surface_point(a, graph.mesh(), "a"), to = as_surface_point(b, graph.mesh(), "b");
  const JobIn token(job);
  return without_gil([&] { return shortest_path(graph, from, to, {.shorten = shorten}, token); });
}

GeodesicPaths paths_between(const SaddleVertexGraph& graph, const py::object& sources, const py::object& targets,
                            bool shorten, const py::object& threads, const py::object& job) {
  const SurfacePoints from = as_surface_points(sources, graph.mesh(), "sources");
  const SurfacePoints to = as_surface_points(targets, graph.mesh(), "targets");
  const PathOptions options{.shorten = shorten, .threads = as_integer(threads, "threads")};
  const JobIn token(job);
  return without_gil([&] { return shortest_paths(graph, from, to, options, token); });
}

GeodesicPath path_of(const GeodesicPaths& paths, const py::object& key) {
  const auto count = static_cast<std::int64_t>(paths.count());
  const std::int64_t i = as_integer(key, "index");
  // IndexError, not InputError: Python's iteration ends on it.
  if (i < -count || i >= count) throw py::index_error(message("index ", i, " is out of range for ", count, " paths"));
  return paths.path(static_cast<std::size_t>(i < 0 ? i + count : i));
}

template <class Owner, class T>
auto view_of_member(const std::vector<T> Owner::*member) {
  return [member](const py::object& self) {
    return view_of(std::span<const T>(py::cast<const Owner&>(self).*member), self);
  };
}

/// (n,) bool over bytes that are 0 or 1.
template <class Owner>
auto view_of_flags(const std::vector<std::uint8_t> Owner::*member) {
  return [member](const py::object& self) {
    return view_of(std::span<const std::uint8_t>(py::cast<const Owner&>(self).*member), self).attr("view")("bool");
  };
}

GeodesicPath shorten_curve(const py::object& curve, const py::object& job) {
  if (!py::isinstance<SurfaceCurve>(curve)) throw InputError("curve: wanted a SurfaceCurve");
  const auto& given = py::cast<const SurfaceCurve&>(curve);
  const JobIn token(job);
  return without_gil([&] { return shortened_curve(given, token); });
}

py::object through(const py::object& graph_object, const py::object& points, bool closed, bool smooth,
                   const py::object& halvings, const py::object& job) {
  const SaddleVertexGraph& graph = as_graph(graph_object);
  const SurfacePoints given = as_surface_points(points, graph.mesh(), "points");
  const CurveThroughOptions options{closed, smooth, as_integer(halvings, "halvings")};
  const JobIn token(job);
  return keeping(graph_object, without_gil([&] { return curve_through(graph, given, options, token); }));
}

py::object bezier(const py::object& graph_object, const py::object& controls, const py::object& halvings,
                  const py::object& job) {
  const SaddleVertexGraph& graph = as_graph(graph_object);
  const SurfacePoints given = as_surface_points(controls, graph.mesh(), "controls");
  const int wanted = as_integer(halvings, "halvings");
  const JobIn token(job);
  return keeping(graph_object, without_gil([&] { return bezier_curve(graph, given, wanted, token); }));
}

void bind_geodesic_paths(py::module_& m) {
  py::class_<GeodesicPaths>(m, "GeodesicPaths", py::module_local(), k_paths_doc)
      .def_property_readonly("points", view_of_member(&GeodesicPaths::points),
                             "(n, 3) float64: points of all paths in space.")
      .def_property_readonly(
          "surface", [](const GeodesicPaths& paths) { return paths.surface; }, "These points as a SurfacePoints.")
      .def_property_readonly("offsets", view_of_member(&GeodesicPaths::offsets), "(paths + 1,) int64.")
      .def_property_readonly("lengths", view_of_member(&GeodesicPaths::lengths),
                             "(paths,) float64: mesh units; inf where no source reaches.")
      .def_property_readonly("sources", view_of_member(&GeodesicPaths::sources),
                             "(paths,) int32: index of the source each begins at; -1 where none reaches.")
      .def("__len__", &GeodesicPaths::count)
      .def("__getitem__", &path_of)
      .def("__iter__",
           [](const py::object& self) { return py::reinterpret_steal<py::object>(PySeqIter_New(self.ptr())); })
      .def("__repr__", [](const GeodesicPaths& paths) {
        return message("<GeodesicPaths: ", paths.count(), " paths, ", paths.points.size(), " points>");
      });
  add_method(m, "SaddleVertexGraph", "path", &path_between, py::arg("a"), py::arg("b"), py::arg("shorten") = false,
             py::kw_only(), py::arg("job") = py::none(), k_path_doc);
  add_method(m, "SaddleVertexGraph", "paths", &paths_between, py::arg("sources"), py::arg("targets"),
             py::arg("shorten") = false, py::kw_only(), py::arg("threads") = 0, py::arg("job") = py::none(),
             k_many_paths_doc);
  m.def("curve_through", &through, py::arg("graph"), py::arg("points"), py::kw_only(), py::arg("closed") = false,
        py::arg("smooth") = false, py::arg("halvings") = k_default_halvings, py::arg("job") = py::none(),
        k_through_doc);
  m.def("bezier_curve", &bezier, py::arg("graph"), py::arg("controls"), py::kw_only(),
        py::arg("halvings") = k_default_halvings, py::arg("job") = py::none(), k_bezier_doc);
  m.def("shorten_curve", &shorten_curve, py::arg("curve"), py::kw_only(), py::arg("job") = py::none(), k_shorten_doc);
}

LogMap log_map_of(const SaddleVertexGraph& graph, const py::object& center, const py::object& radius,
                  const py::object& job) {
  const SurfacePoint point = as_surface_point(center, graph.mesh(), "center");
  const double wanted = as_real(radius, "radius");
  const JobIn token(job);
  return without_gil([&] { return log_map(graph, point, wanted, token); });
}

SurfacePoints exp_map_of(const py::object& mesh_object, const py::object& center, const py::object& uv,
                         const py::object& threads, const py::object& job) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const SurfacePoint point = as_surface_point(center, mesh, "center");
  const ArrayIn<double> vectors = as_points2(uv, "uv");
  const int wanted_threads = as_integer(threads, "threads");
  const JobIn token(job);
  std::vector<Vec2> rows(vectors.count);
  for (Index i = 0; i < vectors.count; ++i) rows[i] = {vectors.values[2 * i], vectors.values[2 * i + 1]};
  return without_gil([&] { return exp_map(mesh, point, rows, wanted_threads, token); });
}

PolarCoordinates polar_of(const py::object& graph_object, const py::object& curve, const py::object& radius,
                          const py::object& job) {
  const SaddleVertexGraph& graph = as_graph(graph_object);
  const double wanted = as_real(radius, "radius");
  const JobIn token(job);
  if (py::isinstance<SurfaceCurve>(curve)) {
    const auto& given = py::cast<const SurfaceCurve&>(curve);
    return without_gil([&] { return polar_coordinates(graph, given, wanted, token); });
  }
  SurfacePoints points = py::isinstance<GeodesicPath>(curve) ? py::cast<const GeodesicPath&>(curve).surface
                                                             : as_surface_points(curve, graph.mesh(), "curve");
  return without_gil([&] {
    return polar_coordinates(graph, SurfaceCurve(graph.mesh(), std::move(points), false, "curve"), wanted, token);
  });
}

void bind_maps(py::module_& m) {
  py::class_<LogMap>(m, "LogMap", py::module_local(), "Vertices about a point and the shortest ways to them.")
      .def_property_readonly("vertices", view_of_member(&LogMap::vertices), "(m,) int32: vertices, ascending.")
      .def_property_readonly(
          "uv",
          [](const py::object& self) {
            return view_of_rows<double>(std::span<const Vec2>(py::cast<const LogMap&>(self).uv), self);
          },
          "(m, 2) float64: distance times the unit vector of the scaled angle.")
      .def_property_readonly("distance", view_of_member(&LogMap::distance), "(m,) float64: mesh units.")
      .def_property_readonly("angle", view_of_member(&LogMap::angle),
                             "(m,) float64: direction of departure as `trace` takes it, radians; 0 at the center.")
      .def_property_readonly("shadowed", view_of_flags(&LogMap::shadowed),
                             "(m,) bool: the shortest path bends at a saddle vertex.")
      .def("__len__", [](const LogMap& map) { return map.vertices.size(); });
  py::class_<PolarCoordinates>(m, "PolarCoordinates", py::module_local(), "Vertices about a curve.")
      .def_property_readonly("vertices", view_of_member(&PolarCoordinates::vertices),
                             "(m,) int32: vertices, ascending.")
      .def_property_readonly("distance", view_of_member(&PolarCoordinates::distance),
                             "(m,) float64: mesh units; positive on the left of the curve, negative on its right.")
      .def_property_readonly("along", view_of_member(&PolarCoordinates::along),
                             "(m,) float64: arc length of the nearest point of the curve, 0 to its length (on a closed "
                             "curve less than it).")
      .def_property_readonly("shadowed", view_of_flags(&PolarCoordinates::shadowed),
                             "(m,) bool: the shortest path bends at a saddle vertex.")
      .def("__len__", [](const PolarCoordinates& polar) { return polar.vertices.size(); });
  add_method(m, "SaddleVertexGraph", "log_map", &log_map_of, py::arg("center"), py::arg("radius"), py::kw_only(),
             py::arg("job") = py::none(), k_log_map_doc);
  m.def("exp_map", &exp_map_of, py::arg("mesh"), py::arg("center"), py::arg("uv"), py::kw_only(),
        py::arg("threads") = 0, py::arg("job") = py::none(), k_exp_map_doc);
  m.def("polar_coordinates", &polar_of, py::arg("graph"), py::arg("curve"), py::arg("radius"), py::kw_only(),
        py::arg("job") = py::none(), k_polar_doc);
}

std::unique_ptr<SurfaceCurve> make_curve(const py::object& mesh_object, const py::object& points, bool closed) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  SurfacePoints given = as_surface_points(points, mesh, "points");
  return without_gil([&] { return std::make_unique<SurfaceCurve>(mesh, std::move(given), closed); });
}

constexpr const char* k_feature_doc = R"(The lines of a mesh that a remesh should keep, as a list of SurfaceCurve.

Edges at which the normals of the faces differ by more than `angle`, the boundary and the given edges are put together
to curves as long as can be: they end where not two but one or several of these edges meet, and where they turn by
more than `corner_angle`. Lines without such a place are closed. In the order of their first vertices.

Args:
    mesh: the Mesh.
    angle: radians, 0 to pi; pi finds no edge but those of the boundary and the given ones.
    boundary: whether the mesh's boundary is such a line.
    edges: (n, 2) vertices of more such edges.
    corner_angle: radians, 0 to pi.
    least_length: lines are left out where all that hang together are shorter, but for the boundary and the given edges:
        noise of scans, or details that a coarse remesh cannot show. About twice the size of a cell, for example.

For `centroidal_voronoi(curves=...)`, whose sites then stay on these lines. O(V + F).

Raises:
    InputError: an angle out of range; a length below 0; two vertices in `edges` that no edge joins.)";

py::list feature_curves_of(const py::object& mesh_object, const py::object& angle, bool boundary,
                           const py::object& edges, const py::object& corner_angle, const py::object& least_length) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  std::vector<std::array<Index, 2>> given;
  if (!edges.is_none()) {
    const ArrayIn<Index> rows = as_edges(edges, "edges");
    for (Index i = 0; i < rows.count; ++i) given.push_back({rows.values[2 * i], rows.values[2 * i + 1]});
  }
  FeatureCurveOptions options;
  options.angle = as_real(angle, "angle");
  options.boundary = boundary;
  options.edges = given;
  options.corner_angle = as_real(corner_angle, "corner_angle");
  options.least_length = as_real(least_length, "least_length");
  std::vector<SurfaceCurve> found = without_gil([&] { return feature_curves(mesh, options); });
  py::list result;
  for (SurfaceCurve& curve : found) result.append(keeping(mesh_object, std::move(curve)));
  return result;
}

py::tuple save_curve(const py::object& self) {
  const auto& curve = py::cast<const SurfaceCurve&>(self);
  const py::object mesh = py::cast(curve.mesh(), py::return_value_policy::reference);  // the object that it keeps alive
  return py::make_tuple(mesh, curve.points(), curve.closed());
}

void bind_curve(py::module_& m) {
  py::class_<SurfaceCurve>(m, "SurfaceCurve", py::module_local(), k_curve_doc)
      .def(py::init(&make_curve), py::arg("mesh"), py::arg("points"), py::arg("closed") = false, py::keep_alive<1, 2>())
      .def_property_readonly(
          "points", [](const SurfaceCurve& curve) { return curve.points(); }, "The points as a SurfacePoints.")
      .def_property_readonly("closed", &SurfaceCurve::closed, "True if the curve runs on to its first point.")
      .def_property_readonly("length", &SurfaceCurve::length, "Mesh units.")
      .def("__len__", [](const SurfaceCurve& curve) { return curve.points().size(); })
      .def("__repr__", [](const SurfaceCurve& curve) {
        return message("<SurfaceCurve: ", curve.points().size(), " points, ", curve.closed() ? "closed, " : "",
                       "length ", curve.length(), ">");
      });
  const FeatureCurveOptions defaults;
  m.def("feature_curves", &feature_curves_of, py::arg("mesh"), py::arg("angle") = defaults.angle, py::kw_only(),
        py::arg("boundary") = defaults.boundary, py::arg("edges") = py::none(),
        py::arg("corner_angle") = defaults.corner_angle, py::arg("least_length") = defaults.least_length,
        k_feature_doc);
  let_travel<SurfaceCurve>(m, "SurfaceCurve", &save_curve,
                           [](const py::tuple& state) { return py::type::of<SurfaceCurve>()(*as_state(state, 3)); });
}

}  // namespace

/// Runs after bind_surface and bind_graph, whose classes it extends.
void bind_paths(py::module_& m) {
  bind_curve(m);
  bind_geodesic_paths(m);
  bind_maps(m);
}

}  // namespace saddleback::bindings
