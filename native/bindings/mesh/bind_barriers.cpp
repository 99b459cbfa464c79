// Python: barriers, and what is brought to the barred mesh and back.

#include <limits>

#include "saddleback/mesh/barriers.h"
#include "saddleback/tessellation/cell_polygons.h"

#include "convert/cells.h"
#include "convert/curves.h"
#include "convert/points.h"
#include "convert/state.h"

namespace saddleback::bindings {
namespace {

/// The whole mesh's Python object beside what was made of it.
struct Barred : BarredMesh {
  py::object whole;
  const Mesh& whole_mesh() const { return py::cast<const Mesh&>(whole); }
};

/// Flags of faces from flags or indices; none for None.
std::vector<std::uint8_t> as_faces(const py::object& value, const Mesh& mesh) {
  if (value.is_none()) return {};
  const py::array given = py::array::ensure(value);
  PyErr_Clear();  // as_indices says what is wrong
  if (given && given.dtype().kind() == 'b') return as_flags(value, "faces");
  std::vector<std::uint8_t> left_out(static_cast<std::size_t>(mesh.face_count()), 0);
  const ArrayIn<Index> faces = as_indices(value, "faces");
  for (Index i = 0; i < faces.count; ++i) {
    const Index face = faces.values[i];
    if (face < 0 || face >= mesh.face_count())
      throw InputError(
          message("faces: face ", face, " at [", i, "] is out of range, the mesh has ", mesh.face_count(), " faces"));
    left_out[face] = 1;
  }
  return left_out;
}

Barred with_barriers(const py::object& mesh_object, const py::object& edges, const py::object& curves,
                     const py::object& faces, const py::object& job) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const JobIn watched(job);
  const ArrayIn<Index> ends = edges.is_none() ? ArrayIn<Index>{} : as_edges(edges, "edges");
  const CurvesIn lines = as_curves(curves);
  const std::vector<std::uint8_t> left_out = as_faces(faces, mesh);
  const Barriers barriers{{reinterpret_cast<const std::array<Index, 2>*>(ends.values.data()), ends.values.size() / 2},
                          lines.curves,
                          left_out};
  BarredMesh made = without_gil([&] { return add_barriers(mesh, barriers, watched); });
  return {std::move(made), mesh_object};
}

py::tuple to_barred(const Barred& barred, const py::object& points) {
  const Mesh& whole = barred.whole_mesh();
  const SurfacePoints given = as_surface_points(points, whole, "points");
  PointsOnBarred found = without_gil([&] { return points_on_barred(whole, barred, given, "points"); });
  return py::make_tuple(std::move(found.points), to_array(std::move(found.index)));
}

SurfacePoints to_whole(const Barred& barred, const py::object& points) {
  const Mesh& whole = barred.whole_mesh();
  const SurfacePoints given = as_surface_points(points, *barred.mesh, "points");
  return without_gil([&] { return points_on_whole(whole, barred, given, "points"); });
}

py::array values_to_barred(const Barred& barred, const py::object& values) {
  const ArrayIn<double> given = as_reals(values, "values");
  return to_array(without_gil([&] { return values_on_barred(barred.whole_mesh(), barred, given.values); }));
}

std::vector<Index> copies_of(const Barred& barred, const ArrayIn<double>& values) {
  return without_gil([&] { return least_copies(barred.whole_mesh(), barred, values.values); });
}

py::array least(const Barred& barred, const py::object& values) {
  const ArrayIn<double> given = as_reals(values, "values");
  std::vector<double> result;
  for (const Index copy : copies_of(barred, given))
    result.push_back(copy == k_none ? std::numeric_limits<double>::infinity() : given.values[copy]);
  return to_array(std::move(result));
}

py::tuple polygons(const Barred& barred, const py::object& cells, const py::object& bend, const py::object& tolerance) {
  const GeodesicVoronoi& diagram = as_cells(cells, "cells").diagram;
  const CellPolygonOptions options{.bend = as_real(bend, "bend"), .tolerance = as_real(tolerance, "tolerance")};
  SplitMesh split;
  CellPolygons made = without_gil([&] { return cell_polygons(barred.whole_mesh(), barred, diagram, options, &split); });
  return py::make_tuple(std::move(made), std::move(split));
}

std::string describe(const Barred& barred) {
  const Index parts = barred.mesh->component_count();
  return message("<saddleback.BarredMesh: ", barred.mesh->vertex_count(), " vertices, ", barred.mesh->face_count(),
                 " faces, ", parts, parts == 1 ? " part>" : " parts>");
}

constexpr const char* k_barred_doc =
    R"(A surface with barriers as a mesh of its own, and the way there and back; made by `add_barriers`.)";

constexpr const char* k_add_doc = R"(Part a surface along lines that no path may cross, and leave faces out.

What comes back holds a mesh on which everything works unchanged: distances, graphs, paths, cells, shapes. On both sides
of a barrier it has vertices of their own; where a barrier ends inside the surface its sides meet, and paths go around
the end. What a barrier encloses is a part of its own (`mesh.components`): no distance from outside reaches it, which is
told as infinity.

Parameters
----------
mesh : Mesh
edges : array_like of shape (n, 2), optional
    Barriers along edges of the mesh, each by its two vertices.
curves : sequence of SurfaceCurve, optional
    Barriers across faces. They may cross and touch each other, edges and vertices; what is nearer than 1e-9 of a face
    meets. Faces that they cross become several.
faces : array_like of (F,) bool or of face indices, optional
    The faces that are left out.
job : Job, optional
    Watched for progress and cancellation.

Returns
-------
BarredMesh

Raises
------
InputError
    Two vertices that no edge joins, a curve of another mesh, a curve that crosses or touches itself (the message tells
    where), faces out of range, all faces left out.

Notes
-----
O(V + F), and O(p^2) for p pieces of curves in one face. A vertex that stays one comes in the old order; second and
further copies follow. Constrained triangulations after [sloan1993].)";

