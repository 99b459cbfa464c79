// GeodesicVoronoi, SplitMesh, CentroidalVoronoi and the functions that make them.

#include <span>

#include "saddleback/centroidal_voronoi.h"
#include "saddleback/dual_mesh.h"
#include "saddleback/geodesic_centre.h"

#include "points.h"

namespace saddleback::bindings {
namespace {

/// A diagram together with the graph (a Python object) whose mesh it lies on.
struct Cells {
  GeodesicVoronoi diagram;
  py::object graph;
  const Mesh& mesh() const { return py::cast<const SaddleVertexGraph&>(graph).mesh(); }
};

struct VoronoiEdge {
  std::vector<Vec3> points;
  SurfacePoints surface;
  std::array<Index, 2> cells;
  bool closed;
};

/// A cache together with the graph (a Python object) that it knows cells of.
struct GraphCells {
  CellCache cache;
  py::object graph;
};

struct Relaxed {
  CentroidalVoronoi result;
  py::object cells;
};

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

DualMesh dual(const Cells& cells, const std::string& policy, const py::object& threads, const py::object& job) {
  const auto& graph = py::cast<const SaddleVertexGraph&>(cells.graph);
  const DualPolicy chosen = as_policy(policy);
  const int count = as_integer(threads, "threads");
  Job* const token = as_job(job);
  return without_gil([&] { return dual_mesh(graph, cells.diagram, chosen, count, token); });
}

py::tuple locate(const Cells& cells, const py::object& points) {
  const SurfacePoints places = as_surface_points(points, cells.mesh(), "points");
  std::vector<Index> cell(places.size());
  std::vector<double> distance(places.size());
  const Mesh& mesh = cells.mesh();
  without_gil([&] {
    for (std::size_t i = 0; i < places.size(); ++i) {
      const CellAt at = cells.diagram.locate(mesh, places[i]);
      cell[i] = at.cell;
      distance[i] = at.distance;
    }
  });
  return py::make_tuple(to_array(std::move(cell)), to_array(std::move(distance)));
}

constexpr const char* k_dual_doc = R"(Make the dual mesh: the intrinsic Delaunay triangulation of the sites.

Parameters
----------
policy : str
    "repair": add sites where cells are too large for a triangulation of the surface (a cell that is no disk, two cells
    that meet twice, ...), until there is one. "strict": keep the sites; triangles and edges may repeat corners, and
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
    The policy is to fail and the cells have no triangulation as their dual; or no number of sites mends them.
Cancelled
    The job was cancelled.

Notes
-----
O(cells + boundaries). H. Edelsbrunner, N. R. Shah: Triangulating topological spaces, 1997 (the closed-ball property).)";

SurfacePoints corners(const Cells& cells, const py::object& cell) {
  return points_at(cells.diagram, cells.diagram.corners(as_integer(cell, "cell")));
}

py::object make_cells(GeodesicVoronoi&& diagram, const py::object& graph) {
  return py::cast(Cells{std::move(diagram), graph});
}

py::object find_cells(const py::object& graph, const py::object& sites, bool exact, const py::object& threads,
                      const py::object& job) {
  const auto& g = py::cast<const SaddleVertexGraph&>(graph);
  const SurfacePoints points = as_surface_points(sites, g.mesh(), "sites");
  const GeodesicVoronoiOptions options{.threads = as_integer(threads, "threads")};
  Job* const token = as_job(job);
  const auto find = [&] {
    return exact ? exact_voronoi(g.mesh(), points, token) : geodesic_voronoi(g, points, options, token);
  };
  return make_cells(without_gil(find), graph);
}

py::list dual_paths(const Cells& cells, const py::object& threads, const py::object& job) {
  const auto& graph = py::cast<const SaddleVertexGraph&>(cells.graph);
  const int count = as_integer(threads, "threads");
  Job* const token = as_job(job);
  py::list result;
  for (GeodesicPath& path : without_gil([&] { return dual_edge_paths(graph, cells.diagram, count, token); }))
    result.append(std::move(path));
  return result;
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
    In the order of `dual("strict").edges`: from site to site across the boundary between their cells.

Raises
------
Cancelled
    The job was cancelled.

Notes
-----
O(faces crossed) each, with a distance field for those that pass a saddle vertex.)";

SurfacePoints centres(const Cells& cells, const py::object& density, const py::object& threads, const py::object& job) {
  ArrayIn<double> weights;
  if (!density.is_none()) weights = as_reals(density, "density", cells.mesh().vertex_count());
  const int count = as_integer(threads, "threads");
  Job* const token = as_job(job);
  return without_gil([&] { return cell_centres(cells.mesh(), cells.diagram, weights.values, count, token); });
}

SurfacePoints centre_of_points(const py::object& graph, const py::object& points, const py::object& weights,
                               const py::object& job) {
  const auto& g = py::cast<const SaddleVertexGraph&>(graph);
  const SurfacePoints given = as_surface_points(points, g.mesh(), "points");
  ArrayIn<double> shares;
  if (!weights.is_none()) shares = as_reals(weights, "weights", static_cast<Index>(given.size()));
  Job* const token = as_job(job);
  return {without_gil([&] { return geodesic_centre(g, given, shares.values, token); })};
}

constexpr const char* k_centres_doc = R"(The centre of each cell: where its squared geodesic distances are least in sum.

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
O(f log f) for f faces of a cell. H. Karcher: Riemannian center of mass and mollifier smoothing, 1977.)";

