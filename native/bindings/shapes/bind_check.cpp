// The independent check of shapes on a surface.

#include "saddleback/distribution/check_distribution.h"

#include "convert/fields.h"
#include "convert/mapped_shapes.h"
#include "convert/points.h"
#include "convert/state.h"

namespace saddleback::bindings {
namespace {

constexpr const char* k_check_doc = R"(Finds whether shapes on a surface collide, in other ways than they were laid.

Outlines: all pairs of pieces in each face by exact predicates; a common point of two shapes is a fault. Nesting: which
shape each vertex lies in, spread from the edges that outlines cross, and on which side a point of every other outline is.
Patches: no triangle turned over, areas as in the shape's plane. Samples: points of the surface, even by area, none of
which may lie in two patches.

Args:
    mesh: the mesh that the shapes lie on.
    result: a MappedShapes, or anything with `placements` and `shapes` (and a `field` that they bend along), which are
        laid by `map_shapes` first.
    samples: how many points.
    seed: of the samples.
    threads: 0 for all cores; never changes the result.
    job: progress and cancellation.

Returns:
    CheckReport.

Raises:
    InputError: a result of another mesh, or of no kind that is known; a negative number of samples.
    Cancelled: the job was.

Notes:
    O(sum of squares of the pieces in a face + samples).
)";

const char* name_of(Fault fault) {
  switch (fault) {
    case Fault::not_laid:
      return "not_laid";
    case Fault::open:
      return "open";
    case Fault::crossing:
      return "crossing";
    case Fault::nesting:
      return "nesting";
    case Fault::overturned:
      return "overturned";
    case Fault::incomplete:
      return "incomplete";
    case Fault::covered_twice:
      return "covered_twice";
  }
  return "";
}

/// The report, and where its faults are.
struct Checked {
  CheckReport report;
  std::vector<Vec3> places;
};
auto fields_of(Checked& of) { return std::tie(of.report, of.places); }

Checked check_mapped(const py::object& mesh_object, const MappedShapes& mapped, const CheckOptions& options) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  if (&mesh != &mapped.mesh()) throw InputError("result: its shapes lie on another mesh");
  return without_gil([&] {
    Checked result{check_distribution(mesh, mapped.shapes, mapped.placements, mapped.mapped, options), {}};
    for (const FaultReport& fault : result.report.faults) result.places.push_back(position(mesh, fault.where));
    return result;
  });
}

Checked check_result(const py::object& mesh, const py::object& result, const py::object& samples,
                     const py::object& seed, const py::object& threads, const py::object& job) {
  CheckOptions options;
  options.samples = as_integer(samples, "samples");
  options.seed = as_seed(seed, "seed");
  options.threads = as_integer(threads, "threads");
  const JobIn token(job);
  options.job = token;
  if (py::isinstance<MappedShapes>(result)) return check_mapped(mesh, py::cast<const MappedShapes&>(result), options);
  if (!py::hasattr(result, "placements") || !py::hasattr(result, "shapes"))
    throw InputError(message("result: wanted a MappedShapes or a distribution, got a ",
                             py::cast<std::string>(py::type::of(result).attr("__name__"))));
  const py::object field = py::hasattr(result, "field") ? py::object(result.attr("field")) : py::none();
  const Job& whole = *options.job;
  const std::unique_ptr<MappedShapes> mapped =
      make_mapped(mesh, result.attr("shapes"), result.attr("placements"), field, py::make_tuple(0.5, 2.0), threads,
                  py::cast(whole.part(0, 0.5)));
  Job checking = whole.part(0.5, 1);
  options.job = &checking;
  return check_mapped(mesh, *mapped, options);
}

py::list faults_of(const Checked& self) {
  py::list result;
  for (std::size_t i = 0; i < self.report.faults.size(); ++i) {
    const FaultReport& fault = self.report.faults[i];
    const Vec3& place = self.places[i];
    const py::object second = fault.second == k_none ? py::object(py::none()) : py::object(py::int_(fault.second));
    result.append(
        py::make_tuple(name_of(fault.fault), fault.first, second, py::make_tuple(place.x(), place.y(), place.z())));
  }
  return result;
}

std::string text_of(const Checked& self) {
  const CheckReport& report = self.report;
  std::ostringstream out;
  out << report.placement_count << " shapes, " << report.piece_count << " pieces of outlines, " << report.triangle_count
      << " triangles, " << report.sample_count << " samples: ";
  if (report.fault_count == 0) return out << "no fault", out.str();
  out << report.fault_count << (report.fault_count == 1 ? " fault" : " faults");
  std::size_t shown = 0;
  for (const FaultReport& fault : report.faults) {
    if (++shown > 10) break;
    out << "\n  " << name_of(fault.fault) << ": " << fault.first;
    if (fault.second != k_none) out << " and " << fault.second;
  }
  return out.str();
}

}  // namespace

void bind_check(py::module_& m) {
  py::class_<Checked>(m, "CheckReport", py::module_local(),
                      "The findings of `check_distribution`; true when nothing is wrong.")
      .def_property_readonly(
          "ok", [](const Checked& self) { return self.report.fault_count == 0; }, "No fault at all.")
      .def_property_readonly(
          "faults", &faults_of,
          "List of (kind, placement, other placement or None, (x, y, z)), one for each kind and pair, "
          "1000 at most. Kinds: \"crossing\", \"nesting\", \"covered_twice\" of two shapes; "
          "\"not_laid\", \"open\", \"overturned\", \"incomplete\" of one.")
      .def_property_readonly(
          "fault_count", [](const Checked& self) { return self.report.fault_count; }, "Number of these.")
      .def_property_readonly(
          "coverage", [](const Checked& self) { return self.report.coverage; },
          "Share of the surface that lies in shapes, by the samples.")
      .def_property_readonly(
          "coverage_error", [](const Checked& self) { return self.report.coverage_error; },
          "Its standard deviation, were the samples independent.")
      .def_property_readonly(
          "patch_coverage", [](const Checked& self) { return self.report.patch_coverage; },
          "This share by the areas of the patches.")
      .def_property_readonly(
          "stretch", [](const Checked& self) { return py::make_tuple(self.report.smallest, self.report.largest); },
          "Smallest and largest singular value of the maps, by the triangles of the patches.")
      .def_property_readonly(
          "piece_count", [](const Checked& self) { return self.report.piece_count; },
          "Pieces of outlines that were compared.")
      .def_property_readonly(
          "triangle_count", [](const Checked& self) { return self.report.triangle_count; }, "Triangles of patches.")
      .def_property_readonly(
          "sample_count", [](const Checked& self) { return self.report.sample_count; }, "Samples.")
      .def("__bool__", [](const Checked& self) { return self.report.fault_count == 0; })
      .def("__str__", &text_of)
      .def("__repr__", [](const Checked& self) {
        return message("<CheckReport: ", self.report.placement_count, " shapes, ", self.report.fault_count, " faults>");
      });
  m.def("check_distribution", &check_result, py::arg("mesh"), py::arg("result"), py::kw_only(),
        py::arg("samples") = 1'000'000, py::arg("seed") = 0, py::arg("threads") = 0, py::arg("job") = py::none(),
        k_check_doc);
  let_travel<Checked>(m, "CheckReport");
}

}  // namespace saddleback::bindings
