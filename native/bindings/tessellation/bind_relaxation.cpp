// CentroidalVoronoi, what shows and what keeps its cells, and the function that makes it.

#include <pybind11/stl.h>

#include "saddleback/tessellation/centroidal_voronoi.h"

#include "convert/cells.h"
#include "convert/curves.h"
#include "convert/devices.h"
#include "convert/fields.h"
#include "convert/points.h"
#include "convert/state.h"

namespace saddleback::bindings {
namespace {

/// A cache together with the graph (a Python object) that it knows cells of.
struct GraphCells {
  CellCache cache;
  py::object graph;
};

struct Relaxed {
  CentroidalVoronoi result;
  py::object cells;
};

py::tuple save_relaxed(const py::object& self) {
  const auto& relaxed = py::cast<const Relaxed&>(self);
  return py::make_tuple(relaxed.cells, state_of(relaxed.result));
}

Relaxed load_relaxed(const py::tuple& state) {
  const py::tuple parts = as_state(state, 2);
  as_cells(parts[0], "state");
  Relaxed relaxed{{}, parts[0]};
  restore(parts[1], relaxed.result);
  return relaxed;
}

RelaxationMethod as_method(const std::string& name) {
  if (name == "lbfgs") return RelaxationMethod::lbfgs;
  if (name == "lloyd") return RelaxationMethod::lloyd;
  throw InputError(message("method: wanted 'lbfgs' or 'lloyd', got '", name, "'"));
}

RelaxationStart::From as_start(const std::string& name) {
  using From = RelaxationStart::From;
  if (name == "auto") return From::automatic;
  if (name == "coarse_to_fine") return From::coarse_to_fine;
  if (name == "coarse_mesh") return From::coarse_mesh;
  if (name == "sample") return From::sample;
  throw InputError(message("start: wanted 'auto', 'coarse_to_fine', 'coarse_mesh' or 'sample', got '", name, "'"));
}

/// Shows memory that is never written again: Python's pointer to it is not const, for want of a holder that is.
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
              const py::object& cache, bool closed_ball, bool return_when_cancelled, const py::object& watch,
              const py::object& threads, const std::string& device, const py::object& job) {
  const SaddleVertexGraph& g = as_graph(graph);
  if (sites.is_none() == count.is_none()) throw InputError("sites, count: wanted one of the two");
  ArrayIn<double> weights;
  if (!density.is_none()) weights = as_reals(density, "density", g.mesh().vertex_count());
  ArrayIn<Index> stay, on_curves;
  if (!fixed.is_none()) stay = as_indices(fixed, "fixed");
  if (!held.is_none()) on_curves = as_indices(held, "held");
  const CurvesIn lines = as_curves(curves);
  CentroidalVoronoiOptions options{
      .density = weights.values,
      .method = as_method(method),
      .start = {.starts = as_integer(starts, "starts"), .annealing = as_integer(annealing, "annealing")},
      .constraints = {.fixed = stay.values, .curves = lines.curves, .held = on_curves.values},
      .stop = {.max_iterations = as_integer(max_iterations, "max_iterations"),
               .tolerance = as_real(tolerance, "tolerance"),
               .least_move = as_real(least_move, "least_move"),
               .return_when_cancelled = return_when_cancelled},
      .closed_ball = closed_ball,
      .cache = as_cache(cache, graph),
      .watch = as_watch(watch),
      .threads = as_integer(threads, "threads")};
  options.start.seed = as_seed(seed, "seed");
  options.start.from = as_start(start);
  const JobIn token(job);
  SurfacePoints given;
  if (!sites.is_none()) given = as_surface_points(sites, g.mesh(), "sites");
  const Index wanted = count.is_none() ? 0 : as_integer(count, "count");
  const bool has_count = !count.is_none();
  CentroidalVoronoi result = run_on(device, is_search_worth_a_device(g), [&](const std::vector<int>& devices) {
    options.cuda_device = first_device(devices);
    return without_gil([&] {
      return has_count ? centroidal_voronoi(g, wanted, options, token) : centroidal_voronoi(g, given, options, token);
    });
  });
  as_cache(cache, graph);  // another call may have been with another graph meanwhile
  py::object cells = make_cells(std::move(result.cells), graph, options.cuda_device >= 0);
  return {std::move(result), std::move(cells)};
}

constexpr const char* k_centroidal_doc = R"(Spread sites so that each lies at the center of its cell: even cells.

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
    "lbfgs" (fewer iterations) or "lloyd" (each site to the center of its cell).
max_iterations : int
tolerance : float
    Stop when the energy falls by less than this share of itself.
seed : int
    Of the sampled start.
start : str
    Where the sites of `count` come from. "coarse_to_fine": relaxed cells of a quarter of the number, with one more on
    each boundary between two of them, and so on down; few irregular cells remain. "sample": by density and seed. The
    same without iterations. "auto": from coarse cells when max_iterations is 50 or more. "coarse_mesh": from cells
    relaxed so on a mesh of 20 vertices for each (10,000 at least), where the mesh has five times as many vertices, no
    lengths of its own and no site is fixed: a tenth of max_iterations, 5 at least, is then made, and counted, on the
    mesh itself. As even cells, of a million vertices in a fourth of the time.
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
    apart as neighbors in even cells; the ends of open curves stay where they are (of those
    less than half a cell apart along curves, one). Others whose cells reach across a
    curve are put onto it.
held : (n,) int array, optional
    With `sites`: the curve that each is held on, -1 for free ones. Held sites begin at the nearest points of their curves.
least_move : float
    Sites that an iteration would move by less, in roots of their cells' areas, stay where they are, and cells that
    neither move nor have neighbors that do are not found anew: where most sites rest, iterations are short. When all
    would stay, the run ends. 1e-3 is less than one sees.
cache : CellCache, optional
    Cells to begin with, and afterwards those of the result.
closed_ball : bool
    Afterwards move sites from where they are least needed to where the cells break the closed-ball property (a cell that
    is no disk, two cells that meet twice, ...), and relax all again as far as nothing breaks it: the dual of just `count`
    sites is then a triangulation of the surface. Fixed sites stay, held ones stay on their curves. The energy may end
    above where the first relaxation did. Where no site can be spared, or 40 rounds of moving some do not help, or ten do
    not leave fewer faults, the sites are left as they were, and `CentroidalVoronoi.issues` tells so.
return_when_cancelled : bool
    When the job is cancelled during annealing or the iterations, return the best found so far instead of raising.
watch : RelaxationWatch, optional
    Shown the start and each iteration, for another thread to look at meanwhile.
threads : int
    0: all cores. The result does not depend on it.
device : str
    "cpu"; "cuda", or "cuda:1" for the second CUDA device, which finds the vertices' nearest sites in every iteration, all
    else being the processor's part, and keeps the graph's arcs from then on; "auto": that where a CUDA device built the
    graph or keeps it. The result does not depend on it.
job : Job, optional

Returns
-------
CentroidalVoronoi

Raises
------
InputError
    Neither or both of sites and count; fewer cells than connected parts, or than the curves need; a fixed site or a curve
    out of range, a curve of another mesh; a density of the wrong length, with a negative or not finite value, or 0 everywhere; what `geodesic_voronoi` refuses.
DeviceError
    device="cuda" where there is no usable CUDA device or module, too little of its memory is free, or it fails.
Cancelled
    The job was cancelled.

Notes
-----
O(n k log k + arcs) per iteration. The energy is the integral of density^2 times squared distance and never rises.
Q. Du, V. Faber, M. Gunzburger: Centroidal Voronoi Tessellations, SIAM Review 41(4), 1999. Y. Liu, W. Wang, B. Levy,
F. Sun, D.-M. Yan, L. Lu, C. Yang: On centroidal Voronoi tessellation, ACM TOG 28(4), 2009. S. Kirkpatrick, C. Gelatt,
M. Vecchi: Optimization by simulated annealing, Science 220, 1983.)";

}  // namespace

