#include "saddleback/read_mesh.h"

#include "convert.h"

namespace saddleback::bindings {
namespace {

py::tuple arrays_of(const py::object& path, const py::object& job) {
  const std::string file = as_path(path, "path");
  const JobIn watched(job);
  MeshArrays arrays = without_gil([&] { return read_arrays(file, watched); });
  return py::make_tuple(to_array(std::move(arrays.xyz)).attr("reshape")(-1, 3),
                        to_array(std::move(arrays.triangles)).attr("reshape")(-1, 3));
}

std::shared_ptr<Mesh> mesh_of(const py::object& path, const py::object& job) {
  const std::string file = as_path(path, "path");
  const JobIn watched(job);
  return without_gil([&] { return std::make_shared<Mesh>(read_mesh(file, watched)); });
}

constexpr const char* k_read_mesh_doc =
    R"(Read a mesh from an OBJ, PLY (text, binary), OFF (text) or STL (text, binary) file.

Polygons become triangles; an STL file's corners at exactly the same place become one vertex. Coordinates keep the file's
precision.

Parameters
----------
path : str or os.PathLike
    The file; its extension tells the format.
job : Job, optional
    Watched for progress and cancellation.

Returns
-------
Mesh

Raises
------
InputError
    The file cannot be opened, or its extension is unknown.
MeshError
    The file breaks off, makes no sense or has no faces (the message names the line or byte), or holds no valid mesh:
    ``repair(*read_arrays(path))`` then helps.

Notes
-----
O(n), for STL O(n log n).)";

constexpr const char* k_read_arrays_doc = R"(Read the raw arrays of a mesh file, whether they make a valid mesh or not.

Parameters
----------
path : str or os.PathLike
    As for `read_mesh`.
job : Job, optional
    Watched for progress and cancellation.

Returns
-------
vertices : (V, 3) float64
triangles : (F, 3) int32
    -1 stands for an index that does not fit 32 bits.

Raises
------
InputError, MeshError
    As for `read_mesh`, but for the validity of the mesh.)";

}  // namespace

void bind_read_mesh(py::module_& m) {
  m.def("read_mesh", &mesh_of, py::arg("path"), py::kw_only(), py::arg("job") = py::none(), k_read_mesh_doc);
  m.def("read_arrays", &arrays_of, py::arg("path"), py::kw_only(), py::arg("job") = py::none(), k_read_arrays_doc);
}

}  // namespace saddleback::bindings