constexpr const char* k_to_barred_doc = R"(Bring points of the whole mesh to the barred one.

Parameters
----------
points : vertex indices or SurfacePoints
    On the whole mesh.

Returns
-------
tuple of SurfacePoints (m) and (m,) int32
    The points, those on a barrier once for each side, and which of the given points each is.

Raises
------
InputError
    A point off the mesh, or in nothing but faces that are left out.

Notes
-----
O(log F) a point.)";

constexpr const char* k_to_whole_doc = R"(Bring points of the barred mesh, as those of a path, to the whole one.

Parameters
----------
points : vertex indices or SurfacePoints
    On `mesh`.

Returns
-------
SurfacePoints

Raises
------
InputError
    A point off the mesh.

Notes
-----
O(1) a point.)";

constexpr const char* k_values_doc =
    R"(Bring values of the whole mesh's vertices, as a density, to those of the barred one.

Parameters
----------
values : array_like of shape (V,)

Returns
-------
(W,) float64
    Linear over each face where a curve has made a vertex.

Raises
------
InputError
    A wrong number of values.

Notes
-----
O(W).)";

constexpr const char* k_least_doc =
    R"(Bring values of the barred mesh's vertices, as distances, to those of the whole one.

Parameters
----------
values : array_like of shape (W,)

Returns
-------
(V,) float64
    The least of a vertex's copies on all sides of its barriers; infinity where all of its faces are left out.

Raises
------
InputError
    A wrong number of values.

Notes
-----
O(V + W).)";

constexpr const char* k_copies_doc = R"(For each vertex of the whole mesh its copy of the least value.

Brings labels back: ``cells.vertex_cell[barred.least_copies(cells.vertex_distance)]``.

Parameters
----------
values : array_like of shape (W,)

Returns
-------
(V,) int32
    Vertices of `mesh`, the smallest of equal ones; -1 where all of a vertex's faces are left out.

Raises
------
InputError
    A wrong number of values.

Notes
-----
O(V + W).)";

