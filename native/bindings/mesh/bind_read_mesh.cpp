#include "saddleback/mesh/read_mesh.h"

#include "convert/convert.h"

namespace saddleback::bindings {
namespace {

// Uncompresses a file by Python's gzip: every Python has it, so the library needs none of its own.
std::string uncompressed(const std::string& path, const JobStage& stage) {
  constexpr std::size_t k_block = std::size_t{1} << 20;
  try {
    const py::object file = py::module_::import("gzip").attr("open")(py::bytes(path));
    std::string contents;
    for (;;) {
      stage.check();
      const std::string block = py::bytes(file.attr("read")(k_block));
      if (block.empty()) break;
      contents += block;
    }
    file.attr("close")();
    return contents;
  } catch (py::error_already_set& error) {
    const py::module_ gzip = py::module_::import("gzip");
    const std::string reason = py::str(error.value());
    if (error.matches(gzip.attr("BadGzipFile")) || error.matches(PyExc_EOFError) ||
        error.matches(py::module_::import("zlib").attr("error")))
      throw MeshError(message(path, " cannot be uncompressed: ", reason));
    if (error.matches(PyExc_OSError))
      throw InputError(
          message("path: ", path, " cannot be opened: ", std::string(py::str(error.value().attr("strerror")))));
    throw;
  }
}

// The arrays of a file, compressed or not. What the reader has to say of them becomes a warning.
MeshArrays arrays_in(const std::string& path, const JobStage& stage) {
  constexpr std::string_view k_compressed = ".gz";
  MeshArrays arrays;
  if (path.ends_with(k_compressed)) {
    const std::string contents = uncompressed(path, stage);
    const std::string name = path.substr(0, path.size() - k_compressed.size());
    arrays = without_gil([&] { return parse_arrays(name, contents, stage); });
  } else {
    arrays = without_gil([&] { return read_arrays(path, stage); });
  }
  if (arrays.warning.empty()) return arrays;
  const py::object text = py::module_::import("os").attr("fsdecode")(py::bytes(path)) + py::str(", " + arrays.warning);
  py::module_::import("warnings").attr("warn")(text);
  return arrays;
}

py::tuple arrays_of(const py::object& path, const py::object& job) {
  const std::string file = as_path(path, "path");
  const JobIn watched(job);
  MeshArrays arrays = arrays_in(file, JobStage(watched, "Reading the mesh"));
  return py::make_tuple(to_array(std::move(arrays.xyz)).attr("reshape")(-1, 3),
                        to_array(std::move(arrays.triangles)).attr("reshape")(-1, 3));
}

std::shared_ptr<Mesh> mesh_of(const py::object& path, const py::object& job) {
  const std::string file = as_path(path, "path");
  const JobIn watched(job);
  const JobStage stage(watched, "Reading the mesh");
  const MeshArrays arrays = arrays_in(file, stage.part(0, 0.5));
  return without_gil([&] { return std::make_shared<Mesh>(arrays.xyz, arrays.triangles, stage.part(0.5, 1)); });
}

constexpr const char* k_read_mesh_doc =
    R"(Read a mesh from an OBJ, PLY (text, binary), OFF (text) or STL (text, binary) file.

Polygons become triangles that cover them, concave ones and such with holes (edges there and back) too: a fan where one
covers it, else Delaunay's triangulation, seen along the mean normal. An STL file's corners at exactly the same place
become one vertex. Coordinates keep the file's precision.

Parameters
----------
path : str or os.PathLike
    The file; its extension tells the format. A further ``.gz`` says that it is compressed.
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
    The file breaks off, holds what is not understood or has no faces (the message names the line or byte), or holds no
    valid mesh: ``repair(*read_arrays(path))`` then helps.

Warns
-----
UserWarning
    Faces cross themselves or have no area: their triangles may overlap.

Notes
-----
O(n), for STL and large concave polygons O(n log n).)";

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

Raises
------
InputError, MeshError
    As for `read_mesh`, but for the validity of the mesh.

Warns
-----
UserWarning
    As for `read_mesh`.)";

}  // namespace

void bind_read_mesh(py::module_& m) {
  m.def("read_mesh", &mesh_of, py::arg("path"), py::kw_only(), py::arg("job") = py::none(), k_read_mesh_doc);
  m.def("read_arrays", &arrays_of, py::arg("path"), py::kw_only(), py::arg("job") = py::none(), k_read_arrays_doc);
}

}  // namespace saddleback::bindings
