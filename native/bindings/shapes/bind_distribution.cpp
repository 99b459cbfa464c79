// distribute and its result.

#include <algorithm>

#include "saddleback/distribution/distribution.h"
#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "convert/fields.h"
#include "convert/mapped_shapes.h"
#include "convert/points.h"
#include "convert/state.h"

namespace saddleback::bindings {
namespace {

constexpr const char* k_distribute_doc = R"(Lays many copies of shapes on a surface so that none collides with another.

Every copy is accepted only after the exact test of its outline, cut at the edges of the faces, against those already there.
Candidates come in a random order (or that of a sweep), and each that finds room stays, as if one after the other.

Args:
    graph: a SaddleVertexGraph or a Mesh.
    shapes: a Shape or a sequence of Shapes.
    counts: None: as many as find room; or one integer a shape (one for all where there is one shape, or with shares).
    field: DirectionField of the mesh: x axes of the shapes point along one of its directions, chosen at random among those
        that make a difference; or a sequence of them, one a shape. None: the smoothest field of lines.
    density: (V,) wanted number of copies per area, only ratios matter; needs counts or maximal. Or one such array a shape, as
        (n, V) or a sequence: each shape then follows its own.
    size: scale of the shapes, mesh units for one unit of their planes: a number, or (V,); or one a shape: (n,), (n, V) or a
        sequence of numbers and arrays. What is as long as there are vertices is one a vertex.
    seed: integer >= 0.
    mode: "random", or "packed": one beside the other in a front that sweeps over the surface, denser by a quarter and more;
        or a number from 0 (random) to 1 (packed).
    maximal: go on until nothing more fits, and prove it: `result.certificate`. Of a density only where it is positive, and none
        is centered where it is 0. It says which places, and of several classes which class (each by its density's share of
        its own mean there), are tried first; what lies there in the end is full, so for numbers per area use sizes (V,).
    shares: one number a shape, its share of the copies, only ratios matter; kept to a hundredth and one copy even where
        room runs out: where one class finds no more, the others stop as well. With a density those of the counts. None:
        counts alone, or whatever finds room.
    gap: least distance between copies, mesh units; half of it is kept to the border and to what is forbidden.
    size_range: (smallest, largest): every copy is scaled by another factor in this range.
    forbidden: (F,) booleans: faces that nothing may touch.
    around: Placements of these shapes that lie on the surface already: the others are laid around them. They come first in
        the result, as they are, and count as copies of their shapes, whatever the counts say. The others keep the gap to
        them, or half of it where they lie nearer to the border than that; of themselves only that none meets another is
        asked.
    mirror: half of the copies are mirrored, at random.
    bend: copies bend along the field's curves, as `map_shapes` lays them when given the field: for long shapes. Needs a
        field.
    tolerance: clearance of the proof, as a share of the circumradius, and half of the gap, of the smallest copy of a kind
        that might lie there.
    threads: 0: all cores. The result is the same for any number.
    job: progress and cancellation.

Returns:
    Distribution.

Raises:
    InputError: naming the argument: no shape; counts of another number than shapes, or negative; shares of another number,
        negative, all zero, with maximal, or beside counts of each shape; a field of another mesh; bend without a field;
        sizes or density of the wrong length, not finite or not positive; fields, sizes or densities of another number
        than shapes; copies around which to lay that meet each other or do not fit where they are; density zero everywhere,
        or without counts or maximal; a copy larger than the surface, alone or with half of the gap around; everything forbidden.
    Cancelled: the job was.

Notes:
    Distances are within the surface: sheets that lie close to each other know nothing of each other. After
    [blelloch2012], and [ebeida2011] for outlines instead of disks.
)";

/// The result, and what it was made of.
struct Distribution {
  py::object mesh, field;  ///< the field None unless they bend along it
  std::vector<Shape> shapes;
  DistributionResult result;
  py::object mapped;  ///< MappedShapes, once they have been asked for
};

const Mesh& mesh_of(const py::object& graph, py::object& mesh_object) {
  if (py::isinstance<SaddleVertexGraph>(graph)) {
    const Mesh& mesh = py::cast<const SaddleVertexGraph&>(graph).mesh();
    mesh_object = py::cast(mesh, py::return_value_policy::reference);  // the object that the graph keeps alive
    return mesh;
  }
  mesh_object = graph;
  return as_mesh(graph, "graph");
}

/// Tells whether it is a list or an array, of one dimension at least.
bool is_list(const py::handle value) {
  return py::hasattr(value, "__len__") && !py::isinstance<py::str>(value) &&
         !(py::isinstance<py::array>(value) && py::reinterpret_borrow<py::array>(value).ndim() == 0);
}

std::vector<double> as_sizes(const py::object& value, const char* name) {
  if (!is_list(value)) return {as_real(value, name)};
  const ArrayIn<double> array = as_reals(value, name);
  return {array.values.begin(), array.values.end()};
}

std::vector<Index> as_counts(const py::object& value) {
  if (value.is_none()) return {};
  if (!is_list(value)) return {as_integer(value, "counts")};
  const ArrayIn<Index> array = as_indices(value, "counts");
  if (array.count == 0) throw InputError("counts has 0 values, wanted one a shape");
  return {array.values.begin(), array.values.end()};
}

double as_packing(const py::object& mode) {
  if (!py::isinstance<py::str>(mode)) {
    const double packing = as_real(mode, "mode");
    if (!(packing >= 0 && packing <= 1))
      throw InputError(message("mode is ", packing, ", but must be \"random\", \"packed\" or 0 to 1"));
    return packing;
  }
  const auto name = py::cast<std::string>(mode);
  if (name == "random") return 0;
  if (name == "packed") return 1;
  throw InputError(message("mode: wanted \"random\", \"packed\" or a number from 0 to 1, got \"", name, "\""));
}

/// A list for all shapes, or one a shape. Numbers, as many as shapes, are one a shape, unless they are one a vertex.
std::vector<std::vector<double>> as_lists(const py::object& value, const char* name, std::size_t shapes,
                                          Index vertices) {
  if (!is_list(value)) return {as_sizes(value, name)};
  std::vector<py::object> items;
  const bool is_array = py::hasattr(value, "__array__");  // of others, whose iteration need not go over rows
  for (const py::handle item : is_array ? as_array(value, name, "real numbers") : value)
    items.push_back(py::reinterpret_borrow<py::object>(item));
  std::vector<std::vector<double>> result;
  if (std::any_of(items.begin(), items.end(), is_list)) {
    for (const py::object& item : items) result.push_back(as_sizes(item, name));
    return result;
  }
  const std::vector<double> values = as_sizes(value, name);
  if (shapes < 2 || values.size() != shapes || shapes == static_cast<std::size_t>(vertices)) return {values};
  for (const double own : values) result.push_back({own});
  return result;
}

std::unique_ptr<Distribution> lay(const py::object& graph, const py::object& shapes, const py::object& counts,
                                  const py::object& field, const py::object& density, const py::object& size,
                                  const py::object& seed, const py::object& mode, bool maximal,
                                  const py::object& shares, const py::object& gap, const py::object& size_range,
                                  const py::object& forbidden, const py::object& around, bool mirror, bool bend,
                                  const py::object& tolerance, const py::object& threads, const py::object& job) {
  auto made = std::make_unique<Distribution>();
  const Mesh& mesh = mesh_of(graph, made->mesh);
  made->shapes = as_shapes(shapes, "shapes");
  DistributionOptions options;
  options.counts = as_counts(counts);
  if (!shares.is_none()) options.shares = as_sizes(shares, "shares");
  if (!shares.is_none() && options.shares.empty()) throw InputError("shares has 0 values, wanted one a shape");
  const py::object fields = kept_fields(field);
  options.fields = as_fields(fields);
  const std::size_t shape_count = made->shapes.size();
  if (!density.is_none()) options.density = as_lists(density, "density", shape_count, mesh.vertex_count());
  options.size = as_lists(size, "size", shape_count, mesh.vertex_count());
  if (!around.is_none()) options.around = as_placements(around, "around");
  options.seed = as_seed(seed, "seed");
  options.packing = as_packing(mode);
  options.maximal = maximal;
  options.gap = as_real(gap, "gap");
  const ArrayIn<double> range = as_reals(size_range, "size_range", 2);
  options.smallest = range.values[0];
  options.largest = range.values[1];
  if (!forbidden.is_none()) options.forbidden = as_flags(forbidden, "forbidden");
  options.mirror = mirror;
  options.bend = bend;
  made->field = bend ? fields : py::none();
  options.tolerance = as_real(tolerance, "tolerance");
  options.threads = as_integer(threads, "threads");
  const JobIn token(job);
  made->result = without_gil([&] { return distribute(mesh, made->shapes, options, token); });
  return made;
}

py::list shapes_of(const Distribution& self) {
  py::list shapes;
  for (const Shape& shape : self.shapes) shapes.append(shape);
  return shapes;
}

/// Returns the mapped shapes, made when first asked for: the outlines that were tested take much more memory than the
/// placements.
py::tuple save_distribution(const py::object& self) {
  const auto& laid = py::cast<const Distribution&>(self);
  return py::make_tuple(laid.mesh, laid.field, shapes_of(laid), state_of(laid.result));
}

std::unique_ptr<Distribution> load_distribution(const py::tuple& state) {
  const py::tuple parts = as_state(state, 4);
  as_mesh(parts[0], "state");
  auto laid = std::make_unique<Distribution>();
  laid->mesh = parts[0];
  laid->field = parts[1];
  laid->shapes = as_shapes(parts[2], "state");
  restore(parts[3], laid->result);
  return laid;
}

py::object mapped_of(Distribution& self) {
  if (!self.mapped)
    self.mapped = py::cast(make_mapped(self.mesh, shapes_of(self), py::cast(Placements(self.result.placements)),
                                       self.field, py::make_tuple(0.5, 2.0), py::int_(0), py::none()));
  return self.mapped;
}

py::object outline_of(Distribution& self, const py::object& index) {
  return mapped_of(self).attr("outline")(as_integer(index, "index"));
}

py::object conform_to(Distribution& self, const py::object& vertices, const py::object& index) {
  return mapped_of(self).attr("conform")(vertices, as_integer(index, "index")).attr("points");
}

const char* name_of(DistributionStop stop) {
  switch (stop) {
    case DistributionStop::counts:
      return "counts";
    case DistributionStop::full:
      return "full";
    case DistributionStop::unproven:
      return "unproven";
    case DistributionStop::tired:
      break;
  }
  return "tired";
}

py::dict rejections_of(const Distribution& self) {
  constexpr const char* k_names[k_rejection_count] = {"collision", "boundary", "forbidden", "fold", "stretched"};
  py::dict result;
  for (std::size_t i = 0; i < k_rejection_count; ++i) result[k_names[i]] = self.result.rejections[i];
  return result;
}

void bind_certificate(py::module_& m) {
  py::class_<Certificate>(
      m, "Certificate", py::module_local(),
      "A proof that nothing more fits: whatever is laid anywhere comes nearer to a copy than `tolerance`.")
      .def_readonly("tolerance", &Certificate::tolerance,
                    "Mesh units: of the largest shape where sizes are largest; elsewhere it is less.")
      .def_readonly("cells", &Certificate::cells, "Tests of a cell of the surface.")
      .def_readonly("leaves", &Certificate::leaves,
                    "Cells over which a copy can move by the tolerance at most, and at whose center none fits.")
      .def_readonly(
          "uncertified_area", &Certificate::uncertified_area,
          "Area of the cells that it cannot decide: around singularities, and where the surface bends too much.")
      .def_readonly("uncertified", &Certificate::uncertified, "SurfacePoints: the centers of those cells.")
      .def("__repr__", [](const Certificate& self) {
        return message("<Certificate: tolerance ", self.tolerance, ", ", self.cells, " cells, ", self.leaves,
                       " leaves, uncertified area ", self.uncertified_area, ">");
      });
}

}  // namespace

