#include "saddleback/mesh/repair.h"

#include "convert/convert.h"

namespace saddleback::bindings {
namespace {

py::tuple repair_arrays(const py::object& vertices, const py::object& triangles, const py::object& weld_distance,
                        bool stitch, const py::object& fill_holes, const py::object& job) {
  const ArrayIn<double> xyz = as_points3(vertices, "vertices");
  const ArrayIn<Index> indices = as_triangles(triangles, "triangles");
  const JobIn watched(job);
  const RepairOptions options{as_real(weld_distance, "weld_distance"), stitch, as_integer(fill_holes, "fill_holes"),
                              watched};
  RepairResult result = without_gil([&] { return repair(xyz.values, indices.values, options); });
  return py::make_tuple(std::make_shared<Mesh>(std::move(result.mesh)),
                        std::make_shared<RepairReport>(std::move(result.report)));
}

py::dict changes_of(const RepairReport& report) {
  py::dict changes;
  for (const auto& [kind, count] : report.changes) changes[py::str(kind)] = count;
  return changes;
}

constexpr const char* k_repair_doc = R"(Make a valid mesh of nearly anything.

Drops what cannot be used (indices out of range, vertices that are not finite, faces that repeat a vertex or another
face, vertices of no face), welds vertices, splits non-manifold edges and vertices, orients the faces (the outermost
outward where closed, and what lies within with it; open ones so that not decidedly more of the back than of the front is
seen from outside; a surface without orientation, such as a Moebius strip, is cut along a seam) and mends faces without
area so that no crack opens. Borders that nearly meet are told in the report. A good mesh whose vertices are all in
different places comes back as it was.

Parameters
----------
vertices : array_like of shape (V, 3)
    Positions; any real number type.
triangles : array_like of shape (F, 3)
    Vertex indices of each face; any integer type.
weld_distance : float, default 0
    Vertices within this distance become one (in the unit of `vertices`); 0 welds those at exactly the same place.
stitch : bool, default False
    Divide border edges where vertices of other borders lie on them, or within `weld_distance`: T-junctions close.
fill_holes : int, default 0
    Fill border loops of up to so many edges, by the triangulation of least area; 2000 at most.
job : Job, optional
    Watched for progress and cancellation.

Returns
-------
mesh : Mesh
report : RepairReport
    What was done, and where each vertex and face went.

Raises
------
InputError
    An argument has the wrong shape, type or value.
MeshError
    No face is left.

Notes
-----
O(n log n), and O(h^3) for a hole of h edges. Non-manifold edges are cut and stitched after [gueziec2001], holes filled
after [barequet1995].)";

}  // namespace

void bind_repair(py::module_& m) {
  py::class_<RepairReport, std::shared_ptr<RepairReport>>(m, "RepairReport", py::module_local(),
                                                          "The changes of a repair; `str` of it is a sentence.")
      .def_property_readonly(
          "changes", &changes_of,
          "dict of str to int: how often each kind of change was made; kinds that did not occur are absent.")
      .def_property_readonly(
          "vertex_map",
          [](const py::object& self) {
            return view_of(std::span<const Index>(py::cast<const RepairReport&>(self).vertex_map), self);
          },
          "(old V,) int32: the new vertex (the first copy if it was split), or -1.")
      .def_property_readonly(
          "face_map",
          [](const py::object& self) {
            return view_of(std::span<const Index>(py::cast<const RepairReport&>(self).face_map), self);
          },
          "(old F,) int32: the new face (the first part if it was divided), or -1.")
      .def_property_readonly(
          "near_border_vertices", [](const RepairReport& report) { return report.close_borders.near_vertices; },
          "Border vertices of the mesh that came out that lie within 1e-4 of an edge from another border's vertex.")
      .def_property_readonly(
          "joining_distance", [](const RepairReport& report) { return report.close_borders.weld_distance; },
          "The weld distance that would join these, in the unit of the vertices; 0 where there are none.")
      .def_property_readonly(
          "t_junctions", [](const RepairReport& report) { return report.close_borders.vertices_amid_edges; },
          "Border vertices that lie as near to the inside of another border's edge; ``stitch=True`` joins them.")
      .def("__str__", &RepairReport::text)
      .def("__repr__", [](const RepairReport& report) { return "<saddleback.RepairReport: " + report.text() + ">"; });
  m.def("repair", &repair_arrays, py::arg("vertices"), py::arg("triangles"), py::arg("weld_distance") = 0.0,
        py::kw_only(), py::arg("stitch") = false, py::arg("fill_holes") = 0, py::arg("job") = py::none(), k_repair_doc);
}

}  // namespace saddleback::bindings
