#include "saddleback/geodesics/graph_parts.h"

#include "convert/convert.h"
#include "convert/points.h"
#include "geodesics/graph_options.h"

namespace saddleback::bindings {
namespace {

/// Bytes that another object holds, kept for as long as they are looked at.
class BytesIn {
 public:
  BytesIn(const py::handle& value, const std::string& name) {
    if (PyObject_GetBuffer(value.ptr(), &buffer_, PyBUF_SIMPLE) == 0) return;
    PyErr_Clear();
    throw InputError(message(name, ": wanted bytes, got a ", Py_TYPE(value.ptr())->tp_name));
  }
  BytesIn(BytesIn&& other) noexcept : buffer_(std::exchange(other.buffer_, {})) {}
  BytesIn(const BytesIn&) = delete;
  BytesIn& operator=(const BytesIn&) = delete;
  ~BytesIn() {
    if (buffer_.obj) PyBuffer_Release(&buffer_);
  }
  std::span<const std::byte> bytes() const {
    return {static_cast<const std::byte*>(buffer_.buf), static_cast<std::size_t>(buffer_.len)};
  }

 private:
  Py_buffer buffer_{};
};

struct ManyBytes {
  std::vector<BytesIn> held;
  std::vector<std::span<const std::byte>> spans;
  ManyBytes(const py::object& values, const std::string& name) {
    if (PyObject_CheckBuffer(values.ptr()) || !py::isinstance<py::iterable>(values))
      throw InputError(message(name, ": wanted a list of bytes, got a ", Py_TYPE(values.ptr())->tp_name));
    for (const py::handle& value : values) {
      held.emplace_back(value, message(name, "[", held.size(), "]"));
      kept_.append(value);
    }
    for (const BytesIn& bytes : held) spans.push_back(bytes.bytes());
  }

 private:
  py::list kept_;
};

py::bytes as_bytes(const PartBytes& bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

py::bytes find(const py::object& mesh_object, const py::object& part, const py::object& parts, const py::object& k,
               const py::object& accuracy, const py::object& threads, const std::string& instructions,
               const py::object& job) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  SaddleVertexGraphOptions options = graph_options(k, accuracy);
  options.threads = as_integer(threads, "threads");
  options.instructions = instructions;
  const Index which = as_integer(part, "part"), of = as_integer(parts, "parts");
  const JobIn token(job);
  return as_bytes(without_gil([&] { return find_arcs(mesh, which, of, options, token); }));
}

py::bytes across(const py::object& arcs, const py::object& part) {
  const BytesIn bytes(arcs, "arcs");
  const Index into = as_integer(part, "part");
  return as_bytes(without_gil([&] { return arcs_across(bytes.bytes(), into); }));
}

py::bytes unite(const py::object& arcs, const py::object& across, const py::object& threads, const py::object& job) {
  const BytesIn bytes(arcs, "arcs");
  const ManyBytes others(across, "across");
  const Index thread_count = as_integer(threads, "threads");
  const JobIn token(job);
  return as_bytes(without_gil([&] { return unite_arcs(bytes.bytes(), others.spans, thread_count, token); }));
}

py::object from_parts(const py::object& mesh_object, const py::object& parts, const py::object& threads,
                      const py::object& job) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const ManyBytes bytes(parts, "parts");
  const Index thread_count = as_integer(threads, "threads");
  const JobIn token(job);
  return keeping(mesh_object,
                 without_gil([&] { return SaddleVertexGraph::from_parts(mesh, bytes.spans, thread_count, token); }));
}

constexpr const char* k_find_doc =
    R"(Find the arcs of one part of a graph's vertices, for `SaddleVertexGraph.from_parts`.

Parts may be found in any order, by other processes and on other machines; tables are laid for the part and what lies
about it alone, so that they take little longer together than the whole at once.

Parameters
----------
mesh : Mesh
part, parts : int
    Which one, from 0 on, of how many; all are about equally large, and some may be empty.
k, accuracy : optional
    As of SaddleVertexGraph.
threads : int
    0: all cores. The result does not depend on it.
instructions : str
    As of SaddleVertexGraph. The result does not depend on it.
job : Job, optional

Returns
-------
bytes
    The arcs, of what they are, and a checksum: about 9 bytes an arc. The same on any machine.

Raises
------
InputError
    part not within 0 to parts - 1; k or accuracy as of SaddleVertexGraph.
Cancelled
    The job was cancelled.

Notes
-----
Time grows with V / parts times the windows of a disk, and, for a tenth of the whole, with V.)";

constexpr const char* k_across_doc =
    R"(Return those of a part's arcs that lead into another part, as `unite_arcs` takes them.

Parameters
----------
arcs : bytes
    What find_arcs returned.
part : int
    The other part.

Returns
-------
bytes
    12 bytes an arc; of large neighboring parts a hundredth of the arcs.

Raises
------
InputError
    arcs are damaged or something else; part is their own, or out of range.

Notes
-----
O(arcs).)";

constexpr const char* k_unite_doc =
    R"(Unite a part's arcs with the reverses of those of all others: its rows of the graph.

`SaddleVertexGraph.from_parts` does this for all parts that find_arcs returned. Done part by part, no machine needs more
than its own part and the arcs that lead into it, and from_parts only puts one behind the other.

Parameters
----------
arcs : bytes
    What find_arcs returned.
across : list of bytes
    arcs_across(other, part) of each other part, in any order.
threads : int
    0: all cores. The result does not depend on it.
job : Job, optional

Returns
-------
bytes
    8 bytes an arc.

Raises
------
InputError
    Bytes are damaged, something else, or of another graph; the arcs of a part are missing, or given twice.
Cancelled
    The job was cancelled.

Notes
-----
O(arcs).)";

constexpr const char* k_from_parts_doc = R"(Join the parts of a graph: the same graph, to the bit, as built at once.

Parameters
----------
mesh : Mesh
    The one whose arcs they are.
parts : list of bytes
    What find_arcs returned of each part, or unite_arcs of each, in any order.
threads : int
    0: all cores. The result does not depend on it.
job : Job, optional

Returns
-------
SaddleVertexGraph

Raises
------
InputError
    A part is missing, given twice, damaged, of another mesh, or found with other options or in another number of parts.
VersionError
    A part was found by another version of the library.
Cancelled
    The job was cancelled.

Notes
-----
O(arcs): about a sixth of the time of a build, and less of united parts.)";

}  // namespace

void bind_graph_parts(py::module_& m) {
  m.def("find_arcs", &find, py::arg("mesh"), py::arg("part"), py::arg("parts"), py::kw_only(),
        py::arg("k") = py::none(), py::arg("accuracy") = py::none(), py::arg("threads") = 0,
        py::arg("instructions") = "auto", py::arg("job") = py::none(), k_find_doc);
  m.def("arcs_across", &across, py::arg("arcs"), py::arg("part"), k_across_doc);
  m.def("unite_arcs", &unite, py::arg("arcs"), py::arg("across"), py::kw_only(), py::arg("threads") = 0,
        py::arg("job") = py::none(), k_unite_doc);
  m.def("_check_graph_size", &check_graph_size, py::arg("triangle_count"), "Refuses what find_arcs refuses.");
  py::class_<SaddleVertexGraph> type = m.attr("SaddleVertexGraph");
  type.def_static("from_parts", &from_parts, py::arg("mesh"), py::arg("parts"), py::kw_only(), py::arg("threads") = 0,
                  py::arg("job") = py::none(), k_from_parts_doc);
}

}  // namespace saddleback::bindings
