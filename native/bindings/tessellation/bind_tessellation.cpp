// GeodesicVoronoi, SplitMesh and the functions that make them.

#include <span>

#include "saddleback/tessellation/cell_polygons.h"
#include "saddleback/tessellation/geodesic_center.h"

#include "convert/cells.h"
#include "convert/devices.h"
#include "convert/dual.h"
#include "convert/fields.h"
#include "convert/points.h"
#include "convert/state.h"

namespace saddleback::bindings {
namespace {

/// A diagram together with the graph (a Python object) whose mesh it lies on.
struct Cells {
  GeodesicVoronoi diagram;
  py::object graph;
  bool by_cuda;
  const Mesh& mesh() const { return py::cast<const SaddleVertexGraph&>(graph).mesh(); }
};

struct VoronoiEdge {
  std::vector<Vec3> points;
  SurfacePoints surface;
  std::array<Index, 2> cells;
  bool closed;
};
auto fields_of(VoronoiEdge& of) { return std::tie(of.points, of.surface, of.cells, of.closed); }

const GeodesicVoronoi& diagram_of(const py::object& self) { return py::cast<const Cells&>(self).diagram; }

/// Read-only array of a member vector of the diagram.
template <auto Member>
py::array array_of(const py::object& self) {
  const auto& values = diagram_of(self).*Member;
  return view_of(std::span(values), self);
}

SurfacePoints points_at(const GeodesicVoronoi& diagram, std::span<const Index> indices) {
  SurfacePoints points;
  for (const Index i : indices) points.push_back(diagram.points[i]);
  return points;
}

SurfacePoints sites_at(const GeodesicVoronoi& diagram, std::span<const Index> indices) {
  SurfacePoints points;
  for (const Index i : indices) points.push_back(diagram.sites[i]);
  return points;
}

std::vector<Vec3> positions_at(const GeodesicVoronoi& diagram, std::span<const Index> indices) {
  std::vector<Vec3> positions;
  for (const Index i : indices) positions.push_back(diagram.positions[i]);
  return positions;
}

py::list edges(const Cells& cells) {
  const GeodesicVoronoi& d = cells.diagram;
  py::list result;
  for (std::size_t i = 0; i < d.edge_cells.size(); ++i) {
    const std::span indices(&d.edge_points[d.edge_offsets[i]], d.edge_offsets[i + 1] - d.edge_offsets[i]);
    result.append(VoronoiEdge{positions_at(d, indices), points_at(d, indices), d.edge_cells[i], d.edge_closed[i] != 0});
  }
  return result;
}

DualPolicy as_policy(const std::string& name) {
  if (name == "strict") return DualPolicy::strict;
  if (name == "repair") return DualPolicy::repair;
  if (name == "fail") return DualPolicy::fail;
  throw InputError(message("policy: wanted 'strict', 'repair' or 'fail', got '", name, "'"));
}

Dual dual(const py::object& self, const std::string& policy, const py::object& threads, const py::object& job) {
  const auto& cells = py::cast<const Cells&>(self);
  const auto& graph = py::cast<const SaddleVertexGraph&>(cells.graph);
  const DualPolicy chosen = as_policy(policy);
  const int count = as_integer(threads, "threads");
  const JobIn token(job);
  DualMesh mesh = without_gil([&] { return dual_mesh(graph, cells.diagram, chosen, count, token); });
  const GeodesicVoronoi* const diagram = mesh.repaired ? mesh.repaired.get() : &cells.diagram;
  return {std::move(mesh), self, cells.graph, &graph.mesh(), diagram, std::nullopt};
}

py::tuple locate(const Cells& cells, const py::object& points, const py::object& job) {
  const SurfacePoints places = as_surface_points(points, cells.mesh(), "points");
  const JobIn token(job);
  const auto& graph = py::cast<const SaddleVertexGraph&>(cells.graph);
  std::vector<Index> cell;
  std::vector<double> distance;
  without_gil([&] {
    for (const CellAt& at : cells.diagram.locate(graph, places, token)) {
      cell.push_back(at.cell);
      distance.push_back(at.distance);
    }
  });
  return py::make_tuple(to_array(std::move(cell)), to_array(std::move(distance)));
}

py::array cells_at(const Cells& cells, const py::object& points) {
  const SurfacePoints places = as_surface_points(points, cells.mesh(), "points");
  const Mesh& mesh = cells.mesh();
  std::vector<Index> cell;
  without_gil([&] {
    for (const SurfacePoint& place : places) cell.push_back(cells.diagram.cell_at(mesh, place));
  });
  return to_array(std::move(cell));
}

constexpr const char* k_dual_doc = R"(Make the dual mesh: the intrinsic Delaunay triangulation of the sites.

Parameters
----------
policy : str
    "repair": add sites where cells are too large for a triangulation of the surface (a cell that is no disk, two cells
    that meet twice, ...), until there is one, at most ten for each and 1,000. "strict": keep the sites; triangles and edges may repeat corners, and
    `issues` lists every violation. "fail": refuse where there is a violation.
threads : int
    0: all cores. The result does not depend on it.
job : Job, optional

Returns
-------
DualMesh
    Unpacks into vertices (n, 3), triangles (t, 3) and issues (list of DualIssue).

Raises
------
InputError
    The policy is to fail and the cells have no triangulation as their dual; or so many more sites do not mend them.
Cancelled
    The job was cancelled.

Notes
-----
O(cells + boundaries). H. Edelsbrunner, N. R. Shah: Triangulating topological spaces, 1997 (the closed-ball property).)";

CellPolygons polygons(const Cells& cells, const std::string& policy, const py::object& bend,
                      const py::object& tolerance, const py::object& threads, const py::object& job) {
  const auto& graph = py::cast<const SaddleVertexGraph&>(cells.graph);
  const CellPolygonOptions options{.policy = as_policy(policy),
                                   .bend = as_real(bend, "bend"),
                                   .tolerance = as_real(tolerance, "tolerance"),
                                   .threads = as_integer(threads, "threads")};
  const JobIn token(job);
  return without_gil([&] { return cell_polygons(graph, cells.diagram, options, token); });
}

constexpr const char* k_polygons_doc = R"(Make a polygon for each cell: a mesh whose faces are the cells.

Its vertices are where three or more cells meet, where boundaries end at the mesh's border, and where boundaries bend.
Neighbors share their corners and sides: a closed surface gives a closed mesh. Two cells that meet along several
boundaries, and cells with fewer than three corners, get corners within those boundaries, so that no two sides join the
same corners.

Parameters
----------
policy : str
    For cells that are no disks, or fill a sphere by two, and so have no polygon. "repair": add sites, as `dual` does.
    "strict": `missing` names them. "fail": refuse.
bend : float
    How far a side may leave the boundary that it stands for, in parts of the size (root of the area) of the smaller of
    its cells; where it would be more, there are corners on the way. inf: none but those needed.
tolerance : float
    A length that it is never more than.
threads : int
    0: all cores. The result does not depend on it.
job : Job, optional

Returns
-------
CellPolygons

Raises
------
InputError
    A negative bend; a cell without a polygon where the policy is to fail, or repair does not mend it.
Cancelled
    The job was cancelled.

Notes
-----
O((V + F + boundaries) log F). Corners on the way after D. Douglas, T. Peucker: Algorithms for the reduction of the
number of points required to represent a digitized line, 1973.)";

