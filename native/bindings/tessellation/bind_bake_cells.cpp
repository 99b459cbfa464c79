// BakedCells and the function that makes them.

#include "saddleback/tessellation/bake_cells.h"

#include "convert/cells.h"
#include "convert/points.h"

namespace saddleback::bindings {
namespace {

/// Read-only image of a member array, of several channels or of one number a texel; None where it was not wanted.
template <auto Member, bool HasChannels = false>
py::object image_of(const py::object& self) {
  const auto& baked = py::cast<const BakedCells&>(self);
  const auto& pixels = baked.*Member;
  using Value = typename std::remove_cvref_t<decltype(pixels)>::value_type;
  if (pixels.empty()) return py::none();
  std::vector<py::ssize_t> shape{baked.height, baked.width};
  if (HasChannels) shape.push_back(static_cast<py::ssize_t>(pixels.size()) / (shape[0] * shape[1]));
  return read_only(py::array_t<Value>(shape, pixels.data(), self));
}

template <auto Member>
py::array list_of(const py::object& self) {
  const auto& values = py::cast<const BakedCells&>(self).*Member;
  return view_of(std::span(values), self);
}

/// (3 n, channels) reals, or none.
ArrayIn<double> as_values(const py::object& value, Index corners, Index& channels) {
  if (value.is_none()) return {};
  const std::string wanted = message("an array (", corners, ", channels) of real numbers, a row for each corner");
  ArrayIn<double> rows = as_rows(value, "values", wanted);
  if (rows.count != corners) throw InputError(message("values: wanted ", wanted, ", got ", rows.count, " rows"));
  channels = static_cast<Index>(rows.array.shape(1));
  return rows;
}

BakedCells bake(const py::object& cells, const py::object& uv, const py::object& faces, const py::object& values,
                const py::object& axes, const py::object& size, const py::object& tile, const py::object& margin,
                bool edge_distance, bool local_uv, bool allow_overlaps, const py::object& threads,
                const py::object& job) {
  const CellsIn of = as_cells(cells, "cells");
  const auto pair = [](const py::object& value, const char* name) {
    if (!py::isinstance<py::sequence>(value) || py::len(value) != 2)
      throw InputError(message(name, ": wanted two integers"));
    const py::sequence both(value);
    return std::array{as_integer(both[0], name), as_integer(both[1], name)};
  };
  const ArrayIn<double> places = as_points2(uv, "uv");
  ArrayIn<Index> chosen;
  UvTriangles triangles;
  std::vector<Index> all;
  if (faces.is_none()) {
    all.resize(of.graph.mesh().face_count());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Index>(i);
    triangles.faces = all;
  } else {
    chosen = as_indices(faces, "faces");
    triangles.faces = chosen.values;
  }
  const auto corners = static_cast<Index>(3 * triangles.faces.size());
  if (places.count != corners)
    throw InputError(message("uv: wanted ", corners, " places, one for each corner of the faces, got ", places.count));
  triangles.uv = {reinterpret_cast<const std::array<Vec2, 3>*>(places.values.data()), triangles.faces.size()};
  const ArrayIn<double> numbers = as_values(values, corners, triangles.channels);
  triangles.values = numbers.values;
  const std::array<Index, 2> shape = pair(size, "size"), square = pair(tile, "tile");
  BakeOptions options{.width = shape[0],
                      .height = shape[1],
                      .tile_u = square[0],
                      .tile_v = square[1],
                      .margin = as_integer(margin, "margin"),
                      .edge_distance = edge_distance,
                      .local_uv = local_uv,
                      .axes = {},
                      .allow_overlaps = allow_overlaps,
                      .threads = as_integer(threads, "threads")};
  ArrayIn<double> directions;
  if (!axes.is_none()) {
    directions = as_points3(axes, "axes");
    options.axes = {reinterpret_cast<const Vec3*>(directions.values.data()), std::size_t(directions.count)};
  }
  const JobIn token(job);
  return without_gil([&] { return bake_cells(of.graph, of.diagram, triangles, options, token); });
}

constexpr const char* k_bake_doc = R"(Images of cells: what each texel of a UV map shows, found on the surface itself.

For the center of every texel its triangle and its place there; from that, on the surface, the cell that holds it (as
the outlines of cells are), the geodesic distance to the boundary of the cell, and the logarithm about the cell's site.
Nothing is interpolated between vertices but `values`.

Parameters
----------
cells : GeodesicVoronoi
uv : (3 n, 2) float array
    Places in the UV map of the corners of each of `faces`, in order.
faces : (n,) int array, optional
    Faces of the mesh; one may be there several times, or not at all. None: all of them.
values : (3 n, channels) float array, optional
    Numbers at the same corners, linear between.
axes : (sites, 3) float array, optional
    Directions in space at the sites, in which the first coordinate of the logarithms points. None: as `log_map`.
size : (int, int)
    Width and height in texels, 1 to 16384 each.
tile : (int, int)
    The square of the UV plane that is seen: the UDIM tile 1001 + u + 10 v.
margin : int
    0 to 1024 texels: as far from the triangles, texels get what the nearest texel within one has.
edge_distance, local_uv : bool
    Whether these are wanted.
allow_overlaps : bool
    Where triangles overlap the first of them is seen, instead of an InputError.
threads : int
    0: all cores. The result does not depend on it.
job : Job, optional

Returns
-------
BakedCells

Raises
------
InputError
    A size or margin out of range, places that are not finite, arrays of other lengths, faces off the mesh; triangles
    that overlap, with their number.
Cancelled
    The job was cancelled.

Notes
-----
O(texels (windows about a face + log(texels of a cell))), and window propagation within each cell. Distances and
logarithms are exact up to rounding to float32. After [chen1990].)";

}  // namespace

