// Python: plain triangle arrays.

#include <limits>

#include "saddleback/mesh/triangle_arrays.h"

#include "convert/convert.h"

namespace saddleback::bindings {
namespace {

constexpr const char* k_wanted_rows = "(V, k) floats";

std::span<const Triangle> triangles_of(const ArrayIn<Index>& in) {
  return {reinterpret_cast<const Triangle*>(in.values.data()), in.values.size() / 3};
}
std::span<const Vec3> points_of(const ArrayIn<double>& in) {
  return {reinterpret_cast<const Vec3*>(in.values.data()), in.values.size() / 3};
}

Index as_vertex_count(const py::object& value) {
  const Index count = as_integer(value, "vertex_count");
  if (count < 0) throw InputError(message("vertex_count: wanted 0 or more, got ", count));
  if (count == std::numeric_limits<Index>::max())
    throw InputError(message("vertex_count: ", count, " is one more than 32-bit indices allow"));
  return count;
}

py::array normals(const py::object& vertices, const py::object& triangles) {
  const ArrayIn<double> xyz = as_points3(vertices, "vertices");
  const ArrayIn<Index> indices = as_triangles(triangles, "triangles");
  return to_array(without_gil([&] { return vertex_normals(points_of(xyz), triangles_of(indices)); }));
}

py::array means(const py::object& triangles, const py::object& values) {
  const ArrayIn<Index> indices = as_triangles(triangles, "triangles");
  const ArrayIn<double> rows = as_rows(values, "values", k_wanted_rows);
  const auto width = static_cast<Index>(rows.array.shape(1));
  return to_array(without_gil([&] { return neighbor_means(rows.values, width, triangles_of(indices)); }))
      .reshape(std::vector<py::ssize_t>{-1, width});
}

py::array smoothed(const py::object& triangles, const py::object& directions, const py::object& rounds,
                   const py::object& job) {
  const ArrayIn<Index> indices = as_triangles(triangles, "triangles");
  const ArrayIn<double> xyz = as_points3(directions, "directions");
  const int count = as_integer(rounds, "rounds");
  const JobIn token(job);
  return to_array(without_gil([&] {
    return smoothed_directions(points_of(xyz), triangles_of(indices), count, JobStage(token, "Smoothing directions"));
  }));
}

py::tuple edges_of(const py::object& triangles, const py::object& vertex_count) {
  const ArrayIn<Index> indices = as_triangles(triangles, "triangles");
  const Index count = as_vertex_count(vertex_count);
  TriangleEdges found = without_gil([&] { return triangle_edges(triangles_of(indices), count); });
  return py::make_tuple(to_rows<Index>(std::move(found.ends)), to_array(std::move(found.corner_edges)));
}

py::tuple border(const py::object& triangles, const py::object& vertex_count) {
  const ArrayIn<Index> indices = as_triangles(triangles, "triangles");
  const Index count = as_vertex_count(vertex_count);
  BorderEdges found = without_gil([&] { return border_edges(triangles_of(indices), count); });
  return py::make_tuple(to_rows<Index>(std::move(found.ends)), to_array(std::move(found.triangles)));
}

py::array parts_of(const py::object& triangles, const py::object& vertex_count) {
  const ArrayIn<Index> indices = as_triangles(triangles, "triangles");
  const Index count = as_vertex_count(vertex_count);
  return to_array(without_gil([&] { return connected_parts(triangles_of(indices), count); }));
}

py::tuple cut(const py::object& fields, const py::object& triangles, const py::object& column,
              const py::object& level) {
  const ArrayIn<double> rows = as_rows(fields, "fields", k_wanted_rows);
  const ArrayIn<Index> indices = as_triangles(triangles, "triangles");
  const Index at = as_integer(column, "column");
  const double value = as_real(level, "level");
  const auto width = static_cast<Index>(rows.array.shape(1));
  LevelCut found = without_gil([&] { return cut_at_level(rows.values, width, triangles_of(indices), at, value); });
  const std::vector<py::ssize_t> shape{-1, width};
  return py::make_tuple(to_array(std::move(found.fields)).reshape(shape), to_array(std::move(found.triangles)),
                        to_array(std::move(found.parents)), to_array(std::move(found.aboves)).attr("view")("bool"));
}

py::tuple boundary(const py::object& triangles, const py::object& cells, const py::object& vertex_count) {
  const ArrayIn<Index> indices = as_triangles(triangles, "triangles");
  const ArrayIn<Index> owners = as_indices(cells, "triangle_cell");
  const Index count = as_vertex_count(vertex_count);
  CellBoundary found = without_gil([&] { return cell_boundary(triangles_of(indices), owners.values, count); });
  return py::make_tuple(to_rows<Index>(std::move(found.segments)), to_rows<Index>(std::move(found.cells)));
}

py::array boundary_distance(const py::object& vertices, const py::object& triangles, const py::object& cells,
                            const py::object& limit) {
  const ArrayIn<double> xyz = as_points3(vertices, "vertices");
  const ArrayIn<Index> indices = as_triangles(triangles, "triangles");
  const ArrayIn<Index> owners = as_indices(cells, "triangle_cell");
  const double farthest = as_real(limit, "limit");
  const JobIn job{py::none()};
  return to_array(without_gil([&] {
    return cell_boundary_distance(points_of(xyz), triangles_of(indices), owners.values, farthest,
                                  JobStage(job, "Measuring distances to borders"));
  }));
}

py::array to_segments(const py::object& points, const py::object& point_group, const py::object& starts,
                      const py::object& ends, const py::object& segment_group, const py::object& job) {
  const ArrayIn<double> xyz = as_points3(points, "points"), from = as_points3(starts, "starts");
  const ArrayIn<double> to = as_points3(ends, "ends");
  const ArrayIn<Index> of_points = as_indices(point_group, "point_group");
  const ArrayIn<Index> of_segments = as_indices(segment_group, "segment_group");
  if (from.count != to.count) throw InputError(message("ends: wanted ", from.count, ", got ", to.count));
  const JobIn token(job);
  return to_array(without_gil([&] {
    std::vector<std::array<Vec3, 2>> segments;
    for (Index i = 0; i < from.count; ++i) segments.push_back({points_of(from)[i], points_of(to)[i]});
    return segment_distances(points_of(xyz), of_points.values, segments, of_segments.values,
                             JobStage(token, "Measuring distances to lines"));
  }));
}

py::tuple refine(const py::object& fields, const py::object& triangles, const py::object& cells,
                 const py::object& levels, const py::object& tolerance) {
  const ArrayIn<double> rows = as_rows(fields, "fields", k_wanted_rows);
  const ArrayIn<Index> indices = as_triangles(triangles, "triangles");
  const ArrayIn<Index> owners = as_indices(cells, "triangle_cell");
  const ArrayIn<double> wanted = as_reals(levels, "levels");
  const double most = as_real(tolerance, "tolerance");
  const auto width = static_cast<Index>(rows.array.shape(1));
  const JobIn job{py::none()};
  BoundaryRefinement found = without_gil([&] {
    return refine_to_cell_boundary(rows.values, width, triangles_of(indices), owners.values, wanted.values, most,
                                   JobStage(job, "Refining borders"));
  });
  const std::vector<py::ssize_t> shape{-1, width};
  return py::make_tuple(to_array(std::move(found.fields)).reshape(shape), to_array(std::move(found.triangles)),
                        to_array(std::move(found.cells)));
}

py::array crossings(const py::object& vertices, const py::object& triangles, const py::object& among,
                    const py::object& owners, const py::object& threads, const py::object& job) {
  const ArrayIn<double> xyz = as_points3(vertices, "vertices");
  const ArrayIn<Index> indices = as_triangles(triangles, "triangles");
  const ArrayIn<Index> chosen = among.is_none() ? ArrayIn<Index>{} : as_indices(among, "among");
  const std::optional named = among.is_none() ? std::nullopt : std::optional(chosen.values);
  const ArrayIn<Index> whose = owners.is_none() ? ArrayIn<Index>{} : as_indices(owners, "owners");
  const std::optional owned = owners.is_none() ? std::nullopt : std::optional(whose.values);
  const Index count = as_integer(threads, "threads");
  const JobIn token(job);
  return to_rows<Index>(without_gil([&] {
    const JobStage stage(token, "Looking for triangles that pass through each other");
    return self_crossings(points_of(xyz), triangles_of(indices), named, owned, count, stage);
  }));
}

}  // namespace

void bind_triangle_arrays(py::module_& m) {
  m.def("vertex_normals", &normals, py::arg("vertices"), py::arg("triangles"),
        R"(Unit normals of plain triangles' vertices, weighted by area.

Parameters
----------
vertices : (V, 3) float array
triangles : (T, 3) int array

Returns
-------
(V, 3) float64; zero where no triangle with an area meets the vertex. O(V + T).)");
  m.def("neighbor_means", &means, py::arg("triangles"), py::arg("values"),
        R"(Mean of the numbers at the other corners of the triangles around each vertex.

Parameters
----------
triangles : (T, 3) int array
values : (V, k) float array
    Numbers of each vertex, one at least.

Returns
-------
(V, k) float64
    A neighbor on two of the triangles counts twice; zero where no triangle is. O(V k + T k).)");
  m.def("smoothed_directions", &smoothed, py::arg("triangles"), py::arg("directions"), py::arg("rounds"), py::kw_only(),
        py::arg("job") = py::none(),
        R"(Turn directions of vertices towards those of their neighbors, round after round.

Parameters
----------
triangles : (T, 3) int array
directions : (V, 3) float array
    Unit vectors, such as normals.
rounds : int
    In each, a direction becomes that of the mean of its neighbors' (see neighbor_means) and a fifth of itself.
job : Job, optional

Returns
-------
(V, 3) float64
    Unit vectors; as given where those around cancel out. O(rounds T).

Raises
------
InputError
    Fewer than 0 rounds; a corner out of range.
Cancelled)");
  m.def("triangle_edges", &edges_of, py::arg("triangles"), py::arg("vertex_count"),
        R"(Number the edges of triangles, in the order in which these come upon them, whichever way round.

Parameters
----------
triangles : (T, 3) int array
vertex_count : int

Returns
-------
ends : (e, 2) int32
    The vertices of each edge, once.
corner_edges : (3 T,) int32
    The edge from each triangle's corner to its next one. O(V + T).)");
  m.def("border_edges", &border, py::arg("triangles"), py::arg("vertex_count"),
        R"(Find the edges that only one triangle uses.

Parameters
----------
triangles : (T, 3) int array
vertex_count : int

Returns
-------
ends : (b, 2) int32
    From and to, in the triangle's orientation.
triangles : (b,) int32
    The one that uses the edge, in increasing order. O(V + T).)");
  m.def("connected_parts", &parts_of, py::arg("triangles"), py::arg("vertex_count"),
        R"(Tell which triangles hang together.

Parameters
----------
triangles : (T, 3) int array
vertex_count : int

Returns
-------
(T,) int32
    The part of each, numbered in the order in which the triangles come upon them: those of one part lead to each other
    over common vertices. O(V + T).)");
  m.def("cut_at_level", &cut, py::arg("fields"), py::arg("triangles"), py::arg("column"), py::arg("level"),
        R"(Cut triangles along the line where a function that is linear over each equals a level.

Parameters
----------
fields : (V, k) float array
    All numbers of a vertex side by side, the position first: new vertices interpolate each of them, and are shared by
    both sides, so that no crack opens.
triangles : (T, 3) int array
column : int
    Of the function. A vertex nearer to the level than 1e-9 of its greatest value is on it. Values may be infinite, as
    distances beyond a limit are: an edge from a finite value to such a one crosses the level at its finite end.
level : float
    Finite.

Returns
-------
fields : (W, k) float64
    The given vertices, then the new ones.
triangles : (U, 3) int32
parents : (U,) int32
    The given triangle that each is part of, in increasing order.
aboves : (U,) bool
    Whether it lies above the level; a triangle wholly on it does not. O(V k + T).)");
  m.def("cell_boundary", &boundary, py::arg("triangles"), py::arg("triangle_cell"), py::arg("vertex_count"),
        R"(Find the edges between triangles of different cells.

Parameters
----------
triangles : (T, 3) int array
triangle_cell : (T,) int array
vertex_count : int

Returns
-------
segments : (b, 2) int32
    The two vertices of each; the border of the mesh is no boundary of a cell.
cells : (b, 2) int32
    The two cells beside each. O(V + T).)");
  m.def("cell_boundary_distance", &boundary_distance, py::arg("vertices"), py::arg("triangles"),
        py::arg("triangle_cell"), py::arg("limit") = std::numeric_limits<double>::infinity(),
        R"(Measure how far vertices are from the boundary of the cell that they lie in.

Parameters
----------
vertices : (V, 3) float array
triangles, triangle_cell : (T, 3), (T,) int arrays
    Every triangle inside one cell, as `split` gives them.
limit : float
    Vertices farther than one ring beyond it get infinity.

Returns
-------
(V,) float64
    0 on a boundary, infinity in a cell without one. Straight distances to segments that were reached on the surface:
    never too short, at most a few percent too long near the middle line of a cell with a ragged boundary.

Notes
-----
O(V + T) for a fixed number of rings. A vector distance transform [danielsson1980].)");
  m.def("segment_distances", &to_segments, py::arg("points"), py::arg("point_group"), py::arg("starts"),
        py::arg("ends"), py::arg("segment_group"), py::kw_only(), py::arg("job") = py::none(),
        R"(Measure how far points are from straight segments, each from those of its own group only.

Parameters
----------
points : (n, 3) float array
point_group : (n,) int array
    The group of each point, 0 or more: the cell that it lies in, say.
starts, ends : (m, 3) float arrays
    Of the segments.
segment_group : (m,) int array
    The group of each.
job : Job, optional

Returns
-------
(n,) float64
    Straight through space; infinity where the group has no segment. O(n + m log m) and for each point the segments of
    its group.

Raises
------
InputError
    A group below 0; another number of groups than points or segments.
Cancelled)");
  m.def("refine_to_cell_boundary", &refine, py::arg("fields"), py::arg("triangles"), py::arg("triangle_cell"),
        py::arg("levels"), py::arg("tolerance"),
        R"(Refine triangles until lines of equal distance to the boundary of the cells come out right on them.

On triangles as large as the cells the distance is not linear: where all corners lie on the boundary it would be 0 all
over. An edge is halved where the distance in its middle differs too much from the mean of both ends, and one of the
levels is crossed.

Parameters
----------
fields : (V, k) float array
    All numbers of a vertex side by side, the position first; new vertices get the means of theirs. The last is filled
    with the distance, as `cell_boundary_distance` finds it.
triangles, triangle_cell : (T, 3), (T,) int arrays
    Every triangle inside one cell, as `split` gives them.
levels : (n,) float array
    Distances from the boundary whose lines `cut_at_level` is to find.
tolerance : float
    By about which share of its level each may be off.

Returns
-------
fields : (W, k) float64
    The given vertices, then the new ones.
triangles, triangle_cell : (U, 3), (U,) int32
    O(V + U) for a fixed number of rings.

Raises
------
InputError
    A wrong number of cells, a tolerance that is not above 0.)");
  m.def("self_crossings", &crossings, py::arg("vertices"), py::arg("triangles"), py::arg("among") = py::none(),
        py::kw_only(), py::arg("owners") = py::none(), py::arg("threads") = 0, py::arg("job") = py::none(),
        R"(Find the triangles that pass through each other.

Exact for the coordinates as they are. Triangles that only touch, lie in one plane or share an edge are no such pair.

Parameters
----------
vertices : (V, 3) float array
triangles : (T, 3) int array
among : (n,) int array, optional
    Numbers of triangles, rising: only pairs of which one is among these.
owners : (T,) int array, optional
    Whose each triangle is: only pairs of different owners, which is quicker than to look at all and leave out the rest.
threads : int
    0: all cores. The result does not depend on it.
job : Job, optional

Returns
-------
(k, 2) int32
    Numbers of triangles, the smaller first, in order. About O(T log n), where n = T without `among`.

Raises
------
InputError
    A corner that is no vertex, a vertex that is not finite, an `among` that does not rise, a wrong number of owners.
Cancelled
    The job was cancelled.)");
}

}  // namespace saddleback::bindings