SurfacePoints corners(const Cells& cells, const py::object& cell) {
  return points_at(cells.diagram, cells.diagram.corners(as_integer(cell, "cell")));
}

py::object find_cells(const py::object& graph, const py::object& sites, bool exact, const py::object& threads,
                      const std::string& device, const py::object& job) {
  const SaddleVertexGraph& g = as_graph(graph);
  const SurfacePoints points = as_surface_points(sites, g.mesh(), "sites");
  GeodesicVoronoiOptions options{.threads = as_integer(threads, "threads")};
  const JobIn token(job);
  GeodesicVoronoi cells = run_on(device, !exact && is_search_worth_a_device(g), [&](const std::vector<int>& devices) {
    if (!devices.empty() && exact) throw InputError("exact: runs on the processor only; wanted device='cpu'");
    options.cuda_device = first_device(devices);
    return without_gil([&] {
      return exact ? exact_voronoi(g.mesh(), points, token, options.threads)
                   : geodesic_voronoi(g, points, options, token);
    });
  });
  return make_cells(std::move(cells), graph, options.cuda_device >= 0);
}

py::list dual_paths(const Cells& cells, const py::object& threads, const py::object& job) {
  const auto& graph = py::cast<const SaddleVertexGraph&>(cells.graph);
  const int count = as_integer(threads, "threads");
  const JobIn token(job);
  py::list result;
  for (GeodesicPath& path : without_gil([&] { return dual_edge_paths(graph, cells.diagram, count, token); }))
    result.append(std::move(path));
  return result;
}

