// Questions to the graph: distance fields, nearest sources, distances between points.

#include "geodesics/bind_queries.h"

#include <limits>
#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"
#include "saddleback/mesh/surface_curve.h"

#include "convert/devices.h"
#include "convert/points.h"

namespace saddleback::bindings {
namespace {

/// Sources of an argument, and the Python curves among them, which must live as long.
struct SourcesIn {
  QuerySources sources{SurfacePoints{}};
  std::vector<py::object> owners;
};

void add_curve(SourcesIn& result, const py::object& value, const Mesh& mesh, const std::string& name) {
  if (!py::isinstance<SurfaceCurve>(value))
    throw InputError(message(name, ": wanted a SurfaceCurve like the others, got a ",
                             py::cast<std::string>(py::type::of(value).attr("__name__"))));
  const auto& curve = py::cast<const SurfaceCurve&>(value);
  if (&curve.mesh() != &mesh && curve.mesh().fingerprint() != mesh.fingerprint())
    throw InputError(message(name, ": the curve lies on another mesh than the graph's"));
  result.sources.curves.push_back(&curve);
  result.owners.push_back(value);
}

/// Vertices, a SurfacePoints, a SurfaceCurve, or a sequence of SurfaceCurves.
SourcesIn as_sources(const py::object& value, const Mesh& mesh, const char* argument) {
  SourcesIn result;
  if (py::isinstance<SurfaceCurve>(value)) {
    add_curve(result, value, mesh, argument);
    return result;
  }
  const bool is_list = py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value);
  const py::sequence items = is_list ? py::cast<py::sequence>(value) : py::sequence(py::list());
  if (items.size() > 0 && py::isinstance<SurfaceCurve>(items[0])) {
    for (std::size_t i = 0; i < items.size(); ++i) add_curve(result, items[i], mesh, message(argument, "[", i, "]"));
    return result;
  }
  result.sources.points = as_surface_points(value, mesh, argument);
  return result;
}

QueryOptions query_options(const py::object& limit, const std::string& method) {
  QueryOptions options{.limit = as_real(limit, "limit")};
  if (method == "dijkstra") {
    options.method = QueryMethod::dijkstra;
  } else if (method != "label_correcting") {
    throw InputError(message("method: wanted 'label_correcting' or 'dijkstra', got '", method, "'"));
  }
  return options;
}

/// Runs work(options) where `device` says. "auto" takes a CUDA device where the graph was built by one or is kept
/// there, and for many fields.
template <class Work>
auto search_on(const std::string& device, const SaddleVertexGraph& graph, QueryOptions options, std::size_t field_count,
               Work&& work) {
  constexpr std::size_t k_many = 8;
  const bool are_many = field_count >= k_many && graph.mesh().vertex_count() >= k_vertices_worth_a_device;
  const bool is_dijkstra = options.method == QueryMethod::dijkstra;
  return run_on(device, !is_dijkstra && (are_many || is_search_worth_a_device(graph)),
                [&](const std::vector<int>& devices) {
                  if (!devices.empty() && is_dijkstra)
                    throw InputError("method: 'dijkstra' runs on the processor only; wanted device='cpu'");
                  options.cuda_device = first_device(devices);
                  return without_gil([&] { return work(options); });
                });
}

py::array distances(const SaddleVertexGraph& graph, const py::object& sources, const py::object& limit,
                    const std::string& method, const std::string& device, const py::object& job) {
  const SourcesIn from = as_sources(sources, graph.mesh(), "sources");
  const JobIn token(job);
  return to_array(search_on(device, graph, query_options(limit, method), 1, [&](const QueryOptions& options) {
    return graph.distances(from.sources, options, token);
  }));
}

py::tuple nearest(const SaddleVertexGraph& graph, const py::object& sources, const py::object& limit,
                  const std::string& method, const std::string& device, const py::object& job) {
  const SourcesIn from = as_sources(sources, graph.mesh(), "sources");
  const JobIn token(job);
  NearestField field = search_on(device, graph, query_options(limit, method), 1, [&](const QueryOptions& options) {
    return graph.nearest(from.sources, options, token);
  });
  return py::make_tuple(to_array(std::move(field.distance)), to_array(std::move(field.source)));
}

py::array fields(const SaddleVertexGraph& graph, const py::object& sources, const py::object& limit,
                 const py::object& threads, const std::string& device, const py::object& job) {
  const SourcesIn from = as_sources(sources, graph.mesh(), "sources");
  const Index thread_count = as_integer(threads, "threads");
  const JobIn token(job);
  DistanceFields result =
      search_on(device, graph, query_options(limit, "label_correcting"), from.sources.size(),
                [&](const QueryOptions& options) { return graph.fields(from.sources, options, thread_count, token); });
  double* const values = result.values.release();
  const py::capsule owner(values, [](void* p) { delete[] static_cast<double*>(p); });
  return py::array_t<double>({static_cast<py::ssize_t>(result.count), static_cast<py::ssize_t>(result.vertex_count)},
                             values, owner);
}

PointDistance measure(const SaddleVertexGraph& graph, const py::object& a, const py::object& b, const py::object& job) {
  const SurfacePoint from = as_surface_point(a, graph.mesh(), "a"), to = as_surface_point(b, graph.mesh(), "b");
  const JobIn token(job);
  return without_gil([&] { return graph.distance(from, to, token); });
}

double distance(const SaddleVertexGraph& graph, const py::object& a, const py::object& b, const py::object& job) {
  return measure(graph, a, b, job).distance;
}

py::tuple search_size(const SaddleVertexGraph& graph, const py::object& a, const py::object& b) {
  const PointDistance found = measure(graph, a, b, py::none());
  return py::make_tuple(found.distance, found.settled);
}

py::array distances_to(const SaddleVertexGraph& graph, const py::object& sources, const py::object& targets,
                       const py::object& job) {
  const SourcesIn from = as_sources(sources, graph.mesh(), "sources");
  const SurfacePoints to = as_surface_points(targets, graph.mesh(), "targets");
  const JobIn token(job);
  return to_array(without_gil([&] { return graph.distances_to(from.sources, to, token); }));
}

constexpr const char* k_distances_doc = R"(Distance of every vertex from the nearest source.

Parameters
----------
sources : (n,) int array, SurfacePoints, SurfaceCurve or a sequence of SurfaceCurves
    Vertices, points anywhere on the surface (linked to the graph by a window propagation each), or curves: then it is
    the distance to the curve itself, not to its points.
limit : float
    Vertices farther than this stay at infinity. Mesh units.
method : str
    "label_correcting" (buckets) or "dijkstra" (heap): the same bits, at different speeds.
device : str
    "cpu"; "cuda", or "cuda:1" for the second CUDA device, which keeps the graph's arcs from then on (of several that
    are named, the first); "auto" takes the first one for graphs that were built by one or are kept by one. The result
    does not depend on it, to the bit.
