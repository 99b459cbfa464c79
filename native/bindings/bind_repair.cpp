#include "saddleback/repair.h"

#include "convert.h"

namespace saddleback::bindings {
namespace {

py::tuple repair_arrays(const py::object& vertices, const py::object& triangles, const py::object& weld_distance,
                        const py::object& job) {
  const ArrayIn<double> xyz = as_points3(vertices, "vertices");
  const ArrayIn<Index> indices = as_triangles(triangles, "triangles");
  const double distance = as_real(weld_distance, "weld_distance");
  const JobIn watched(job);
  RepairResult result = without_gil([&] { return repair(xyz.values, indices.values, distance, watched); });
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
face, vertices of no face), welds vertices, splits non-manifold edges and vertices, orients the faces (outward where
closed; a surface without orientation, such as a Moebius strip, is cut along a seam) and mends faces without area so that
no crack opens. A good mesh whose vertices are all in different places comes back as it was.

Parameters
----------
vertices : array_like of shape (V, 3)
    Positions; any real number type.
triangles : array_like of shape (F, 3)
    Vertex indices of each face; any integer type.
weld_distance : float, default 0
    Vertices within this distance become one (in the unit of `vertices`); 0 welds those at exactly the same place.
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
O(n log n). Non-manifold edges are cut and stitched after Gueziec, Taubin, Lazarus and Horn (2001).)";

}  // namespace

void bind_repair(py::module_& m) {
  py::class_<RepairReport, std::shared_ptr<RepairReport>>(m, "RepairReport", py::module_local(),
                                                          "What a repair did; `str` of it is a sentence.")
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
      .def("__str__", &RepairReport::text)
      .def("__repr__", [](const RepairReport& report) { return "<saddleback.RepairReport: " + report.text() + ">"; });
  m.def("repair", &repair_arrays, py::arg("vertices"), py::arg("triangles"), py::arg("weld_distance") = 0.0,
        py::kw_only(), py::arg("job") = py::none(), k_repair_doc);
}

}  // namespace saddleback::bindings
