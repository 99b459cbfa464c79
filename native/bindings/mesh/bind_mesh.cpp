#include "saddleback/geodesics/graph_neighbors.h"
#include "saddleback/mesh/mesh.h"

#include "convert/convert.h"

namespace saddleback::bindings {
namespace {

std::shared_ptr<Mesh> make_mesh(const py::object& vertices, const py::object& triangles, const py::object& lengths,
                                const py::object& job) {
  const ArrayIn<double> xyz = as_points(vertices, "vertices");
  const ArrayIn<Index> indices = as_triangles(triangles, "triangles");
  MeshMetric metric{.dimension = static_cast<int>(xyz.array.shape(1))};
  ArrayIn<double> given;
  if (!lengths.is_none()) {
    given = as_sides(lengths, "lengths", indices.count);
    metric.lengths = given.values;
  }
  const JobIn watched(job);
  return without_gil([&] { return std::make_shared<Mesh>(xyz.values, indices.values, metric, watched); });
}

const Mesh& mesh_of(const py::object& self) { return py::cast<const Mesh&>(self); }

py::list boundary_loops(const py::object& self) {
  py::list result;
  for (const std::vector<Index>& loop : mesh_of(self).boundary_loops())
    result.append(view_of(std::span<const Index>(loop), self));
  return result;
}

py::array edges(const Mesh& mesh) {
  std::vector<std::array<Index, 2>> ends;
  ends.reserve(static_cast<std::size_t>(mesh.edge_count()));
  for (const Index h : mesh.edge_halfedges()) ends.push_back({mesh.from(h), mesh.to(h)});
  return read_only(to_rows<Index>(std::move(ends)));
}

py::array edge_lengths(const Mesh& mesh) {
  std::vector<double> lengths;
  lengths.reserve(static_cast<std::size_t>(mesh.edge_count()));
  for (const Index h : mesh.edge_halfedges()) lengths.push_back(mesh.length(h));
  return read_only(to_array(std::move(lengths)));
}

std::string describe(const Mesh& mesh) {
  const std::size_t loops = mesh.boundary_loops().size();
  return message("<saddleback.Mesh: ", mesh.vertex_count(), " vertices, ", mesh.face_count(), " faces, ",
                 mesh.component_count(), mesh.component_count() == 1 ? " component" : " components", ", genus ",
                 mesh.genus(), ", ", loops, loops == 1 ? " boundary loop>" : " boundary loops>");
}

constexpr const char* k_mesh_doc =
    R"(An oriented manifold triangle mesh with or without boundary, of any number of components; immutable.

Parameters
----------
vertices : array_like of shape (V, d), d >= 2
    Positions; any real number type, kept as float64. Every vertex must belong to a face. With more than three coordinates
    edges are as long as in d dimensions, and the first three are kept to show the surface; with two the third is 0.
triangles : array_like of shape (F, 3)
    Vertex indices of each face, counter-clockwise; any integer type.
lengths : array_like of shape (F, 3) or (E,), optional
    A metric of the surface's own: how long the sides of each face are, from corner i to corner i + 1, or the edges, in
    the order of `edges`. Everything is then measured by them, and `vertices` only show the surface.
job : Job, optional
    Watched for progress and cancellation.

Raises
------
InputError
    An argument has the wrong shape or type.
MeshError
    Lengths that are not finite and positive, that are not the same for both faces of an edge (to 1e-12), or that are
    not those of a triangle.
    No faces, coordinates that are not finite or beyond 1e60, indices out of range, faces without area (lower than 1e-12
    of their longest edge) or that use a vertex twice, duplicate faces, non-manifold edges or vertices, neighbors of
    opposite orientation, vertices of no face. The message names the first three; `repair` mends all but the index range.

Notes
-----
O(V + F) time; about 200 bytes a vertex. All arrays that it gives are read-only views of its memory.)";

}  // namespace