constexpr const char* k_centre_doc = R"(Find the point from which squared geodesic distances to points are least in sum.

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
    One point. Where there are several such points, the one that the given point nearest to the mean in space leads to.

Raises
------
InputError
    No points, points off the mesh or on separate parts, weights that are negative, not finite or all 0.
Cancelled
    The job was cancelled.

Notes
-----
A few log maps, O(m sqrt(m) log m) each for m vertices within the spread of the points. H. Karcher: Riemannian center of
mass and mollifier smoothing, 1977.)";

RelaxationMethod as_method(const std::string& name) {
  if (name == "lbfgs") return RelaxationMethod::lbfgs;
  if (name == "lloyd") return RelaxationMethod::lloyd;
  throw InputError(message("method: wanted 'lbfgs' or 'lloyd', got '", name, "'"));
}

RelaxationStart as_start(const std::string& name) {
  if (name == "auto") return RelaxationStart::automatic;
  if (name == "coarse_to_fine") return RelaxationStart::coarse_to_fine;
  if (name == "sample") return RelaxationStart::sample;
  throw InputError(message("start: wanted 'auto', 'coarse_to_fine' or 'sample', got '", name, "'"));
}

std::vector<const SurfaceCurve*> as_curves(const py::object& curves) {
  std::vector<const SurfaceCurve*> result;
  if (curves.is_none()) return result;
  for (const py::handle& curve : curves) {
    if (!py::isinstance<SurfaceCurve>(curve))
      throw InputError(message("curves: wanted SurfaceCurves, got a ", Py_TYPE(curve.ptr())->tp_name));
    result.push_back(&py::cast<const SurfaceCurve&>(curve));
  }
  return result;
}

/// What is shown is never written again: Python's pointer to it is not const, for want of a holder that is.
std::shared_ptr<RelaxationStep> latest_step(const RelaxationWatch& watch) {
  return std::const_pointer_cast<RelaxationStep>(watch.latest());
}

RelaxationWatch* as_watch(const py::object& watch) {
  if (watch.is_none()) return nullptr;
  if (!py::isinstance<RelaxationWatch>(watch))
    throw InputError(message("watch: wanted a RelaxationWatch, got a ", Py_TYPE(watch.ptr())->tp_name));
  return &py::cast<RelaxationWatch&>(watch);
}

/// The cache for a call with a graph. What it knows of another one is forgotten: that graph may go.
CellCache* as_cache(const py::object& cache, const py::object& graph) {
  if (cache.is_none()) return nullptr;
  if (!py::isinstance<GraphCells>(cache))
    throw InputError(message("cache: wanted a CellCache, got a ", Py_TYPE(cache.ptr())->tp_name));
  auto& known = py::cast<GraphCells&>(cache);
  if (!known.graph.is(graph)) known.cache.clear();
  known.graph = graph;
  return &known.cache;
}

