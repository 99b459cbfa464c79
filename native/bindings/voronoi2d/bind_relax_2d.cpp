// Relaxation of sites in the plane.

#include "saddleback/voronoi2d/balance_2d.h"
#include "saddleback/voronoi2d/relax_2d.h"

#include "convert/planar.h"

namespace saddleback::bindings {
namespace {

constexpr const char* k_balance_doc =
    R"(Moves sites to the centers of their cells within a domain, all of which have the same mass: the evenest stippling.

Cells are those of a power diagram, whose weights are found with the sites: each cell has just its capacity, an equal
share of the density's mass or one of its own. Where sites must stay, the weights alone are found, those of
semi-discrete optimal transport.

Parameters
----------
sites : (n, 2) float array
    One whose cell has no mass (outside, where the density is 0, equal to another) is put into a heavy cell first.
domain : (m, 2) float array or list of such
    A simple polygon, or an outline and its holes.
density : (rows, columns) float array or callable, optional
    Mass per area, in proportion, as `relax_2d` takes it: what dots at the sites have as their tone. None: uniform.
capacities : (n,) float array, optional
    Shares of the whole mass, which sum to 1. None: all alike.
max_iterations : int
    Steps of the sites, in each of which the capacities are met. 0: the sites stay.
tolerance : float
    Stop when the energy falls by less than this share of itself.
capacity_tolerance : float
    How far the mass of a cell may be from its capacity, in shares of that.
samples : int
    Of a callable, each way.
threads : int
    0: all cores. The result does not depend on it.
job : Job, optional

Returns
-------
Balance2d
    `power_diagram_2d(result.sites, result.weights, domain)` has the cells.

Raises
------
InputError
    No sites, a coordinate that is not finite, a density that is negative, not finite or 0 all over the domain, capacities
    that are not positive or do not sum to 1, options out of range; with `max_iterations` 0 a site whose cell has no mass.
Cancelled
    The job was cancelled.

Notes
-----
O(n^1.5 + rectangles that borders of cells cross) a step of Newton's method, of which the first weights take some 4 to 10
and each iteration 2. The energy, the integral of density times squared distance, never rises. F. de Goes, K. Breeden, V.
Ostromoukhov, M. Desbrun: Blue noise through optimal transport, 2012. J. Kitagawa, Q. Merigot, B. Thibert: Convergence of
a Newton algorithm for semi-discrete optimal transport, 2019.)";

constexpr const char* k_doc =
    R"(Moves sites to the centers of their cells within a domain until they rest: even cells, stippling.

Parameters
----------
sites : (n, 2) float array
    A site whose cell has no mass (outside, where the density is 0, equal to an earlier one) stays.
domain : (m, 2) float array or list of such
    A simple polygon, or an outline and its holes.
density : (rows, columns) float array or callable, optional
    The wanted number of cells per area, in proportion, over the domain's bounding box: equal rectangles, the first row
    at the least y (an image read from a file usually begins at the top). A callable takes (k, 2) places and returns
    (k,) densities; it is asked once, in the middles of `samples` by `samples` rectangles. None: uniform.
max_iterations : int
tolerance : float
    Stop when the energy falls by less than this share of itself; with weights when no site moves farther than this share
    of a mean cell's width.
weights : (n,) float array, optional
    Of `voronoi_2d`: cells are those of disks, which keep their radii. Hidden sites stay.
samples : int
    Of a callable, each way.
threads : int
    0: all cores. The result does not depend on it.
job : Job, optional

Returns
-------
Relaxation2d

Raises
------
InputError
    No sites, a coordinate or weight that is not finite, a wrong number of weights, a density that is negative, not
    finite or 0 all over the domain, options out of range.
Cancelled
    The job was cancelled.

Notes
-----
Per iteration O(n log n + rectangles that borders of cells cross). The energy is the integral of density^2 times squared
distance and never rises; with weights, whose cells are not the best for it, it may rise by little. Integrals over cells
are exact for the rectangles. S. Lloyd: Least squares quantization in
PCM, 1982. Q. Du, V. Faber, M. Gunzburger: Centroidal Voronoi Tessellations, 1999. A. Secord: Weighted Voronoi
stippling, 2002.)";