void bind_distribution(py::module_& m) {
  bind_certificate(m);
  py::class_<Distribution>(m, "Distribution", py::module_local(), "Copies of shapes on a surface; see `distribute`.")
      .def_readonly("mesh", &Distribution::mesh, "The mesh.")
      .def_readonly("field", &Distribution::field,
                    "The DirectionField that copies bend along, a tuple of one a shape, or None.")
      .def_property_readonly("shapes", &shapes_of, "List of the Shapes.")
      .def_property_readonly(
          "placements", [](const Distribution& self) { return Placements(self.result.placements); },
          "Placements, in the order in which they were laid.")
      .def_property_readonly(
          "stop_reason", [](const Distribution& self) { return name_of(self.result.stop); },
          "\"counts\": every count is met; \"full\": nothing more fits, as the certificate proves; \"unproven\": no "
          "room was "
          "found, but of more than half of the surface no certificate can tell, as shapes or gaps are too large for "
          "how "
          "it bends (`certificate.uncertified_area`); \"tired\": no room was found in a while.")
      .def_property_readonly("rejections", &rejections_of,
                             "{cause: number} of candidates that were not laid: collision, boundary, forbidden, fold, "
                             "stretched.")
      .def_property_readonly(
          "certificate",
          [](const Distribution& self) -> py::object {
            return self.result.certificate.tolerance > 0 ? py::cast(self.result.certificate) : py::none();
          },
          "Certificate; None unless asked for.")
      .def_property_readonly("mapped", &mapped_of,
                             "MappedShapes of all copies: patches, cut faces, attributes, bent objects, frames. Kept.")
      .def(
          "outline", &outline_of, py::arg("index"),
          "List of (n, 3) float64: the closed outlines of a copy on the surface, loop by loop. InputError for an index "
          "out of range.")
      .def("conform", &conform_to, py::arg("vertices"), py::arg("index"),
           "(n, 3) float64: an object, (n, 3) or (n, 2) in the shape's units, bent onto the surface as a copy is; see "
           "`MappedShapes.conform`.")
      .def("__len__", [](const Distribution& self) { return self.result.placements.size(); })
      .def("__repr__", [](const Distribution& self) {
        return message("<Distribution: ", self.result.placements.size(), " copies of ", self.shapes.size(),
                       self.shapes.size() == 1 ? " shape, " : " shapes, ", name_of(self.result.stop), ">");
      });
  m.def("distribute", &lay, py::arg("graph"), py::arg("shapes"), py::arg("counts") = py::none(),
        py::arg("field") = py::none(), py::arg("density") = py::none(), py::arg("size") = 1.0, py::arg("seed") = 0,
        py::arg("mode") = "random", py::arg("maximal") = false, py::kw_only(), py::arg("shares") = py::none(),
        py::arg("gap") = 0.0, py::arg("size_range") = py::make_tuple(1.0, 1.0), py::arg("forbidden") = py::none(),
        py::arg("around") = py::none(), py::arg("mirror") = false, py::arg("bend") = false, py::arg("tolerance") = 0.01,
        py::arg("threads") = 0, py::arg("job") = py::none(), k_distribute_doc);
  let_travel<Distribution>(m, "Distribution", &save_distribution, &load_distribution);
}

}  // namespace saddleback::bindings