Relaxed relax(const py::object& graph, const py::object& sites, const py::object& count, const py::object& density,
              const std::string& method, const py::object& max_iterations, const py::object& tolerance,
              const py::object& seed, const std::string& start, const py::object& starts, const py::object& annealing,
              const py::object& fixed, const py::object& curves, const py::object& held, const py::object& least_move,
              const py::object& cache, bool return_when_cancelled, const py::object& watch, const py::object& threads,
              const py::object& job) {
  const auto& g = py::cast<const SaddleVertexGraph&>(graph);
  if (sites.is_none() == count.is_none()) throw InputError("sites, count: wanted one of the two");
  ArrayIn<double> weights;
  if (!density.is_none()) weights = as_reals(density, "density", g.mesh().vertex_count());
  ArrayIn<Index> stay, on_curves;
  if (!fixed.is_none()) stay = as_indices(fixed, "fixed");
  if (!held.is_none()) on_curves = as_indices(held, "held");
  const std::vector<const SurfaceCurve*> lines = as_curves(curves);
  const CentroidalVoronoiOptions options{.density = weights.values,
                                         .fixed = stay.values,
                                         .curves = lines,
                                         .held = on_curves.values,
                                         .method = as_method(method),
                                         .max_iterations = as_integer(max_iterations, "max_iterations"),
                                         .tolerance = as_real(tolerance, "tolerance"),
                                         .starts = as_integer(starts, "starts"),
                                         .annealing = as_integer(annealing, "annealing"),
                                         .least_move = as_real(least_move, "least_move"),
                                         .cache = as_cache(cache, graph),
                                         .return_when_cancelled = return_when_cancelled,
                                         .watch = as_watch(watch),
                                         .threads = as_integer(threads, "threads")};
  const std::uint64_t number = as_seed(seed, "seed");
  Job* const token = as_job(job);
  const RelaxationStart source = as_start(start);
  SurfacePoints given;
  if (!sites.is_none()) given = as_surface_points(sites, g.mesh(), "sites");
  const Index wanted = count.is_none() ? 0 : as_integer(count, "count");
  const bool has_count = !count.is_none();
  CentroidalVoronoi result = without_gil([&] {
    return has_count ? centroidal_voronoi(g, wanted, source, number, options, token)
                     : centroidal_voronoi(g, given, options, token);
  });
  as_cache(cache, graph);  // another call may have been with another graph meanwhile
  py::object cells = make_cells(std::move(result.cells), graph);
  return {std::move(result), std::move(cells)};
}

constexpr const char* k_voronoi_doc = R"(Assign every point of the surface to its nearest site.

Bisectors are straight inside a face, exactly right where the geodesics to both sites cross no saddle vertex. Cells
smaller than a face, and several sites in one face, are found.

Parameters
----------
graph : SaddleVertexGraph
sites : (n,) int array or SurfacePoints
    Vertices, or points anywhere on the surface.
exact : bool
    By exact distances instead of the graph's, as a reference: bisectors are hyperbolas where they should be, and no
    point lies in a cell whose site is farther than another by more than 1e-7 of a cell's size. Many times slower, and on
    one core.
threads : int
    0: all cores. The result does not depend on it.
job : Job, optional

Returns
-------
GeodesicVoronoi

Raises
------
InputError
    No sites, too many, a site off the mesh, a connected part of the mesh without a site.
Cancelled
    The job was cancelled.

Notes
-----
O(n k log k + arcs). After Y.-J. Liu, Z. Chen, K. Tang: Construction of iso-contours, bisectors, and Voronoi diagrams on
triangulated surfaces, IEEE TPAMI 33(8), 2011.)";

constexpr const char* k_centroidal_doc = R"(Spread sites so that each lies at the centre of its cell: even cells.

Parameters
----------
graph : SaddleVertexGraph
sites : (n,) int array or SurfacePoints, optional
    Where to start. Either this or `count`.
count : int, optional
    Number of cells, at least one on every connected part; see `start`.
density : (V,) float array, optional
    Wanted number of cells per area at each vertex, in proportion; 0 or more. None: the same everywhere.
method : str
    "lbfgs" (fewer iterations) or "lloyd" (each site to the centre of its cell).
max_iterations : int
tolerance : float
    Stop when the energy falls by less than this share of itself.
seed : int
    Of the sampled start.
start : str
    Where the sites of `count` come from. "coarse_to_fine": relaxed cells of a quarter of the number, with one more on
    each boundary between two of them, and so on down; few irregular cells remain. "sample": by density and seed. The
    same without iterations. "auto": from coarse cells when max_iterations is 50 or more.
starts : int
    With `count`: so many relaxations, by the seeds from `seed` on. The one with the least energy is the result: where a
    relaxation ends depends on where it began.
annealing : int
    So many steps of simulated annealing before the iterations, each as long as one of those: the sites are shaken, less
    and less. Ends with less energy, and more even triangles, than any number of iterations; 300 are many. Sites that
    would end with more energy are left as they were.
fixed : (m,) int array, optional
    Sites that stay where they are.
