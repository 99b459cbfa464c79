// Python: the graph opened.

#include "saddleback/geodesics/graph_neighbors.h"

#include "convert/convert.h"
#include "geodesics/bind_queries.h"

namespace saddleback::bindings {
namespace {

constexpr const char* k_neighbors_doc = R"(The vertices that one is linked to.

Parameters
----------
vertex : int

Returns
-------
tuple of (n,) int32, (n,) float64, (n,) float64
    Vertices, ascending; lengths of the arcs to them, mesh units; angles in which the arcs leave, radians, as `trace`
    takes them.

Raises
------
InputError
    A vertex out of range.

Notes
-----
O(degree times faces crossed): each arc is unfolded again for its angle.)";

constexpr const char* k_arcs_doc = R"(All arcs in compressed sparse rows, as SciPy's and others' graphs take them.

``scipy.sparse.csr_matrix((lengths, targets, offsets))`` is the matrix of the graph's lengths.

Parameters
----------
job : Job, optional
    Watched for progress and cancellation.

Returns
-------
tuple of (V + 1,) int64, (arc_count,) int32, (arc_count,) float64
    Offsets: the arcs of vertex v are ``offsets[v]`` to ``offsets[v + 1]``; targets, ascending within each; lengths, mesh
    units, equal to the bit for an arc and its reverse.

Notes
-----
O(arcs log degree); copies of 12 bytes an arc.)";

py::tuple neighbors(const SaddleVertexGraph& graph, const py::object& vertex) {
  const Index wanted = as_integer(vertex, "vertex");
  GraphNeighbors found = without_gil([&] { return graph_neighbors(graph, wanted); });
  return py::make_tuple(to_array(std::move(found.vertices)), to_array(std::move(found.lengths)),
                        to_array(std::move(found.angles)));
}

py::tuple arcs(const SaddleVertexGraph& graph, const py::object& job) {
  const JobIn watched(job);
  GraphArcs found = without_gil([&] { return graph_arcs(graph, watched); });
  return py::make_tuple(to_array(std::move(found.offsets)), to_array(std::move(found.targets)),
                        to_array(std::move(found.lengths)));
}

py::dict tiers(const SaddleVertexGraph& graph) {
  const ArcTiers found = without_gil([&] { return arc_tiers(graph); });
  py::dict counts;
  counts["S-S"] = found.between_saddles;
  counts["N-S"] = found.to_saddles;
  counts["N-N"] = found.between_others;
  return counts;
}

}  // namespace

void bind_neighbors(py::class_<SaddleVertexGraph>& graph) {
  graph.def("neighbors", &neighbors, py::arg("vertex"), k_neighbors_doc)
      .def("arcs", &arcs, py::kw_only(), py::arg("job") = py::none(), k_arcs_doc)
      .def_property_readonly(
          "tiers", &tiers,
          "dict of str to int: arcs by their ends, each counted once: \"S-S\" between saddle vertices, "
          "\"N-S\" from one to another vertex, \"N-N\" between others [ying2013]. O(arcs).");
}

}  // namespace saddleback::bindings