constexpr const char* k_areas_doc =
    R"(Finds the weights with which the cells of `voronoi_2d(sites, weights)`, within a domain, have given areas.

Parameters
----------
sites : (n, 2) float array
    They stay. Without weights each needs some area: refused are sites outside, where the density is 0, or equal to others.
domain : (m, 2) float array or list of such
    A simple polygon, or an outline and its holes.
areas : (n,) float array, optional
    The wanted areas, in proportion. None: all alike.
density : (rows, columns) float array or callable, optional
    As in `relax_2d`; its mass is wanted instead of area. None: uniform.
tolerance : float
    How far a cell's area may be from the wanted one, in shares of that. Polylines along curves are as fine as it takes.
max_iterations : int
samples : int
    Of a callable, each way.
threads : int
    0: all cores. The result does not depend on it.
job : Job, optional

Returns
-------
AreaWeights

Raises
------
InputError
    No sites, a coordinate that is not finite, a site that has no area without weights, a density that is negative, not
    finite or 0 all over the domain, areas that are not positive or of another number, options out of range.
Cancelled
    The job was cancelled.

Notes
-----
Such weights exist for any areas: those of optimal transport whose cost is the distance. By Newton's method with steps
short enough that no cell is lost and less is missing each time. O(n^1.5 + rectangles that borders cross) a step. J.
Kitagawa, Q. Merigot, B. Thibert: Convergence of a Newton algorithm for semi-discrete optimal transport, 2019.)";

/// The raster as rows of doubles; keep `values` alive while the raster is used.
struct DensityIn {
  ArrayIn<double> values;
  DensityRaster raster;
};

// A callable's values in the middles of rectangles over the domain's box.
py::object sampled(const py::object& density, const PlanarDomain& domain, Index samples) {
  if (samples < 1 || samples > 16384) throw InputError(message("samples: wanted 1 to 16384, got ", samples));
  Vec2 low = domain.loops()[0][0], high = low;
  for (const Vec2& corner : domain.loops()[0]) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  std::vector<Vec2> places;
  places.reserve(static_cast<std::size_t>(samples) * samples);
  for (Index row = 0; row < samples; ++row)
    for (Index column = 0; column < samples; ++column)
      places.emplace_back(low.x() + (column + 0.5) / samples * (high.x() - low.x()),
                          low.y() + (row + 0.5) / samples * (high.y() - low.y()));
  ArrayIn<double> values =
      as_reals(density(to_array(std::move(places))), "density", static_cast<Index>(samples * samples));
  return values.array.reshape({samples, samples});
}

DensityIn as_density(const py::object& value, const PlanarDomain& domain, Index samples) {
  if (value.is_none()) return {};
  const py::object rows = PyCallable_Check(value.ptr()) ? sampled(value, domain, samples) : value;
  DensityIn result;
  const char* const wanted = "shape (rows, columns) of real numbers, or a callable";
  result.values = as_rows(rows, "density", wanted);
  if (result.values.values.empty()) throw InputError(message("density: wanted ", wanted, ", got nothing"));
  result.raster = {result.values.values, result.values.count, static_cast<Index>(result.values.array.shape(1))};
  return result;
}

Relaxation2d relax(const py::object& sites, const py::object& domain, const py::object& density,
                   const py::object& max_iterations, const py::object& tolerance, const py::object& weights,
                   const py::object& samples, const py::object& threads, const py::object& job) {
  const std::vector<Vec2> points = as_points_2d(sites, "sites");
  const std::vector<double> radii = as_weights(weights, points.size());
  const PlanarDomain within = as_domain(domain, "domain");
  const DensityIn raster = as_density(density, within, as_integer(samples, "samples"));
  const Relaxation2dOptions options{.density = raster.raster,
                                    .weights = radii,
                                    .max_iterations = as_integer(max_iterations, "max_iterations"),
                                    .tolerance = as_real(tolerance, "tolerance"),
                                    .threads = as_integer(threads, "threads")};
  const JobIn token(job);
  return without_gil([&] { return relax_2d(points, within, options, token); });
}