curves : sequence of SurfaceCurve, optional
    Features or boundaries that sites slide along instead of leaving them. With `count`, sites are put on them as far
    apart as neighbours in even cells; the ends of open curves stay where they are. Others whose cells reach across a
    curve are put onto it.
held : (n,) int array, optional
    With `sites`: the curve that each is held on, -1 for free ones. Held sites begin at the nearest points of their curves.
least_move : float
    Sites that an iteration would move by less, in roots of their cells' areas, stay where they are, and cells that
    neither move nor have neighbours that do are not found anew: where most sites rest, iterations are short. When all
    would stay, the run ends. 1e-3 is less than one sees.
cache : CellCache, optional
    Cells to begin with, and afterwards those of the result.
return_when_cancelled : bool
    When the job is cancelled during annealing or the iterations, return the best found so far instead of raising.
watch : RelaxationWatch, optional
    Shown the start and each iteration, for another thread to look at meanwhile.
threads : int
    0: all cores. The result does not depend on it.
job : Job, optional

Returns
-------
CentroidalVoronoi

Raises
------
InputError
    Neither or both of sites and count; fewer cells than connected parts, or than the curves need; a fixed site or a curve
    out of range, a curve of another mesh; a density of the wrong length, with a negative or not finite value, or 0 everywhere; what `geodesic_voronoi` refuses.
Cancelled
    The job was cancelled.

Notes
-----
O(n k log k + arcs) per iteration. The energy is the integral of density^2 times squared distance and never rises.
Q. Du, V. Faber, M. Gunzburger: Centroidal Voronoi Tessellations, SIAM Review 41(4), 1999. Y. Liu, W. Wang, B. Levy,
F. Sun, D.-M. Yan, L. Lu, C. Yang: On centroidal Voronoi tessellation, ACM TOG 28(4), 2009. S. Kirkpatrick, C. Gelatt,
M. Vecchi: Optimization by simulated annealing, Science 220, 1983.)";

void bind_cells(py::module_& m) {
  py::class_<VoronoiEdge>(m, "VoronoiEdge", py::module_local(), "The boundary between two cells, or a part of it.")
      .def_property_readonly(
          "points",
          [](const py::object& self) {
            return view_of(std::span<const Vec3>(py::cast<const VoronoiEdge&>(self).points), self);
          },
          "(m, 3) float64: positions along the polyline; a closed one repeats its first point.")
      .def_property_readonly(
          "surface", [](const VoronoiEdge& e) { return e.surface; }, "The same as SurfacePoints.")
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
      .def_property_readonly("vertex_distance", &array_of<&GeodesicVoronoi::vertex_distance>,
                             "(V,) float64: distance to it, mesh units.")
      .def_property_readonly("areas", &array_of<&GeodesicVoronoi::areas>, "(n,) float64: they sum to the mesh's area.")
      .def_property_readonly("edges", &edges, "List of VoronoiEdge: the boundaries between cells.")
      .def_property_readonly(
          "edge_points", [](const Cells& c) { return to_array(positions_at(c.diagram, c.diagram.edge_points)); },
          "(m, 3) float64: the points of all edges, one after another.")
      .def_property_readonly(
          "edge_surface", [](const Cells& c) { return points_at(c.diagram, c.diagram.edge_points); },
          "The same as SurfacePoints.")
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
      .def("centres", &centres, py::arg("density") = py::none(), py::kw_only(), py::arg("threads") = 0,
           py::arg("job") = py::none(), k_centres_doc)
      .def("dual", &dual, py::arg("policy") = "repair", py::kw_only(), py::arg("threads") = 0,
           py::arg("job") = py::none(), k_dual_doc)
      .def("locate", &locate, py::arg("points"),
           "The cells of points of the surface (vertices or SurfacePoints), (m,) int32, and the distances from their "
           "sites, (m,) float64. Ties go to the smaller cell. O(cells that share a face) each.")
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
  m.def("geodesic_centre", &centre_of_points, py::arg("graph"), py::arg("points"), py::arg("weights") = py::none(),
        py::kw_only(), py::arg("job") = py::none(), k_centre_doc);
  m.def("geodesic_voronoi", &find_cells, py::arg("graph"), py::arg("sites"), py::kw_only(), py::arg("exact") = false,
        py::arg("threads") = 0, py::arg("job") = py::none(), k_voronoi_doc);
}

}  // namespace

