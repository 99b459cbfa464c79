// Files that the Python package writes, with the care that the library takes of its own.

#include "convert/convert.h"
#include "support/number_files.h"

namespace saddleback::bindings {
namespace {

void write_file(const py::object& path, const py::bytes& contents) {
  const std::string file = as_path(path, "path");
  const auto bytes = static_cast<std::string_view>(contents);
  without_gil([&] {
    NumberFileWriter writer(file);
    writer.write(std::span<const char>(bytes));
    writer.commit();
  });
}

}  // namespace

void bind_write_file(py::module_& m) {
  m.def("_write_file", &write_file, py::arg("path"), py::arg("contents"),
        "Writes a file whole, or leaves what was there before. Raises InputError when it cannot be written.");
}

}  // namespace saddleback::bindings