Balance2d balance(const py::object& sites, const py::object& domain, const py::object& density,
                  const py::object& capacities, const py::object& max_iterations, const py::object& tolerance,
                  const py::object& capacity_tolerance, const py::object& samples, const py::object& threads,
                  const py::object& job) {
  const std::vector<Vec2> points = as_points_2d(sites, "sites");
  const PlanarDomain within = as_domain(domain, "domain");
  const DensityIn raster = as_density(density, within, as_integer(samples, "samples"));
  ArrayIn<double> shares;
  if (!capacities.is_none()) shares = as_reals(capacities, "capacities", static_cast<Index>(points.size()));
  const Balance2dOptions options{.density = raster.raster,
                                 .capacities = shares.values,
                                 .max_iterations = as_integer(max_iterations, "max_iterations"),
                                 .tolerance = as_real(tolerance, "tolerance"),
                                 .capacity_tolerance = as_real(capacity_tolerance, "capacity_tolerance"),
                                 .threads = as_integer(threads, "threads")};
  const JobIn token(job);
  return without_gil([&] { return balance_2d(points, within, options, token); });
}

AreaWeights weigh(const py::object& sites, const py::object& domain, const py::object& areas, const py::object& density,
                  const py::object& tolerance, const py::object& max_iterations, const py::object& samples,
                  const py::object& threads, const py::object& job) {
  const std::vector<Vec2> points = as_points_2d(sites, "sites");
  const PlanarDomain within = as_domain(domain, "domain");
  const DensityIn raster = as_density(density, within, as_integer(samples, "samples"));
  ArrayIn<double> wanted;
  if (!areas.is_none()) wanted = as_reals(areas, "areas", static_cast<Index>(points.size()));
  const AreaWeightsOptions options{.density = raster.raster,
                                   .areas = wanted.values,
                                   .tolerance = as_real(tolerance, "tolerance"),
                                   .max_iterations = as_integer(max_iterations, "max_iterations"),
                                   .threads = as_integer(threads, "threads")};
  const JobIn token(job);
  return without_gil([&] { return weights_for_areas(points, within, options, token); });
}

template <auto Member>
py::array weights_array(const py::object& self) {
  return view_of(std::span(py::cast<const AreaWeights&>(self).*Member), self);
}

template <auto Member>
py::array balance_array(const py::object& self) {
  return view_of(std::span(py::cast<const Balance2d&>(self).*Member), self);
}

}  // namespace