py::tuple save_cells(const py::object& self) {
  const auto& cells = py::cast<const Cells&>(self);
  return py::make_tuple(cells.graph, state_of(cells.diagram), cells.by_cuda);
}

Cells load_cells(const py::tuple& state) {
  const py::tuple parts = as_state(state, 3);
  if (!py::isinstance<SaddleVertexGraph>(parts[0])) refuse_state("a SaddleVertexGraph", parts[0]);
  Cells cells{{}, parts[0], false};
  restore(parts[1], cells.diagram);
  restore(parts[2], cells.by_cuda);
  GeodesicVoronoi& diagram = cells.diagram;
  if (!diagram.exact_sites.empty()) {
    const SurfacePoints sources = sites_at(diagram, diagram.exact_sites);
    diagram.exact_field = without_gil([&] { return std::make_shared<const ExactField>(cells.mesh(), sources); });
  }
  return cells;
}

constexpr const char* k_dual_paths_doc = R"(The edges of the dual mesh as geodesics on the surface.

Parameters
----------
threads : int
    0: all cores. The result does not depend on it.
job : Job, optional

Returns
-------
list of GeodesicPath
    In the order of `dual("strict").edges`: from site to site, the locally shortest way in the class of the shortest
    one over the boundary between their cells.

Raises
------
Cancelled
    The job was cancelled.

Notes
-----
O(faces crossed) each; of cells by the graph with a distance field for those that pass a saddle vertex. Each is as long
as its polyline, those of exact cells do not depend on the graph.)";

SurfacePoints centers(const Cells& cells, const py::object& density, const py::object& threads, const py::object& job) {
  ArrayIn<double> weights;
  if (!density.is_none()) weights = as_reals(density, "density", cells.mesh().vertex_count());
  const int count = as_integer(threads, "threads");
  const JobIn token(job);
  return without_gil([&] { return cell_centers(cells.mesh(), cells.diagram, weights.values, count, token); });
}

SurfacePoints center_of_points(const py::object& graph, const py::object& points, const py::object& weights,
                               const py::object& job) {
  const SaddleVertexGraph& g = as_graph(graph);
  const SurfacePoints given = as_surface_points(points, g.mesh(), "points");
  ArrayIn<double> shares;
  if (!weights.is_none()) shares = as_reals(weights, "weights", static_cast<Index>(given.size()));
  const JobIn token(job);
  return {without_gil([&] { return geodesic_center(g, given, shares.values, token); })};
}

constexpr const char* k_centers_doc = R"(The center of each cell: where its squared geodesic distances are least in sum.

Parameters
----------
density : (V,) float array, optional
    As in `centroidal_voronoi`: weighs by its square.
threads : int
    0: all cores. The result does not depend on it.
job : Job, optional

Returns
-------
SurfacePoints
    (n). Of a cell without area or density: its site.

Raises
------
InputError
    A density of the wrong length, with a negative or not finite value, or 0 everywhere.
Cancelled
    The job was cancelled.

Notes
-----
To a millionth of the cell's size where it is flat, unless the center is beside edges of 1e-10 of that.
O(f log f) for f faces of a cell. After [karcher1977].)";

constexpr const char* k_center_doc = R"(Find the point from which squared geodesic distances to points are least in sum.

Parameters
----------
graph : SaddleVertexGraph
points : (n,) int array or SurfacePoints
    Vertices, or points anywhere on one connected part of the surface.
weights : (n,) float array, optional
    0 or more. None: all the same.
job : Job, optional

Returns
-------
SurfacePoints
    One point. Where there are several such points, the one that the given point nearest to the mean in space leads to;
    on a mesh with lengths of its own, the first given one.

Raises
------
InputError
    No points, points off the mesh or on separate parts, weights that are negative, not finite or all 0.
Cancelled
    The job was cancelled.

Notes
-----
Steps to the mean of the points in the tangent plane, by exact distances, while they lower the sum and are longer than
1e-9 of the points' spread. Where the sum has a crease, through a saddle vertex, they may end beside its least. A few
log maps, O(m sqrt(m) log m) each for m vertices within the spread of the points. After [karcher1977].)";

constexpr const char* k_voronoi_doc = R"(Assign every point of the surface to its nearest site.

Bisectors are straight inside a face, right where both sites see it straight, past no saddle vertex and by one way.
Cells smaller than a face, and several sites in one face, are found.

Parameters
----------
graph : SaddleVertexGraph
sites : (n,) int array or SurfacePoints
    Vertices, or points anywhere on the surface.
