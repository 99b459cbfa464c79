// Exact distances and shortest paths.

#include <limits>

#include "saddleback/geodesics/exact_distances.h"

#include "convert/convert.h"
#include "convert/points.h"

namespace saddleback::bindings {
namespace {

constexpr const char* k_distances_doc = R"(Distance of every vertex from the nearest source, exact up to rounding.

Right on flat and regular meshes, needles, boundaries and several components. For one field; a SaddleVertexGraph answers
many at a stated accuracy.

Parameters
----------
mesh : Mesh
sources : (n,) int array or SurfacePoints
    Vertices, or points anywhere on the surface.
limit : float
    Vertices farther than this stay at infinity, and what lies beyond costs no time. Mesh units.
job : Job, optional
    Progress and cancellation.

Returns
-------
(V,) float64 array
    Mesh units; inf where no source reaches.

Raises
------
InputError
    No sources, a source off the mesh, limit negative or not a number.
Cancelled
    The job was cancelled.

Notes
-----
One core; about O(V^1.5) time, some 600 bytes a vertex while it runs. J. Chen, Y. Han: Shortest paths on a polyhedron,
1990; S.-Q. Xin, G.-J. Wang: Improving Chen and Han's algorithm on the discrete geodesic problem, ACM Transactions on
Graphics 28(4), 2009.)";

constexpr const char* k_nearest_doc = R"(Returns exact distances, and which source is nearest.

Returns
-------
distance : (V,) float64 array
    Mesh units; inf where no source reaches.
source : (V,) int32 array
    Index into `sources`, -1 where none reaches; of those at the same distance, up to a relative 1e-12, the smallest.)";

constexpr const char* k_field_doc =
    R"(Exact distances at every point of the surface, not at the vertices alone, and the shortest paths.

Takes what exact_distances takes and raises what it raises. Keeps the windows of the propagation: about 40 bytes each,
20 to 150 of them a vertex of a scan, but as the root of the vertices on flat and smooth surfaces, a thousand each of a
million (nbytes tells). Raises InputError where memory is too small for them. Immutable.)";

constexpr const char* k_distance_to_doc = R"(Distance of any surface points from the nearest source.

Parameters
----------
points : (n,) int array or SurfacePoints
job : Job, optional

Returns
-------
(n,) float64 array
    Mesh units; inf where no source reaches.

Raises
------
InputError
    A point off the mesh.
Cancelled
    The job was cancelled.)";

constexpr const char* k_path_doc = R"(The shortest path from the nearest source to a point.

Straight within faces, bent only at saddle vertices and on the boundary, as long as the distance. O(faces crossed).

Parameters
----------
target : int or SurfacePoints
    One vertex or one surface point.

Returns
-------
GeodesicPath
    From the source to the target: a point for each edge or vertex that the path crosses.

Raises
------
InputError
    Not one point, a point off the mesh, a point that no source reaches.)";

py::array distances(const py::object& mesh_object, const py::object& sources, const py::object& limit,
                    const py::object& job) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const SurfacePoints points = as_surface_points(sources, mesh, "sources");
  const double reach = as_real(limit, "limit");
  const JobIn token(job);
  return to_array(without_gil([&] { return exact_distances(mesh, points, reach, token); }));
}

py::tuple nearest(const py::object& mesh_object, const py::object& sources, const py::object& limit,
                  const py::object& job) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const SurfacePoints points = as_surface_points(sources, mesh, "sources");
  const double reach = as_real(limit, "limit");
  const JobIn token(job);
  NearestField field = without_gil([&] { return exact_nearest(mesh, points, reach, token); });
  return py::make_tuple(to_array(std::move(field.distance)), to_array(std::move(field.source)));
}

std::unique_ptr<ExactField> make_field(const py::object& mesh_object, const py::object& sources,
                                       const py::object& job) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const SurfacePoints points = as_surface_points(sources, mesh, "sources");
  const JobIn token(job);
  return without_gil([&] { return std::make_unique<ExactField>(mesh, points, token); });
}

py::array distance_to(const ExactField& field, const py::object& points, const py::object& job) {
  const SurfacePoints targets = as_surface_points(points, field.mesh(), "points");
  const JobIn token(job);
  return to_array(without_gil([&] { return field.distance_to(targets, token); }));
}

GeodesicPath path(const ExactField& field, const py::object& target) {
  const SurfacePoint point = as_surface_point(target, field.mesh(), "target");
  return without_gil([&] { return field.path(point); });
}

py::list paths(const ExactField& field, const py::object& targets, const py::object& job) {
  const SurfacePoints points = as_surface_points(targets, field.mesh(), "targets");
  const JobIn token(job);
  std::vector<GeodesicPath> found = without_gil([&] { return field.paths(points, token); });
  py::list result;
  for (GeodesicPath& one : found) result.append(std::move(one));
  return result;
}

}  // namespace

void bind_exact(py::module_& m) {
  const auto infinity = std::numeric_limits<double>::infinity();
  m.def("exact_distances", &distances, py::arg("mesh"), py::arg("sources"), py::arg("limit") = infinity, py::kw_only(),
        py::arg("job") = py::none(), k_distances_doc);
  m.def("exact_nearest", &nearest, py::arg("mesh"), py::arg("sources"), py::arg("limit") = infinity, py::kw_only(),
        py::arg("job") = py::none(), k_nearest_doc);
  py::class_<ExactField>(m, "ExactField", py::module_local(), k_field_doc)
      .def(py::init(&make_field), py::arg("mesh"), py::arg("sources"), py::kw_only(), py::arg("job") = py::none(),
           py::keep_alive<1, 2>())
      .def_property_readonly(
          "distances",
          [](const py::object& self) { return view_of(py::cast<const ExactField&>(self).distances(), self); },
          "(V,) float64: distance of every vertex, mesh units; inf where no source reaches.")
      .def_property_readonly(
          "nearest", [](const py::object& self) { return view_of(py::cast<const ExactField&>(self).nearest(), self); },
          "(V,) int32: which source is nearest; -1 where none reaches, ties to the smaller index.")
      .def("distance_to", &distance_to, py::arg("points"), py::kw_only(), py::arg("job") = py::none(),
           k_distance_to_doc)
      .def("path", &path, py::arg("target"), k_path_doc)
      .def("paths", &paths, py::arg("targets"), py::kw_only(), py::arg("job") = py::none(),
           "`path` for several targets: a list of GeodesicPath. The first target that is wrong is named.")
      .def_property_readonly("window_count", &ExactField::window_count, "Windows propagated: the work done.")
      .def_property_readonly("nbytes", &ExactField::nbytes, "Memory of the field, bytes.")
      .def("__repr__", [](const ExactField& field) {
        return message("<saddleback.ExactField: ", field.distances().size(), " vertices, ", field.window_count(),
                       " windows>");
      });
}

}  // namespace saddleback::bindings