constexpr const char* k_polygons_doc = R"(Make a polygon of the whole surface for each cell of the barred one.

Sides run along the barriers, with a corner wherever those bend, meet or end. Cells on both sides of a barrier share
corners and sides there, so polygons of a closed surface are closed. Where a barrier ends within a cell, the cell's
boundary is moved to that end, or the cell becomes two: those that it adds come after the last site's.

Parameters
----------
cells : GeodesicVoronoi
    Of `mesh`.
bend : float
    How far other sides may leave the boundary that they stand for, as for `GeodesicVoronoi.polygons`.
tolerance : float
    A length that it is never more than.

Returns
-------
tuple of CellPolygons and SplitMesh
    The polygons, on `whole`; `missing` names cells that are no disks. And the whole mesh cut along the boundaries of the
    cells: what each polygon stands for.

Raises
------
InputError
    Cells of another mesh; a negative bend or tolerance.

Notes
-----
O((V + F) log F), and O(F) for each end of a barrier within a cell.)";

}  // namespace

void bind_barriers(py::module_& m) {
  py::class_<Barred>(m, "BarredMesh", py::module_local(), k_barred_doc)
      .def_property_readonly(
          "mesh", [](const Barred& barred) { return barred.mesh; }, "Mesh: the surface with its barriers.")
      .def_property_readonly(
          "whole", [](const Barred& barred) { return barred.whole; }, "Mesh: the surface without them.")
      .def_property_readonly(
          "vertex_origin",
          [](const py::object& self) {
            return view_of(std::span<const Index>(py::cast<const Barred&>(self).vertex_origin), self);
          },
          "(W,) int32: vertex of `whole` that each vertex is a copy of, -1 for those on curves.")
      .def_property_readonly(
          "vertex_points", [](const Barred& barred) { return barred.vertex_points; },
          "SurfacePoints (W): where each vertex lies on `whole`.")
      .def_property_readonly(
          "face_origin",
          [](const py::object& self) {
            return view_of(std::span<const Index>(py::cast<const Barred&>(self).face_origin), self);
          },
          "(U,) int32: face of `whole` that each face is a part of, ascending.")
      .def("to_barred", &to_barred, py::arg("points"), k_to_barred_doc)
      .def("to_whole", &to_whole, py::arg("points"), k_to_whole_doc)
      .def("values_to_barred", &values_to_barred, py::arg("values"), k_values_doc)
      .def("least", &least, py::arg("values"), k_least_doc)
      .def(
          "least_copies",
          [](const Barred& barred, const py::object& values) {
            return to_array(copies_of(barred, as_reals(values, "values")));
          },
          py::arg("values"), k_copies_doc)
      .def("polygons", &polygons, py::arg("cells"), py::kw_only(), py::arg("bend") = 0.15,
           py::arg("tolerance") = std::numeric_limits<double>::infinity(), k_polygons_doc)
      .def("__repr__", &describe);
  m.def("add_barriers", &with_barriers, py::arg("mesh"), py::kw_only(), py::arg("edges") = py::none(),
        py::arg("curves") = py::none(), py::arg("faces") = py::none(), py::arg("job") = py::none(), k_add_doc);
  let_travel<Barred>(
      m, "BarredMesh",
      [](const py::object& self) {
        const auto& barred = py::cast<const Barred&>(self);
        return py::make_tuple(barred.whole, barred.mesh, barred.vertex_points, state_of(barred.vertex_origin),
                              state_of(barred.face_origin));
      },
      [](const py::tuple& state) {
        const py::tuple parts = as_state(state, 5);
        Barred barred;
        barred.whole = parts[0];
        as_mesh(barred.whole, "state");
        as_mesh(parts[1], "state");
        barred.mesh = py::cast<std::shared_ptr<Mesh>>(parts[1]);
        restore(parts[2], barred.vertex_points);
        restore(parts[3], barred.vertex_origin);
        restore(parts[4], barred.face_origin);
        return barred;
      });
}

}  // namespace saddleback::bindings
