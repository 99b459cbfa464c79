// Curves on the surface, paths in the graph, log map and polar coordinates.

#include "saddleback/geodesic_paths.h"
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

constexpr const char* k_paths_doc =
    R"(Many paths in flat arrays; also a sequence of GeodesicPath, each made when asked for.

Path i has the points `points[offsets[i]:offsets[i + 1]]`.
)";

constexpr const char* k_path_doc = R"(The path between two points, whose length is their distance in the graph.

Every arc is unfolded into the faces that it crosses: a polyline with one point for each edge crossed, straight in between,
that bends at vertices only. At saddle vertices it is legal (at least pi on either side); bends at other vertices are
what the graph is inexact by. Consecutive points share a face.

Args:
    a, b: a vertex or a point anywhere on the surface each.
    shorten: straighten those bends too, to a local geodesic, which is never longer than the distance in the graph.
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

/// A method for a class that another file binds.
template <class Function, class... Extra>
void add_method(py::module_& m, const char* type, const char* name, Function&& function, const Extra&... extra) {
  const py::object owner = m.attr(type);
  owner.attr(name) = py::cpp_function(std::forward<Function>(function), py::name(name), py::is_method(owner), extra...);
}

GeodesicPath path_between(const SaddleVertexGraph& graph, const py::object& a, const py::object& b, bool shorten,
                          const py::object& job) {
  const SurfacePoint from = as_surface_point(a, graph.mesh(), "a"), to = as_surface_point(b, graph.mesh(), "b");
  Job* const token = as_job(job);
  return without_gil([&] { return shortest_path(graph, from, to, {.shorten = shorten}, token); });
}

GeodesicPaths paths_between(const SaddleVertexGraph& graph, const py::object& sources, const py::object& targets,
                            bool shorten, const py::object& threads, const py::object& job) {
  const SurfacePoints from = as_surface_points(sources, graph.mesh(), "sources");
  const SurfacePoints to = as_surface_points(targets, graph.mesh(), "targets");
  const PathOptions options{.shorten = shorten, .threads = as_integer(threads, "threads")};
  Job* const token = as_job(job);
  return without_gil([&] { return shortest_paths(graph, from, to, options, token); });
}

GeodesicPath path_of(const GeodesicPaths& paths, const py::object& key) {
  const auto count = static_cast<std::int64_t>(paths.count());
  const std::int64_t i = as_integer(key, "index");
  // IndexError, not InputError: Python's iteration ends on it.
  if (i < -count || i >= count) throw py::index_error(message("index ", i, " is out of range for ", count, " paths"));
  return paths.path(static_cast<std::size_t>(i < 0 ? i + count : i));
}

template <class T>
auto viewed(const std::vector<T> GeodesicPaths::*member) {
  return [member](const py::object& self) {
    return view_of(std::span<const T>(py::cast<const GeodesicPaths&>(self).*member), self);
  };
}

void bind_geodesic_paths(py::module_& m) {
  py::class_<GeodesicPaths>(m, "GeodesicPaths", py::module_local(), k_paths_doc)
      .def_property_readonly("points", viewed(&GeodesicPaths::points), "(n, 3) float64: points of all paths in space.")
      .def_property_readonly(
          "surface", [](const GeodesicPaths& paths) { return paths.surface; }, "The same points as a SurfacePoints.")
      .def_property_readonly("offsets", viewed(&GeodesicPaths::offsets), "(paths + 1,) int64.")
      .def_property_readonly("lengths", viewed(&GeodesicPaths::lengths),
                             "(paths,) float64: mesh units; inf where no source reaches.")
      .def_property_readonly("sources", viewed(&GeodesicPaths::sources),
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
}

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

/// After bind_surface and bind_graph, whose classes it extends.
void bind_paths(py::module_& m) {
  bind_curve(m);
  bind_geodesic_paths(m);
}

}  // namespace saddleback::bindings
