#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "convert/convert.h"
#include "convert/devices.h"
#include "convert/points.h"
#include "geodesics/bind_queries.h"
#include "geodesics/graph_options.h"

namespace saddleback::bindings {
// Zero is the library's word for "not given".
SaddleVertexGraphOptions graph_options(const py::object& k, const py::object& accuracy) {
  SaddleVertexGraphOptions options;
  if (!k.is_none()) {
    options.k = as_integer(k, "k");
    if (options.k == 0) throw InputError("k: wanted at least 1 vertex per geodesic disk, got 0");
  }
  if (!accuracy.is_none()) {
    options.accuracy = as_real(accuracy, "accuracy");
    if (options.accuracy == 0) {
      throw InputError(
          "accuracy: wanted a relative error above 0 and below 1, got 0; exact=True gives exact "
          "distances");
    }
  }
  return options;
}

namespace {

std::unique_ptr<SaddleVertexGraph> make_graph(const py::object& mesh_object, const py::object& k,
                                              const py::object& accuracy, bool exact, const py::object& threads,
                                              const std::string& device, const std::string& instructions,
                                              const py::object& job, bool pinned) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  SaddleVertexGraphOptions options = graph_options(k, accuracy);
  options.exact = exact;
  options.threads = as_integer(threads, "threads");
  options.is_pinned = pinned;
  options.instructions = instructions;
  const JobIn token(job);
  return run_on(device, !exact && mesh.vertex_count() >= k_vertices_worth_a_device,
                [&](const std::vector<int>& devices) {
                  options.cuda_devices = devices;
                  return without_gil([&] { return std::make_unique<SaddleVertexGraph>(mesh, options, token); });
                });
}

void save(const SaddleVertexGraph& graph, const py::object& path, const py::object& job) {
  const std::string file = as_path(path, "path");
  const JobIn token(job);
  without_gil([&] { graph.save(file, token); });
}

py::object load(const py::object& path, const py::object& mesh_object, bool mmap, const py::object& job) {
  const std::string file = as_path(path, "path");
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const JobIn token(job);
  return keeping(mesh_object, without_gil([&] {
                   return mmap ? SaddleVertexGraph::open(file, mesh, token)
                               : SaddleVertexGraph::load(file, mesh, token);
                 }));
}

void check(const SaddleVertexGraph& graph, const py::object& job) {
  const JobIn token(job);
  without_gil([&] { graph.check_file(token); });
}

constexpr const char* k_graph_doc = R"(Saddle Vertex Graph: geodesic distances as shortest paths in a sparse graph.

Every vertex is linked to the vertices of its geodesic disk that it sees along one straight geodesic, and to its
neighbors. Arcs are real paths on the surface, so distances are never too short; the graph is symmetric to the bit.

Parameters
----------
mesh : Mesh
k : int, optional
    Vertices per geodesic disk, not counting the center; 1 to the mesh's vertex count. More is slower and more accurate:
    the mean error is about 0.4 % at 50 and 0.1 % at 100.
accuracy : float, optional
    Largest relative error of a distance that is accepted, above 0 and below 1. The mean error is far below. When none
    of k, accuracy and exact is given: 0.005.
exact : bool
    All straight geodesics, so that distances between vertices are exact. For small meshes: the graph has V^2 arcs where
    nothing is a saddle.
threads : int
    0: all cores. The result does not depend on it.
device : str
    "cpu"; "cuda", or "cuda:1" for the second CUDA device; "cuda:0,1" and "cuda:all" let several share the work; "auto"
    takes the first one where there is one and the mesh is large enough to gain by it, and the CPU otherwise. The result
    does not depend on it, to the bit.
instructions : str
    "auto", or one of "avx512", "avx2", "plain" and "neon" that the machine has. The result does not depend on it.
job : Job, optional
    Progress and cancellation.
pinned : bool
    Whether arcs come into memory that a CUDA device writes by itself, for one graph after the other: the first takes
    longer, the others gain a third of a millisecond and more. See `release_pinned_memory`.

Raises
------
InputError
    k below 1 or above the vertex count; accuracy not between 0 and 1; more than one of k, accuracy and exact; not
    enough memory for the exact graph (the message says how much it would take); an unknown device or instruction set.
DeviceError
    device="cuda" where there is no usable CUDA device or module, too little of its memory is free, or it fails; the
    message says why. Exact graphs are built on the CPU only.
Cancelled
    The job was cancelled.

Notes
-----
Time grows with V times the windows of a disk (about 250 for accuracy=0.005, 650 for k=100); 8 bytes an arc, about 55
arcs a vertex for accuracy=0.005. X. Ying, X. Wang, Y. He: Saddle Vertex Graph (SVG): A Novel Solution to the Discrete
Geodesic Problem, ACM Transactions on Graphics 32(6), 2013. Y. Adikusuma, Z. Fang, Y. He: Fast Construction of Discrete
Geodesic Graphs, ACM Transactions on Graphics 39(2), 2020.)";

constexpr const char* k_save_doc = R"(Write the graph to a file, without its mesh.