void bind_relax_2d(py::module_& m) {
  py::class_<Relaxation2d>(m, "Relaxation2d", py::module_local(), "Relaxed sites; made by `relax_2d`.")
      .def_property_readonly(
          "sites",
          [](const py::object& self) {
            return view_of_rows<double>(std::span(py::cast<const Relaxation2d&>(self).sites), self);
          },
          "(n, 2) float64.")
      .def_property_readonly(
          "energy",
          [](const py::object& self) { return view_of(std::span(py::cast<const Relaxation2d&>(self).energy), self); },
          "(iterations + 1,) float64: of the start and after each iteration; never rises without weights.")
      .def_readonly("iterations", &Relaxation2d::iterations, "Steps done.")
      .def_readonly("converged", &Relaxation2d::converged, "True if the sites rest.")
      .def_readonly("stop_reason", &Relaxation2d::stop_reason, "The reason why it ended.")
      .def("__repr__", [](const Relaxation2d& r) {
        return message("<saddleback.Relaxation2d of ", r.sites.size(), " sites after ", r.iterations, " iterations>");
      });
  py::class_<Balance2d>(m, "Balance2d", py::module_local(), "Sites and weights of even cells; made by `balance_2d`.")
      .def_property_readonly(
          "sites",
          [](const py::object& self) {
            return view_of_rows<double>(std::span(py::cast<const Balance2d&>(self).sites), self);
          },
          "(n, 2) float64.")
      .def_property_readonly("weights", &balance_array<&Balance2d::weights>,
                             "(n,) float64: of the power diagram; their mean is 0.")
      .def_property_readonly("shares", &balance_array<&Balance2d::shares>,
                             "(n,) float64: of the whole mass in each cell.")
      .def_property_readonly(
          "energy", &balance_array<&Balance2d::energy>,
          "(iterations + 1,) float64: with the capacities met, of the start and after each iteration; "
          "never rises.")
      .def_readonly("capacity_error", &Balance2d::capacity_error, "The largest of a cell's, in shares of its capacity.")
      .def_readonly("iterations", &Balance2d::iterations, "Steps of the sites.")
      .def_readonly("converged", &Balance2d::converged, "True if the sites rest and the capacities are met.")
      .def_readonly("stop_reason", &Balance2d::stop_reason, "The reason why it ended.")
      .def("__repr__", [](const Balance2d& r) {
        return message("<saddleback.Balance2d of ", r.sites.size(), " sites after ", r.iterations, " iterations>");
      });
  py::class_<AreaWeights>(m, "AreaWeights", py::module_local(),
                          "Weights with which cells have given areas; made by `weights_for_areas`.")
      .def_property_readonly("weights", &weights_array<&AreaWeights::weights>,
                             "(n,) float64: of `voronoi_2d`; their mean is 0.")
      .def_property_readonly("shares", &weights_array<&AreaWeights::shares>,
                             "(n,) float64: of the domain's area, or of its mass, in each cell.")
      .def_property_readonly("lacks", &weights_array<&AreaWeights::lacks>,
                             "(iterations + 1,) float64: what cells lack or have too much, in shares of the whole, as "
                             "the root of the sum of "
                             "squares: of equal weights and after each iteration. Falls each time.")
      .def_readonly("error", &AreaWeights::error, "The largest of a cell's, in shares of the wanted area.")
      .def_readonly("iterations", &AreaWeights::iterations, "Steps of Newton's method.")
      .def_readonly("converged", &AreaWeights::converged, "True if the error is within the tolerance.")
      .def_readonly("stop_reason", &AreaWeights::stop_reason, "The reason why it ended.")
      .def("__repr__", [](const AreaWeights& r) {
        return message("<saddleback.AreaWeights of ", r.weights.size(), " cells, at most ", r.error, " off>");
      });
  m.def("balance_2d", &balance, py::arg("sites"), py::arg("domain"), py::arg("density") = py::none(),
        py::arg("capacities") = py::none(), py::arg("max_iterations") = 50, py::arg("tolerance") = 1e-4, py::kw_only(),
        py::arg("capacity_tolerance") = 1e-5, py::arg("samples") = 512, py::arg("threads") = 0,
        py::arg("job") = py::none(), k_balance_doc);
  m.def("relax_2d", &relax, py::arg("sites"), py::arg("domain"), py::arg("density") = py::none(),
        py::arg("max_iterations") = 100, py::arg("tolerance") = 1e-6, py::kw_only(), py::arg("weights") = py::none(),
        py::arg("samples") = 512, py::arg("threads") = 0, py::arg("job") = py::none(), k_doc);
  m.def("weights_for_areas", &weigh, py::arg("sites"), py::arg("domain"), py::arg("areas") = py::none(),
        py::arg("density") = py::none(), py::kw_only(), py::arg("tolerance") = 1e-4, py::arg("max_iterations") = 60,
        py::arg("samples") = 512, py::arg("threads") = 0, py::arg("job") = py::none(), k_areas_doc);
}

}  // namespace saddleback::bindings