exact : bool
    By exact distances instead of the graph's, as a reference: bisectors are hyperbolas where they should be, and no
    point lies in a cell whose site is farther than another by more than 1e-5 of a cell's size (the root of its area).
    Sites within 1e-10 of the extent of their part of the mesh of each other are one: the first of them has the cell.
    Where lengths were given, the extent is the root of its area, or its longest edge.
    Many times slower.
threads : int
    0: all cores. The result does not depend on it.
device : str
    "cpu"; "cuda", or "cuda:1" for the second CUDA device, which finds the vertices' nearest sites, all else being the
    processor's part, and keeps the graph's arcs from then on; "auto": that where a CUDA device built the graph or keeps
    it. Not with `exact`. The result does not depend on it.
job : Job, optional

Returns
-------
GeodesicVoronoi

Raises
------
InputError
    No sites, too many, a site off the mesh, a connected part of the mesh without a site; exact cells by a CUDA device.
DeviceError
    device="cuda" where there is no usable CUDA device or module, too little of its memory is free, or it fails.
Cancelled
    The job was cancelled.

Notes
-----
O(n k log k + arcs). After Y.-J. Liu, Z. Chen, K. Tang: Construction of iso-contours, bisectors, and Voronoi diagrams on
triangulated surfaces, IEEE TPAMI 33(8), 2011.)";

}  // namespace

py::object make_cells(GeodesicVoronoi&& diagram, const py::object& graph, bool by_cuda) {
  return py::cast(Cells{std::move(diagram), graph, by_cuda});
}

CellsIn as_cells(const py::object& value, const char* argument) {
  if (!py::isinstance<Cells>(value))
    throw InputError(message(argument, ": wanted a GeodesicVoronoi, got ", std::string(py::str(py::type::of(value)))));
  const auto& cells = py::cast<const Cells&>(value);
  return {cells.diagram, py::cast<const SaddleVertexGraph&>(cells.graph)};
}

