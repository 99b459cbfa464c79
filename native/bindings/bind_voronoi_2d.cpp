// Voronoi diagrams of the plane.

#include "saddleback/voronoi_2d.h"

#include "convert.h"

namespace saddleback::bindings {
namespace {

std::vector<Vec2> as_sites(const py::object& value) {
  const ArrayIn<double> in = as_points2(value, "sites");
  std::vector<Vec2> sites(in.count);
  for (Index i = 0; i < in.count; ++i) sites[i] = {in.values[2 * i], in.values[2 * i + 1]};
  return sites;
}

Voronoi2d find_diagram(const py::object& sites, const py::object& weights, const py::object& domain,
                       const py::object& circles, const py::object& threads, const std::string& device,
                       const py::object& job) {
  if (device != "auto" && device != "cpu" && device != "cuda")
    throw InputError(message("device: wanted 'auto', 'cpu' or 'cuda', got '", device, "'"));
  if (device == "cuda") throw DeviceError("device: Voronoi diagrams of the plane run on the CPU only");
  if (!weights.is_none()) throw InputError("weights: not supported yet");
  if (!domain.is_none()) throw InputError("domain: not supported yet");
  const std::vector<Vec2> points = as_sites(sites);
  const Voronoi2dOptions options{.circles = as_integer(circles, "circles"), .threads = as_integer(threads, "threads")};
  Job* const token = as_job(job);
  return without_gil([&] { return voronoi_2d(points, options, token); });
}

template <auto Member, class Scalar>
py::array rows(const py::object& self) {
  const auto& vector = py::cast<const Voronoi2d&>(self).*Member;
  return view_of_rows<Scalar>(std::span(vector), self);
}
template <auto Member>
py::array array(const py::object& self) {
  const auto& vector = py::cast<const Voronoi2d&>(self).*Member;
  return view_of(std::span(vector), self);
}

Index as_site(const Voronoi2d& diagram, const py::object& site) {
  const Index i = as_integer(site, "site"), count = static_cast<Index>(diagram.sites.size());
  if (i < 0 || i >= count) throw InputError(message("site: wanted 0 to ", count - 1, ", got ", i));
  return i;
}

constexpr const char* k_doc = R"(Voronoi diagram of points of the plane, by sweep circles.

Which cells touch, and where more than three meet in one vertex, is exact; only coordinates are rounded.

Parameters
----------
sites : (n, 2) float array
    Any finite numbers in any order. Equal sites share one cell.
circles : int
    How many sweep circles share the work; 0: as many as are good. The result does not depend on it.
threads : int
    0: all cores. The result does not depend on it.
device : str
    "auto" or "cpu".
job : Job, optional

Returns
-------
Voronoi2d

Raises
------
InputError
    A coordinate that is not finite, or coordinates so different in size that exact arithmetic cannot take them.
Cancelled
    The job was cancelled.

Notes
-----
O(n log n) time, O(n) memory. H. Tong: the sweep circle that needs no transformation.)";

}  // namespace

void bind_voronoi_2d(py::module_& m) {
  py::class_<Voronoi2d>(m, "Voronoi2d", py::module_local(), "Voronoi diagram of the plane; made by `voronoi_2d`.")
      .def_property_readonly("sites", &rows<&Voronoi2d::sites, double>, "(n, 2) float64: as given.")
      .def_property_readonly("site_of", &array<&Voronoi2d::site_of>,
                             "(n,) int32: smallest index of an equal site; only such sites have a cell.")
      .def_property_readonly("vertices", &rows<&Voronoi2d::vertices, double>, "(V, 2) float64.")
      .def_property_readonly("edges", &rows<&Voronoi2d::edges, Index>,
                             "(E, 2) int32 vertices; -1 at infinity: (v, -1) is a ray, (-1, -1) a line.")
      .def_property_readonly("edge_sites", &rows<&Voronoi2d::edge_sites, Index>,
                             "(E, 2) int32: the sites left and right of the edge.")
      .def_property_readonly(
          "edge_directions", [](const Voronoi2d& d) { return to_array(d.edge_directions()); },
          "(E, 2) float64 unit vectors from first to second vertex; of a ray outwards.")
      .def_property_readonly(
          "delaunay", [](const Voronoi2d& d) { return to_array(without_gil([&] { return d.delaunay(); })); },
          "(T, 3) int32 sites, counter-clockwise: the Delaunay triangulation. Triangles about one vertex share its "
          "smallest site.")
      .def(
          "cell_vertices",
          [](const py::object& self, const py::object& site) {
            const auto& d = py::cast<const Voronoi2d&>(self);
            return view_of(d.cell_vertices(as_site(d, site)), self);
          },
          py::arg("site"), "(k,) int32: vertices around a site's cell, counter-clockwise; -1 where it is open.")
      .def(
          "cell_edges",
          [](const py::object& self, const py::object& site) {
            const auto& d = py::cast<const Voronoi2d&>(self);
            return view_of(d.cell_edges(as_site(d, site)), self);
          },
          py::arg("site"), "(k,) int32: edges around a site's cell; edge k leads to vertex k of `cell_vertices`.")
      .def("__repr__", [](const Voronoi2d& d) {
        return message("<saddleback.Voronoi2d of ", d.cell_sites.size(), " cells, ", d.vertices.size(), " vertices>");
      });
  m.def("voronoi_2d", &find_diagram, py::arg("sites"), py::arg("weights") = py::none(), py::arg("domain") = py::none(),
        py::arg("circles") = 0, py::arg("threads") = 0, py::arg("device") = "auto", py::arg("job") = py::none(), k_doc);
}

}  // namespace saddleback::bindings