void bind_tessellation(py::module_& m) {
  bind_cells(m);
  py::class_<RelaxationStep, std::shared_ptr<RelaxationStep>>(
      m, "RelaxationStep", py::module_local(),
      "The sites after some iteration of a relaxation; from `RelaxationWatch.latest`.")
      .def_property_readonly(
          "sites", [](const RelaxationStep& step) { return step.sites; }, "(n,) SurfacePoints.")
      .def_property_readonly(
          "iterations", [](const RelaxationStep& step) { return step.iterations; }, "How many were done; 0: the start.")
      .def_property_readonly(
          "energy", [](const RelaxationStep& step) { return step.energy; }, "As in `CentroidalVoronoi.energy`.");
  py::class_<RelaxationWatch>(m, "RelaxationWatch", py::module_local(),
                              R"(Shows the sites of a relaxation while it goes on in another thread.

Pass it as ``watch=`` to `centroidal_voronoi`. Coarse cells and annealing, which make the start, are not shown.)")
      .def(py::init<>())
      .def("latest", &latest_step, "The `RelaxationStep` that was reached, None before the first. O(1).");

  py::class_<GraphCells>(m, "CellCache", py::module_local(),
                         R"(Keeps the cells that a relaxation ended with, for the next one on the same graph.

Pass it as ``cache=`` to `centroidal_voronoi`. Called again with the same graph and density, that finds anew only cells whose
sites, or whose neighbours' sites, are elsewhere: move, add or remove a few of the result's sites (the others in the same
order) and only their surroundings are computed. With ``least_move`` above 0 this goes for every iteration. Other cells stay
the same to the bit. About 1 KB a vertex, and the graph, are kept.)")
      .def(py::init<>())
      .def(
          "clear",
          [](GraphCells& known) {
            known.cache.clear();
            known.graph = py::none();
          },
          "Forgets what is kept.");

  py::class_<Relaxed>(m, "CentroidalVoronoi", py::module_local(), "Even cells; made by `centroidal_voronoi`.")
      .def_property_readonly(
          "sites", [](const Relaxed& r) { return r.result.sites; }, "SurfacePoints (n).")
      .def_readonly("cells", &Relaxed::cells, "GeodesicVoronoi of the sites.")
      .def_property_readonly(
          "energy",
          [](const py::object& self) {
            return view_of(std::span<const double>(py::cast<const Relaxed&>(self).result.energy), self);
          },
          "(iterations + 1,) float64: at the start and after each iteration; never rises.")
      .def_property_readonly(
          "iterations", [](const Relaxed& r) { return r.result.iterations; }, "Iterations done.")
      .def_property_readonly(
          "converged", [](const Relaxed& r) { return r.result.converged; }, "False when max_iterations ended it.")
      .def_property_readonly(
          "stop_reason", [](const Relaxed& r) { return r.result.stop_reason; },
          "\"tolerance\", \"no step lowers the energy\", \"least_move\", \"max_iterations\" or \"cancelled\".")
      .def_property_readonly(
          "held",
          [](const Relaxed& r) {
            std::vector<Index> held = r.result.held;
            held.resize(r.result.sites.size(), k_none);
            return to_array(std::move(held));
          },
          "(n,) int32: the curve that each site is held on, -1 for free ones.")
      .def_property_readonly(
          "normalised_energy", [](const Relaxed& r) { return r.result.normalised_energy; },
          "Energy without a scale: near 1 for many nearly regular hexagons, larger for worse cells.")
      .def("__repr__", [](const Relaxed& r) {
        return message("<saddleback.CentroidalVoronoi of ", r.result.sites.size(), " cells, ", r.result.iterations,
                       " iterations>");
      });
  m.def("centroidal_voronoi", &relax, py::arg("graph"), py::arg("sites") = py::none(), py::arg("count") = py::none(),
        py::arg("density") = py::none(), py::arg("method") = "lbfgs", py::arg("max_iterations") = 100,
        py::arg("tolerance") = 1e-6, py::arg("seed") = 0, py::kw_only(), py::arg("start") = "auto",
        py::arg("starts") = 1, py::arg("annealing") = 0, py::arg("fixed") = py::none(), py::arg("curves") = py::none(),
        py::arg("held") = py::none(), py::arg("least_move") = 0.0, py::arg("cache") = py::none(),
        py::arg("return_when_cancelled") = false, py::arg("watch") = py::none(), py::arg("threads") = 0,
        py::arg("job") = py::none(), k_centroidal_doc);
}

}  // namespace saddleback::bindings