void bind_mesh(py::module_& m) {
  const auto view = [](auto member) {
    return [member](const py::object& self) { return view_of((mesh_of(self).*member)(), self); };
  };
  py::class_<Mesh, std::shared_ptr<Mesh>>(m, "Mesh", py::module_local(), k_mesh_doc)
      .def(py::init(&make_mesh), py::arg("vertices"), py::arg("triangles"), py::kw_only(),
           py::arg("lengths") = py::none(), py::arg("job") = py::none())
      .def_property_readonly("vertices", view(&Mesh::positions), "(V, 3) float64: positions.")
      .def_property_readonly("triangles", view(&Mesh::triangles), "(F, 3) int32: vertices of each face.")
      .def_property_readonly("vertex_count", &Mesh::vertex_count, "Number of vertices.")
      .def_property_readonly("face_count", &Mesh::face_count, "Number of faces.")
      .def_property_readonly("edge_count", &Mesh::edge_count, "Number of edges.")
      .def_property_readonly("edges", &edges, "(E, 2) int32: the two vertices of each edge, in the order of the faces.")
      .def_property_readonly("edge_lengths", &edge_lengths, "(E,) float64: lengths, in the order of `edges`.")
      .def_property_readonly("is_intrinsic", &Mesh::is_intrinsic,
                             "True where lengths are not those of the positions: given, or of more than three "
                             "coordinates. What needs a shape in space is then refused.")
      .def_property_readonly("mean_edge_length", &Mesh::mean_edge_length, "Mean length of an edge.")
      .def_property_readonly("face_areas", view(&Mesh::face_areas), "(F,) float64: areas.")
      .def_property_readonly("area", &Mesh::area, "Area of the whole surface.")
      .def_property_readonly(
          "corner_angles",
          [](const py::object& self) {
            return view_of(mesh_of(self).corner_angles(), self).attr("reshape")(mesh_of(self).face_count(), 3);
          },
          "(F, 3) float64: angle at each corner of each face, radians.")
      .def_property_readonly("total_angles", view(&Mesh::total_angles),
                             "(V,) float64: sum of the corner angles at each vertex, radians.")
      .def_property_readonly(
          "saddle_vertices", [](const Mesh& mesh) { return read_only(to_array(mesh.saddle_vertices())); },
          "(n,) int32: inner vertices whose total angle exceeds 2 pi, and all boundary vertices: where a shortest path "
          "may bend.")
      .def_property_readonly(
          "vertex_kinds", [](const Mesh& mesh) { return read_only(to_array(vertex_kinds(mesh))); },
          "(V,) int8: the sign of the curvature: -1 saddle vertices, with all of the boundary; 0 Euclidean ones, flat "
          "to "
          "1e-10; 1 spherical ones.")
      .def_property_readonly(
          "boundary_vertices", [](const Mesh& mesh) { return read_only(to_array(mesh.boundary_vertices())); },
          "(n,) int32: vertices on the boundary.")
      .def_property_readonly("boundary_loops", &boundary_loops,
                             "List of (n,) int32: vertices of each boundary loop in order, the surface on the left.")
      .def_property_readonly(
          "is_closed", [](const Mesh& mesh) { return mesh.boundary_loops().empty(); }, "True without boundary.")
      .def_property_readonly("components", view(&Mesh::components),
                             "(V,) int32: connected component of each vertex, 0 to component_count - 1.")
      .def_property_readonly("component_count", &Mesh::component_count, "Number of connected components.")
      .def_property_readonly("genus", &Mesh::genus,
                             "Number of handles, summed over the components, boundary loops thought closed.")
      .def_property_readonly("fingerprint", &Mesh::fingerprint,
                             "64-bit hash of vertices, triangles and lengths of its own.")
      .def("__repr__", &describe)
      .def("__reduce__", [](const py::object& self) -> py::tuple {
        const py::tuple arrays = py::make_tuple(self.attr("vertices"), self.attr("triangles"));
        if (!mesh_of(self).is_intrinsic()) return py::make_tuple(py::type::of(self), arrays);
        const py::object partial = py::module_::import("functools").attr("partial");
        return py::make_tuple(partial(py::type::of(self), py::arg("lengths") = self.attr("edge_lengths")), arrays);
      });
}

}  // namespace saddleback::bindings