void bind_relaxation(py::module_& m) {
  py::class_<RelaxationStep, std::shared_ptr<RelaxationStep>>(
      m, "RelaxationStep", py::module_local(),
      "The sites after some iteration of a relaxation; from `RelaxationWatch.latest`.")
      .def_property_readonly(
          "sites", [](const RelaxationStep& step) { return step.sites; }, "(n,) SurfacePoints.")
      .def_property_readonly(
          "iterations", [](const RelaxationStep& step) { return step.iterations; },
          "Number of iterations done; 0: the start.")
      .def_property_readonly(
          "energy", [](const RelaxationStep& step) { return step.energy; }, "Energy as in `CentroidalVoronoi.energy`.");
  py::class_<RelaxationWatch>(m, "RelaxationWatch", py::module_local(),
                              R"(Shows the sites of a relaxation while it goes on in another thread.

Pass it as ``watch=`` to `centroidal_voronoi`. Coarse cells and annealing, which make the start, are not shown. After an exchange of
sites (`closed_ball`) the iterations begin again.)")
      .def(py::init<>())
      .def("latest", &latest_step, "The `RelaxationStep` that was reached, None before the first. O(1).");

  py::class_<GraphCells>(m, "CellCache", py::module_local(),
                         R"(Keeps the cells that a relaxation ended with, for the next one on the same graph.

Pass it as ``cache=`` to `centroidal_voronoi`. Called again with the same graph, that finds anew only cells whose sites, or
whose neighbors' sites, are elsewhere: move, add or remove a few of the result's sites (the others in the same order) and
only their surroundings are computed. With another density, all masses and centers are found anew, and no cells. With
``least_move`` above 0 this goes for every iteration. Other cells stay the same to the bit. About 1 KB a vertex, and the
graph, are kept.)")
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
          "(iterations + 1,) float64: at the start and after each iteration; never rises. After an exchange of sites "
          "(`closed_ball`) those of the relaxation that followed.")
      .def_property_readonly(
          "iterations", [](const Relaxed& r) { return r.result.iterations; }, "Iterations done.")
      .def_property_readonly(
          "converged", [](const Relaxed& r) { return r.result.converged; }, "False when max_iterations ended it.")
      .def_property_readonly(
          "stop_reason", [](const Relaxed& r) { return r.result.stop_reason; },
          "\"tolerance\", \"no step lowers the energy\", \"least_move\", \"max_iterations\" or \"cancelled\"; "
          "\"closed_ball\" where no more steps kept the dual a triangulation.")
      .def_property_readonly(
          "exchanged", [](const Relaxed& r) { return r.result.exchanged; },
          "Number of sites that `closed_ball` moved to where the dual's topology needs them.")
      .def_property_readonly(
          "issues", [](const Relaxed& r) { return r.result.issues; },
          "List of DualIssue, with `closed_ball`: where the cells' dual is no triangulation all the same.")
      .def_property_readonly(
          "held",
          [](const Relaxed& r) {
            std::vector<Index> held = r.result.held;
            held.resize(r.result.sites.size(), k_none);
            return to_array(std::move(held));
          },
          "(n,) int32: the curve that each site is held on, -1 for free ones.")
      .def_property_readonly(
          "normalized_energy", [](const Relaxed& r) { return r.result.normalized_energy; },
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
        py::arg("closed_ball") = false, py::arg("return_when_cancelled") = false, py::arg("watch") = py::none(),
        py::arg("threads") = 0, py::arg("device") = "auto", py::arg("job") = py::none(), k_centroidal_doc);
  let_travel<Relaxed>(m, "CentroidalVoronoi", &save_relaxed, &load_relaxed);
}

}  // namespace saddleback::bindings