The file is written beside its place and moved there when it is whole: until then an old one stays as it was. Its bytes
depend on the graph alone.

Parameters
----------
path : str or os.PathLike
job : Job, optional

Raises
------
InputError
    The file cannot be written: no such folder, no permission, no space.
Cancelled
    The job was cancelled.

Notes
-----
O(arcs), 8 bytes an arc.)";

constexpr const char* k_load_doc = R"(Read a graph that `save` wrote for this very mesh.

Nothing in the file is taken on trust: a damaged one is refused, never loaded as something else.

Parameters
----------
path : str or os.PathLike
mesh : Mesh
    With the positions and triangles of the one that the graph was built for.
mmap : bool
    Map the file into memory instead of reading it: the system brings what queries read, and programs that map the same
    file share it. Rows of arcs are looked at when they are read first, so that a damaged file leads nowhere; what only
    the whole of it tells, `check` finds. The file may be replaced (not under Windows, as long as it is mapped), but must
    not be changed in place. Files of older versions are read.
job : Job, optional

Returns
-------
SaddleVertexGraph

Raises
------
InputError
    The file cannot be read, is no graph, is of a newer version, of another mesh, cut off or damaged.
Cancelled
    The job was cancelled.

Notes
-----
O(arcs), far less than building takes; O(V) with mmap, and pages of the file in place of memory.)";

constexpr const char* k_check_doc = R"(Check a graph that was loaded with mmap=True as if it had been read.

Its checksum is summed, and all of its numbers are looked at. Other graphs have been checked, or were built.

Parameters
----------
job : Job, optional

Raises
------
InputError
    The file is damaged.
Cancelled
    The job was cancelled.

Notes
-----
O(arcs).)";

}  // namespace

void bind_graph(py::module_& m) {
  py::class_<SaddleVertexGraph> type(m, "SaddleVertexGraph", py::module_local(), k_graph_doc);
  type.def(py::init(&make_graph), py::arg("mesh"), py::arg("k") = py::none(), py::kw_only(),
           py::arg("accuracy") = py::none(), py::arg("exact") = false, py::arg("threads") = 0,
           py::arg("device") = "auto", py::arg("instructions") = "auto", py::arg("job") = py::none(),
           py::arg("pinned") = false, py::keep_alive<1, 2>())
      .def("save", &save, py::arg("path"), py::kw_only(), py::arg("job") = py::none(), k_save_doc)
      .def_static("load", &load, py::arg("path"), py::arg("mesh"), py::kw_only(), py::arg("mmap") = false,
                  py::arg("job") = py::none(), k_load_doc)
      .def("check", &check, py::kw_only(), py::arg("job") = py::none(), k_check_doc)
      .def_property_readonly("mesh", &SaddleVertexGraph::mesh, py::return_value_policy::reference, "The Mesh.")
      .def_property_readonly("arc_count", &SaddleVertexGraph::arc_count, "Directed arcs; each has its reverse.")
      .def_property_readonly("mean_degree", &SaddleVertexGraph::mean_degree, "Arcs per vertex.")
      .def_property_readonly("nbytes", &SaddleVertexGraph::nbytes,
                             "Memory of the arcs, bytes; also of those that relaxations have made beside them.")
      .def_property_readonly(
          "k",
          [](const SaddleVertexGraph& graph) { return graph.k() > 0 ? py::object(py::int_(graph.k())) : py::none(); },
          "Vertices per geodesic disk; None when built otherwise.")
      .def_property_readonly(
          "accuracy",
          [](const SaddleVertexGraph& graph) {
            return graph.accuracy() > 0 ? py::object(py::float_(graph.accuracy())) : py::none();
          },
          "Largest relative error accepted; None when built otherwise.")
      .def_property_readonly("is_exact", &SaddleVertexGraph::is_exact, "True if distances between vertices are exact.")
      .def_property_readonly(
          "device", [](const SaddleVertexGraph& graph) { return graph.built_by_cuda() ? "cuda" : "cpu"; },
          "The device that found the arcs: \"cpu\" or \"cuda\".")
      .def_property_readonly(
          "device_times",
          [](const SaddleVertexGraph& graph) -> py::object {
            if (!graph.built_by_cuda()) return py::none();
            return as_dict(graph.device_times());
          },
          "Seconds of the device's part by its own clock (upload, find, unite, download), and the numbers of sources "
          "that were done in a second pass and by the processor; None when no device built it.")
      .def_property_readonly("build_seconds", &SaddleVertexGraph::build_seconds,
                             "Time of the build; 0 when it was loaded.")
      .def("__repr__", [](const SaddleVertexGraph& graph) {
        const std::string how = graph.is_exact() ? "exact"
                                : graph.k() > 0  ? message("k=", graph.k())
                                                 : message("accuracy=", graph.accuracy());
        return message("<saddleback.SaddleVertexGraph ", how, ", ", graph.arc_count(), " arcs>");
      });
  bind_queries(type);
  bind_neighbors(type);
}

}  // namespace saddleback::bindings