void bind_tessellation(py::module_& m) {
  py::class_<VoronoiEdge>(m, "VoronoiEdge", py::module_local(), "The boundary between two cells, or a part of it.")
      .def_property_readonly(
          "points",
          [](const py::object& self) {
            return view_of(std::span<const Vec3>(py::cast<const VoronoiEdge&>(self).points), self);
          },
          "(m, 3) float64: positions along the polyline; a closed one repeats its first point.")
      .def_property_readonly(
          "surface", [](const VoronoiEdge& e) { return e.surface; }, "These points as SurfacePoints.")
      .def_property_readonly(
          "cells", [](const VoronoiEdge& e) { return py::make_tuple(e.cells[0], e.cells[1]); },
          "The cells on the left and on the right.")
      .def_readonly("closed", &VoronoiEdge::closed, "True for a loop without branch points.");

  py::class_<SplitMesh>(m, "SplitMesh", py::module_local(), "A mesh in which every triangle lies in exactly one cell.")
      .def_property_readonly(
          "vertices",
          [](const py::object& self) {
            return view_of(std::span<const Vec3>(py::cast<const SplitMesh&>(self).vertices), self);
          },
          "(S, 3) float64: the mesh's vertices, then those on cell boundaries.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            return view_of(std::span<const Triangle>(py::cast<const SplitMesh&>(self).triangles), self);
          },
          "(T, 3) int32.")
      .def_property_readonly(
          "triangle_cell",
          [](const py::object& self) {
            return view_of(std::span<const Index>(py::cast<const SplitMesh&>(self).triangle_cell), self);
          },
          "(T,) int32.")
      .def_property_readonly(
          "vertex_origin",
          [](const py::object& self) {
            return view_of(std::span<const Index>(py::cast<const SplitMesh&>(self).vertex_origin), self);
          },
          "(S,) int32: vertex of the original mesh, -1 for added ones.");

  py::class_<Cells>(m, "GeodesicVoronoi", py::module_local(), "Geodesic Voronoi cells; made by `geodesic_voronoi`.")
      .def_property_readonly(
          "sites", [](const Cells& c) { return c.diagram.sites; }, "SurfacePoints (n).")
      .def_property_readonly("vertex_cell", &array_of<&GeodesicVoronoi::vertex_cell>,
                             "(V,) int32: nearest site; ties: the smaller.")
      .def_property_readonly(
          "device", [](const Cells& c) { return c.by_cuda ? "cuda" : "cpu"; },
          "The device that found the vertices' nearest sites: \"cpu\" or \"cuda\".")
      .def_property_readonly("vertex_distance", &array_of<&GeodesicVoronoi::vertex_distance>,
                             "(V,) float64: distance to it, mesh units.")
      .def_property_readonly("areas", &array_of<&GeodesicVoronoi::areas>, "(n,) float64: they sum to the mesh's area.")
      .def_property_readonly("edges", &edges, "List of VoronoiEdge: the boundaries between cells.")
      .def_property_readonly(
          "edge_points", [](const Cells& c) { return to_array(positions_at(c.diagram, c.diagram.edge_points)); },
          "(m, 3) float64: the points of all edges, one after another.")
      .def_property_readonly(
          "edge_surface", [](const Cells& c) { return points_at(c.diagram, c.diagram.edge_points); },
          "These points as SurfacePoints.")
      .def_property_readonly("edge_offsets", &array_of<&GeodesicVoronoi::edge_offsets>,
                             "(e + 1,) int32: edge i is [offsets[i], offsets[i + 1]).")
      .def_property_readonly(
          "edge_cells",
          [](const py::object& self) {
            return view_of_rows<Index>(std::span<const std::array<Index, 2>>(diagram_of(self).edge_cells), self);
          },
          "(e, 2) int32: the cells on the left and on the right.")
      .def_property_readonly(
          "edge_closed",
          [](const Cells& c) {
            const auto& closed = c.diagram.edge_closed;
            py::array_t<bool> result(static_cast<py::ssize_t>(closed.size()));
            std::copy(closed.begin(), closed.end(), result.mutable_data());
            return result;
          },
          "(e,) bool: loops without branch points.")
      .def_property_readonly(
          "branch_points", [](const Cells& c) { return points_at(c.diagram, c.diagram.branch_points); },
          "SurfacePoints where three or more cells meet.")
      .def("corners", &corners, py::arg("cell"),
           "SurfacePoints around a cell: branch points and ends at the mesh's boundary, the cell on the left.")
      .def("dual_paths", &dual_paths, py::kw_only(), py::arg("threads") = 0, py::arg("job") = py::none(),
           k_dual_paths_doc)
      .def("centers", &centers, py::arg("density") = py::none(), py::kw_only(), py::arg("threads") = 0,
           py::arg("job") = py::none(), k_centers_doc)
      .def("dual", &dual, py::arg("policy") = "repair", py::kw_only(), py::arg("threads") = 0,
           py::arg("job") = py::none(), k_dual_doc)
      .def("polygons", &polygons, py::arg("policy") = "repair", py::kw_only(), py::arg("bend") = 0.15,
           py::arg("tolerance") = std::numeric_limits<double>::infinity(), py::arg("threads") = 0,
           py::arg("job") = py::none(), k_polygons_doc)
      .def("cells_at", &cells_at, py::arg("points"),
           "The cells of points of the surface (vertices or SurfacePoints), (m,) int32. Ties go to the smaller cell. "
           "O(cells that share a face) each.")
      .def("locate", &locate, py::arg("points"), py::kw_only(), py::arg("job") = py::none(),
           "The cells of points of the surface (vertices or SurfacePoints), (m,) int32, as `cells_at`, and the "
           "distances from the nearest site, (m,) float64: lengths of ways in the graph, never too short and too long "
           "by its accuracy at most, or exact ones of exact cells. O(k log k) each. Raises Cancelled.")
      .def(
          "split",
          [](const Cells& c) {
            const Mesh& mesh = c.mesh();
            return without_gil([&] { return c.diagram.split(mesh); });
          },
          "Cut the mesh along the cell boundaries: a SplitMesh. O(V + F).")
      .def("__repr__", [](const Cells& c) {
        return message("<saddleback.GeodesicVoronoi of ", c.diagram.sites.size(), " cells>");
      });
  m.def("geodesic_center", &center_of_points, py::arg("graph"), py::arg("points"), py::arg("weights") = py::none(),
        py::kw_only(), py::arg("job") = py::none(), k_center_doc);
  m.def("geodesic_voronoi", &find_cells, py::arg("graph"), py::arg("sites"), py::kw_only(), py::arg("exact") = false,
        py::arg("threads") = 0, py::arg("device") = "auto", py::arg("job") = py::none(), k_voronoi_doc);
  let_travel<VoronoiEdge>(m, "VoronoiEdge");
  let_travel<Cells>(m, "GeodesicVoronoi", &save_cells, &load_cells, 1);
}

}  // namespace saddleback::bindings
