// hausdorff_distance and what it returns.

#include "saddleback/mesh/hausdorff_distance.h"

#include "convert/fields.h"
#include "convert/points.h"
#include "convert/state.h"

namespace saddleback::bindings {
namespace {

struct Hausdorff {
  FarthestPoint of_first, of_second;
  double distance() const { return std::max(of_first.distance, of_second.distance); }
};
auto fields_of(Hausdorff& of) { return std::tie(of.of_first, of.of_second); }

Hausdorff measure(const py::object& first, const py::object& second, const py::object& tolerance,
                  const py::object& limit, const py::object& threads, const py::object& job) {
  const Mesh &a = as_mesh(first, "first"), &b = as_mesh(second, "second");
  const HausdorffOptions options{.tolerance = as_real(tolerance, "tolerance"),
                                 .limit = as_real(limit, "limit"),
                                 .threads = as_integer(threads, "threads")};
  const JobIn token(job);
  return without_gil([&] {
    const JobStage stage(token, "Measuring the distance of two surfaces");
    Hausdorff result;
    result.of_first = farthest_point(a, b, options, stage.part(0, 0.5));
    result.of_second = farthest_point(b, a, options, stage.part(0.5, 1));
    stage.update(1);
    return result;
  });
}

constexpr const char* k_doc = R"(Measure how far two surfaces are from each other, through space.

Parameters
----------
first, second : Mesh
tolerance : float
    By which distances may be too small, as a share of the diagonal of both meshes' box.
limit : float
    A length, 0 for none: only whether something is farther is found out, which takes less time. A distance above the
    limit may be any of those; one below may be anything up to it, or the tolerance more than it says.
threads : int
    0: all cores. The result does not depend on it.
job : Job, optional

Returns
-------
HausdorffDistance

Raises
------
InputError
    A tolerance that is not above 0, a limit that is negative.
Cancelled
    The job was cancelled.

Notes
-----
All points of the triangles count, not the vertices alone. About O((V + F) log F). M. Tang, M. Lee, Y. J. Kim:
Interactive Hausdorff distance computation for general polygonal models, 2009.)";

}  // namespace

void bind_hausdorff_distance(py::module_& m) {
  py::class_<Hausdorff>(m, "HausdorffDistance", py::module_local(),
                        "The distance of two surfaces from each other; made by `hausdorff_distance`.")
      .def_property_readonly("distance", &Hausdorff::distance, "The greater of the two.")
      .def_property_readonly(
          "from_first", [](const Hausdorff& h) { return h.of_first.distance; },
          "Greatest distance of a point of the first mesh from the second.")
      .def_property_readonly(
          "from_second", [](const Hausdorff& h) { return h.of_second.distance; },
          "Greatest distance of a point of the second mesh from the first.")
      .def_property_readonly(
          "farthest_of_first", [](const Hausdorff& h) { return SurfacePoints{h.of_first.point}; },
          "SurfacePoints (1) of the first mesh.")
      .def_property_readonly(
          "farthest_of_second", [](const Hausdorff& h) { return SurfacePoints{h.of_second.point}; },
          "SurfacePoints (1) of the second mesh.")
      .def("__repr__", [](const Hausdorff& h) {
        return message("<saddleback.HausdorffDistance ", h.distance(), ": ", h.of_first.distance, " and ",
                       h.of_second.distance, ">");
      });
  m.def("hausdorff_distance", &measure, py::arg("first"), py::arg("second"), py::arg("tolerance") = 1e-4, py::kw_only(),
        py::arg("limit") = 0.0, py::arg("threads") = 0, py::arg("job") = py::none(), k_doc);
  let_travel<Hausdorff>(m, "HausdorffDistance");
}

}  // namespace saddleback::bindings