void bind_bake_cells(py::module_& m) {
  py::class_<BakedCells>(m, "BakedCells", py::module_local(),
                         "Images of cells; made by `bake_cells`. Row 0 is the lowest.")
      .def_property_readonly("triangle", &image_of<&BakedCells::triangle>,
                             "(height, width) int32: which of the given triangles a texel's center lies in; -1: none.")
      .def_property_readonly("cell", &image_of<&BakedCells::cell>,
                             "(height, width) int32, -1 beyond the margin, where all else is 0.")
      .def_property_readonly("edge_distance", &image_of<&BakedCells::edge_distance>,
                             "(height, width) float32: geodesic distance to the boundary of the cell, infinity where "
                             "it has none; None where it was not wanted.")
      .def_property_readonly("local_uv", &image_of<&BakedCells::local_uv, true>,
                             "(height, width, 2) float32: the logarithm about the cell's site, mesh units; None where "
                             "it was not wanted.")
      .def_property_readonly("values", &image_of<&BakedCells::values, true>,
                             "(height, width, channels) float32; None without values.")
      .def_property_readonly(
          "farthest", &list_of<&BakedCells::farthest>,
          "(cells,) float32: the largest edge distance of the texels of each, 0 where there is none.")
      .def_property_readonly("overlapping", &list_of<&BakedCells::overlapping>,
                             "(k,) int32: triangles that share texels' centers with others, deeper than rounding.")
      .def_property_readonly("without_area", &list_of<&BakedCells::without_area>,
                             "(k,) int32: triangles that have no area in the UV map, and are nowhere seen.")
      .def_property_readonly("outside", &list_of<&BakedCells::outside>,
                             "(k,) int32: triangles that are nowhere in the image.")
      .def("__repr__", [](const BakedCells& baked) {
        return message("<saddleback.BakedCells of ", baked.width, " x ", baked.height, " texels>");
      });
  m.def("bake_cells", &bake, py::arg("cells"), py::arg("uv"), py::arg("faces") = py::none(), py::kw_only(),
        py::arg("values") = py::none(), py::arg("axes") = py::none(), py::arg("size") = py::make_tuple(1024, 1024),
        py::arg("tile") = py::make_tuple(0, 0), py::arg("margin") = 16, py::arg("edge_distance") = true,
        py::arg("local_uv") = true, py::arg("allow_overlaps") = false, py::arg("threads") = 0,
        py::arg("job") = py::none(), k_bake_doc);
}

}  // namespace saddleback::bindings
