#include "saddleback/mesh.h"

#include "convert.h"

namespace saddleback::bindings {
namespace {

std::shared_ptr<Mesh> make_mesh(const py::object& vertices, const py::object& triangles) {
  const ArrayIn<double> xyz = as_points3(vertices, "vertices");
  const ArrayIn<Index> indices = as_triangles(triangles, "triangles");
  return without_gil([&] { return std::make_shared<Mesh>(xyz.values, indices.values); });
}

const Mesh& mesh_of(const py::object& self) { return py::cast<const Mesh&>(self); }

std::vector<Index> saddle_vertices(const Mesh& mesh) {
  std::vector<Index> result;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.is_saddle(v)) result.push_back(v);
  return result;
}

py::list boundary_loops(const py::object& self) {
  py::list result;
  for (const std::vector<Index>& loop : mesh_of(self).boundary_loops())
    result.append(view_of(std::span<const Index>(loop), self));
  return result;
}

}  // namespace

void bind_mesh(py::module_& m) {
  py::class_<Mesh, std::shared_ptr<Mesh>>(m, "Mesh", py::module_local(), "An oriented manifold triangle mesh.")
      .def(py::init(&make_mesh), py::arg("vertices"), py::arg("triangles"))
      .def_property_readonly("vertices",
                             [](const py::object& self) { return view_of(mesh_of(self).positions(), self); })
      .def_property_readonly("triangles",
                             [](const py::object& self) { return view_of(mesh_of(self).triangles(), self); })
      .def_property_readonly("saddle_vertices",
                             [](const Mesh& mesh) { return read_only(to_array(saddle_vertices(mesh))); })
      .def_property_readonly("boundary_loops", &boundary_loops)
      .def_property_readonly("area", &Mesh::area)
      .def_property_readonly("genus", &Mesh::genus)
      .def_property_readonly("component_count", &Mesh::component_count)
      .def_property_readonly("edge_count", &Mesh::edge_count)
      .def_property_readonly("mean_edge_length", &Mesh::mean_edge_length)
      .def_property_readonly("fingerprint", &Mesh::fingerprint);
}

}  // namespace saddleback::bindings
