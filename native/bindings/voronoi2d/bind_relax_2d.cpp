// Relaxation of sites in the plane.

#include "saddleback/voronoi2d/relax_2d.h"

#include "convert/planar.h"

namespace saddleback::bindings {
namespace {

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
    Stop when the energy falls by less than this share of itself.
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
    No sites, a coordinate that is not finite, a density that is negative, not finite or 0 all over the domain, options
    out of range.
Cancelled
    The job was cancelled.

Notes
-----
Per iteration O(n log n + rectangles that borders of cells cross). The energy is the integral of density^2 times squared
distance and never rises; integrals over cells are exact for the rectangles. S. Lloyd: Least squares quantization in
PCM, 1982. Q. Du, V. Faber, M. Gunzburger: Centroidal Voronoi Tessellations, 1999. A. Secord: Weighted Voronoi
stippling, 2002.)";

/// The raster as rows of doubles; keep `values` alive while the raster is used.
struct DensityIn {
  py::array_t<double, py::array::c_style> values;
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
  result.values = py::array_t<double, py::array::c_style>::ensure(rows);
  PyErr_Clear();
  if (!result.values || result.values.ndim() != 2 || result.values.size() == 0)
    throw InputError("density: wanted shape (rows, columns) of real numbers, or a callable");
  result.raster = {{result.values.data(), static_cast<std::size_t>(result.values.size())},
                   static_cast<Index>(result.values.shape(0)),
                   static_cast<Index>(result.values.shape(1))};
  return result;
}

Relaxation2d relax(const py::object& sites, const py::object& domain, const py::object& density,
                   const py::object& max_iterations, const py::object& tolerance, const py::object& samples,
                   const py::object& threads, const py::object& job) {
  const std::vector<Vec2> points = as_points_2d(sites, "sites");
  const PlanarDomain within = as_domain(domain, "domain");
  const DensityIn raster = as_density(density, within, as_integer(samples, "samples"));
  const Relaxation2dOptions options{.density = raster.raster,
                                    .max_iterations = as_integer(max_iterations, "max_iterations"),
                                    .tolerance = as_real(tolerance, "tolerance"),
                                    .threads = as_integer(threads, "threads")};
  const JobIn token(job);
  return without_gil([&] { return relax_2d(points, within, options, token); });
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
          "(iterations + 1,) float64: of the start and after each iteration; never rises.")
      .def_readonly("iterations", &Relaxation2d::iterations, "Steps done.")
      .def_readonly("converged", &Relaxation2d::converged, "True if the sites rest.")
      .def_readonly("stop_reason", &Relaxation2d::stop_reason, "The reason why it ended.")
      .def("__repr__", [](const Relaxation2d& r) {
        return message("<saddleback.Relaxation2d of ", r.sites.size(), " sites after ", r.iterations, " iterations>");
      });
  m.def("relax_2d", &relax, py::arg("sites"), py::arg("domain"), py::arg("density") = py::none(),
        py::arg("max_iterations") = 100, py::arg("tolerance") = 1e-6, py::kw_only(), py::arg("samples") = 512,
        py::arg("threads") = 0, py::arg("job") = py::none(), k_doc);
}

}  // namespace saddleback::bindings