job : Job, optional

Returns
-------
(V,) float64 array
    Mesh units; inf where no source reaches.

Raises
------
InputError
    No sources, a source off the mesh, limit negative or not a number, an unknown method or device.
DeviceError
    device="cuda" where there is no usable CUDA device or module, too little of its memory is free, or it fails.
Cancelled
    The job was cancelled.

Notes
-----
O(arcs): well below a microsecond a vertex.)";

constexpr const char* k_nearest_doc = R"(Distance of every vertex from the nearest source, and which source it is.

Takes what `distances` takes.

Returns
-------
distance : (V,) float64 array
    Mesh units; inf where no source reaches.
source : (V,) int32 array
    Index into `sources`, -1 where none reaches; ties go to the smaller index.)";

constexpr const char* k_fields_doc = R"(A distance field for every source alone, over threads.

Parameters
----------
sources, limit
    As `distances` takes them; each point and each curve is a source.
threads : int
    0: all cores. The result does not depend on it.
device : str
    As `distances`; "auto" also takes the device for eight fields and more.
job : Job, optional

Returns
-------
(n, V) float64 array
    Row i is `distances` of source i.

Raises
------
InputError
    As `distances`; more fields than there is memory for (8 n V bytes).
Cancelled
    The job was cancelled.)";

constexpr const char* k_distance_doc = R"(Distance between two points, by A*.

Parameters
----------
a, b : int or SurfacePoints
    A vertex or one point of the surface each.
job : Job, optional

Returns
-------
float
    Mesh units; the same bits as `distances([a])[b]`, `distances_to(a, b)` and `distance(b, a)`. inf between points of
    different components.

Raises
------
InputError
    A point off the mesh, or not one point.
Cancelled
    The job was cancelled.

Notes
-----
Distances to sixteen landmarks bound what is left of a path [goldberg2005], so that few vertices are looked at. The
first call finds the landmarks: the time of 17 fields, 64 bytes a vertex.)";

constexpr const char* k_distances_to_doc = R"(Distance of every target from the nearest source.

Parameters
----------
sources : (n,) int array, SurfacePoints, SurfaceCurve or a sequence of SurfaceCurves
targets : (m,) int array or SurfacePoints
    Vertices, or points anywhere on the surface.
job : Job, optional

Returns
-------
(m,) float64 array
    Mesh units; inf where no source reaches. Between two points the same bits in both directions.

Raises
------
InputError
    No sources, a point off the mesh.
Cancelled
    The job was cancelled.

Notes
-----
A field, and for each point inside a face a window propagation of its own; points near each other are joined by their
straight geodesic. After [ying2014] section 4.4.4.)";

}  // namespace

void bind_queries(py::class_<SaddleVertexGraph>& graph) {
  const auto infinity = std::numeric_limits<double>::infinity();
  const auto job = [] { return py::arg("job") = py::none(); };
  const auto device = [] { return py::arg("device") = "auto"; };
  graph
      .def("distances", &distances, py::arg("sources"), py::arg("limit") = infinity,
           py::arg("method") = "label_correcting", py::kw_only(), device(), job(), k_distances_doc)
      .def("nearest", &nearest, py::arg("sources"), py::arg("limit") = infinity, py::arg("method") = "label_correcting",
           py::kw_only(), device(), job(), k_nearest_doc)
      .def("fields", &fields, py::arg("sources"), py::arg("limit") = infinity, py::kw_only(), py::arg("threads") = 0,
           device(), job(), k_fields_doc)
      .def_property_readonly(
          "query_times",
          [](const SaddleVertexGraph& self) -> py::object {
            const std::optional<DeviceTimes> times = self.query_times();
            return times ? py::object(as_dict(*times)) : py::none();
          },
          "Seconds of the last query by a CUDA device, by its own clock (upload, find, unite, download); None when "
          "there "
          "was none.")
      .def("distance", &distance, py::arg("a"), py::arg("b"), py::kw_only(), job(), k_distance_doc)
      .def("_distance_and_settled", &search_size, py::arg("a"), py::arg("b"),
           "The distance and how many vertices its search expanded; for tests and benchmarks.")
      .def("distances_to", &distances_to, py::arg("sources"), py::arg("targets"), py::kw_only(), job(),
           k_distances_to_doc);
}

}  // namespace saddleback::bindings
