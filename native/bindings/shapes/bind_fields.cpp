// Direction fields, curves along them, values spread over a surface.

#include <cmath>
#include <mutex>

#include "saddleback/field/curvature.h"
#include "saddleback/field/direction_field.h"
#include "saddleback/field/spread_values.h"
#include "saddleback/field/streamline.h"
#include "saddleback/mesh/trace.h"

#include "convert/points.h"
#include "convert/state.h"

namespace saddleback::bindings {
namespace {

constexpr const char* k_field_doc =
    R"(One direction a face, of which `symmetry` equal ones make a vector (1), a line (2) or a cross (4). Immutable.
)";

constexpr const char* k_stroke_doc = R"(A curve that a field shall follow.

Args:
    curve: a SurfaceCurve.
    hard: met exactly in every face that the curve crosses; otherwise as a spring of `weight` would.
    weight: positive; 1 meets strokes that do not cross to about a degree.

Raises:
    InputError: anything but a SurfaceCurve.
)";

constexpr const char* k_direction_doc = R"(Directions all over a surface, smooth, with singularities where one wants.

With `singularities`: the field that turns least of those that have exactly these (trivial connections [crane2010]).
Strokes, directions and alignment turn it by one angle a face, which cannot change any index. Without: the smoothest
field, or the one nearest to strokes, directions and alignment, with the singularities that it then has [knoppel2013].

Args:
    mesh: the mesh, kept alive by the field.
    symmetry: 1 for vectors, 2 for lines, 4 for crosses.
    singularities: None, or {vertex: index} with indices in multiples of 1/symmetry: how often the field turns
        counter-clockwise along a small loop about the vertex. In each component they must sum to its Euler
        characteristic, boundary loops counted with theirs.
    strokes: curves to follow, each a Stroke, SurfaceCurve, GeodesicPath, SurfacePoints or vertices; all but Strokes are
        soft, of weight 1. For symmetry 1 the field runs as the curve does.
    align: "none"; "curvature": lines along the least bent direction, crosses along both principal ones; "boundary":
        along every boundary loop, exactly so in faces with one boundary edge.
    loop_indices: {boundary loop: index}, how often the field turns against the boundary along it: 0 to follow it. Loops
        that are not named (and not aligned) take what turns least. Only together with `singularities`.
    align_weight: how much curvature counts against smoothness.
    directions: (F, 3) or (V, 3) vectors that the field shall have in faces or vertices (as many as both: in faces), zero
        where nothing is given; their part along the surface counts, their length does not.
    weights: (F,) or (V,) as `directions`, 0 or more: 1, as without them, meets smooth directions to about a degree.
    job: progress and cancellation.

Raises:
    InputError: a vertex out of range or on the boundary; an index that the symmetry lacks; indices of a component of
        another sum, telling what is missing; a stroke of another mesh; hard strokes that disagree in a face; curvature
        for symmetry 1; directions of another number, not finite, or at right angles to the surface; weights of
        another number, below 0, or without directions.
    Cancelled: the job was.

Notes:
    About O(F): a multigrid solve over vertices for singularities, one for each handle twice, one over faces for strokes.
)";

constexpr const char* k_of_vectors_doc = R"(The field that has given directions: combed hair, a painted flow.

Args:
    mesh: the mesh, kept alive by the field.
    vectors: (F, 3) reals, one for each face; their part within the face counts, their length does not.
    symmetry: 1, 2 or 4: how many directions at equal angles count as the same.

Returns:
    DirectionField: from face to face it turns the nearer way, by at most pi / symmetry.

Raises:
    InputError: another shape or symmetry, a vector that is not finite or has no direction within its face.

Notes:
    O(F).
)";

constexpr const char* k_editor_doc = R"(Makes fields of one mesh one after another.

Factors, loops around handles and harmonic forms are made once; singularities that stay are not solved for again; strokes
begin from the last answer, so that two ways to the same strokes differ by rounding: about 1e-7 radians, 3e-5 at the
most that was seen.

Args:
    mesh: the mesh, kept alive.
    symmetry: 1, 2 or 4.
)";

constexpr const char* k_streamline_doc = R"(Follows a direction field: the center line of a long shape, a hair, a seam.

The field is integrated as it is inside faces, not only from edge to edge: fourth-order steps of at most a quarter of a
face, shorter where the field turns far within one.

Args:
    mesh: the field's mesh.
    field: a DirectionField.
    start: one surface point, or a vertex index.
    length: mesh units, > 0.
    both: half of the length on either side of the start, instead of all of it ahead.
    heading: (3,) vector; of the field's directions at the start the nearest one is followed. None: the first one.
    max_curvature: the most by which the curve bends, radians per mesh unit. Where the field turns faster the curve lags
        behind, so that shapes that reach up to 1 / max_curvature to either side do not fold.
    job: a Job to watch or cancel; its fraction is that of the length.

Returns:
    Streamline: a GeodesicPath that knows why it ends. It has one point where the start is a singular vertex, or lies on
    the boundary where the field leaves the surface.

Raises:
    InputError: a field of another mesh, a point off the mesh, a length or curvature that is not positive, a curve over
        more than a million faces or eight million steps.
    Cancelled: the job was.
)";

constexpr const char* k_spread_doc =
    R"(Values for every vertex from a few places where they are known, as a painted density.

They never leave the range of the given ones and meet those: at vertices to 1e-5 of the range; at points within faces
biharmonic ones to about 2 % of it, where corners of the face had to be kept within the range. Components without a
place have the mean of all values.

Args:
    mesh: a mesh.
    places: (n,) vertices or a SurfacePoints.
    values: (n,) reals.
    method: "biharmonic", smooth through the places (two linear systems a place: for up to a few dozens); "harmonic", with
        cusps at the places and flat between them (one system for any number; in a face, its corners have the value).
    job: progress and cancellation.

Returns:
    (V,) float64.

Raises:
    InputError: no place, one off the mesh, another number of values than places, a value that is not finite.
    Cancelled: the job was.

Notes:
    After [botsch2004], with one constraint a place.
)";

constexpr const char* k_curvature_doc = R"(Finds how the surface bends at each vertex.

From the change of vertex normals over each face, averaged about vertices [rusinkiewicz2004]. O(F).

Returns:
    smallest, largest (V,) float64: principal curvatures, 1 / mesh units, positive where the surface bends away from its
    normal as a sphere does; direction (V, 3) float64: of the largest one, a unit vector up to its sign.
)";

constexpr double k_most_units = 1e6;

/// {int: index} to (key, units) pairs; None gives none.
std::vector<std::pair<Index, Index>> as_units(const py::object& value, int symmetry, const char* argument,
                                              const char* key_name) {
  std::vector<std::pair<Index, Index>> result;
  if (value.is_none()) return result;
  if (!py::isinstance<py::dict>(value))
    throw InputError(message(argument, ": wanted a dict of ", key_name, " and index, got a ",
                             py::cast<std::string>(py::type::of(value).attr("__name__"))));
  for (const auto& [key, index] : py::cast<py::dict>(value)) {
    const Index which = as_integer(py::reinterpret_borrow<py::object>(key), argument);
    const double wanted = as_real(py::reinterpret_borrow<py::object>(index), argument), units = wanted * symmetry;
    if (!(std::abs(units) <= k_most_units))
      throw InputError(message(argument, ": ", key_name, " ", which, " has index ", wanted,
                               ", which is not finite or beyond reason"));
    if (std::abs(units - std::round(units)) > 1e-9)
      throw InputError(message(argument, ": ", key_name, " ", which, " has index ", wanted, ", which is not a ",
                               symmetry == 1 ? "whole number" : message("multiple of 1/", symmetry), " (symmetry ",
                               symmetry, ")"));
    result.emplace_back(which, static_cast<Index>(std::lround(units)));
  }
  return result;
}

Stroke as_stroke(const py::handle& value, const Mesh& mesh, const std::string& argument) {
  if (py::isinstance<Stroke>(value)) return py::cast<const Stroke&>(value);
  if (py::isinstance<SurfaceCurve>(value)) return {py::cast<const SurfaceCurve&>(value)};
  SurfacePoints points = py::isinstance<GeodesicPath>(value)
                             ? py::cast<const GeodesicPath&>(value).surface
                             : as_surface_points(py::reinterpret_borrow<py::object>(value), mesh, argument.c_str());
  return {SurfaceCurve(mesh, std::move(points), false, argument.c_str())};
}

std::vector<Stroke> as_strokes(const py::object& value, const Mesh& mesh) {
  std::vector<Stroke> result;
  if (value.is_none()) return result;
  if (py::isinstance<Stroke>(value) || py::isinstance<SurfaceCurve>(value) || py::isinstance<GeodesicPath>(value) ||
      py::isinstance<SurfacePoints>(value) || !py::isinstance<py::iterable>(value))
    throw InputError("strokes: wanted a list of curves");
  for (const py::handle& item : py::cast<py::iterable>(value))
    result.push_back(as_stroke(item, mesh, message("strokes: stroke ", result.size())));
  return result;
}

FieldAlignment as_alignment(const py::object& value) {
  const std::string name = py::isinstance<py::str>(value) ? py::cast<std::string>(value) : "";
  if (name == "none") return FieldAlignment::none;
  if (name == "curvature") return FieldAlignment::curvature;
  if (name == "boundary") return FieldAlignment::boundary;
  throw InputError(
      message("align: wanted \"none\", \"curvature\" or \"boundary\", got ", py::cast<std::string>(py::repr(value))));
}

std::vector<Vec3> as_vectors(const py::object& value, const char* argument) {
  const ArrayIn<double> rows = as_points3(value, argument);
  std::vector<Vec3> result(rows.values.size() / 3);
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = {rows.values[3 * i], rows.values[3 * i + 1], rows.values[3 * i + 2]};
  return result;
}

std::optional<GivenDirections> as_given(const py::object& directions, const py::object& weights) {
  if (!weights.is_none() && directions.is_none()) throw InputError("weights: only together with directions");
  if (directions.is_none()) return std::nullopt;
  GivenDirections result{as_vectors(directions, "directions"), {}};
  if (weights.is_none()) return result;
  const ArrayIn<double> own = as_reals(weights, "weights");
  result.weights.assign(own.values.begin(), own.values.end());
  return result;
}

DirectionFieldOptions as_options(const Mesh& mesh, int symmetry, const py::object& singularities,
                                 const py::object& strokes, const py::object& align, const py::object& loop_indices,
                                 const py::object& align_weight, const py::object& directions,
                                 const py::object& weights) {
  DirectionFieldOptions options;
  if (!singularities.is_none()) {
    options.singularities.emplace();
    for (const auto& [vertex, units] : as_units(singularities, symmetry, "singularities", "vertex"))
      options.singularities->push_back({vertex, units});
  }
  const auto loop_count = static_cast<Index>(mesh.boundary_loops().size());
  for (const auto& [loop, units] : as_units(loop_indices, symmetry, "loop_indices", "boundary loop")) {
    if (loop < 0 || loop >= loop_count)
      throw InputError(message("loop_indices: boundary loop ", loop, " is out of range, the mesh has ", loop_count));
    options.loop_units.resize(loop_count);
    options.loop_units[loop] = units;
  }
  options.strokes = as_strokes(strokes, mesh);
  options.align = as_alignment(align);
  options.align_weight = as_real(align_weight, "align_weight");
  options.directions = as_given(directions, weights);
  return options;
}

/// The editor, the mesh's Python object, and what keeps two threads from using it at once.
struct Editor {
  Editor(const py::object& mesh_object, int its_symmetry)
      : mesh(mesh_object), symmetry(its_symmetry), editor(as_mesh(mesh_object, "mesh"), its_symmetry) {}
  py::object mesh;
  int symmetry;
  std::mutex mutex;
  DirectionFieldEditor editor;
};

py::object edit(Editor& self, const py::object& singularities, const py::object& strokes, const py::object& align,
                const py::object& loop_indices, const py::object& align_weight, const py::object& directions,
                const py::object& weights, const py::object& job) {
  const DirectionFieldOptions options = as_options(as_mesh(self.mesh, "mesh"), self.symmetry, singularities, strokes,
                                                   align, loop_indices, align_weight, directions, weights);
  const JobIn token(job);
  return keeping(self.mesh, without_gil([&] {
                   const std::lock_guard lock(self.mutex);
                   return self.editor.field(options, token);
                 }));
}

py::object field_of(const py::object& mesh, const py::object& symmetry, const py::object& singularities,
                    const py::object& strokes, const py::object& align, const py::object& loop_indices,
                    const py::object& align_weight, const py::object& directions, const py::object& weights,
                    const py::object& job) {
  Editor editor(mesh, as_integer(symmetry, "symmetry"));
  return edit(editor, singularities, strokes, align, loop_indices, align_weight, directions, weights, job);
}

py::object field_from_vectors(const py::object& mesh_object, const py::object& vectors, const py::object& symmetry) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const std::vector<Vec3> directions = as_vectors(vectors, "vectors");
  const int wanted = as_integer(symmetry, "symmetry");
  const JobIn job{py::none()};
  return keeping(mesh_object, without_gil([&] { return field_of_vectors(mesh, wanted, directions, job); }));
}

constexpr const char* k_of_turns_doc =
    R"(The field that has these angles and turns, as `angles` and `turns` of another gave them.

Args:
    mesh: the Mesh that they were given for.
    angles: (F,) radians in the chart of each face.
    turns: (F, 3) radians, by how much the field turns across each edge, opposite for its two faces, 0 on the boundary.
    symmetry: 1: vectors, 2: lines, 4: crosses.

Returns:
    DirectionField, the same to the bit.

Raises:
    InputError: arrays of another length, not finite or beyond a thousand radians; turns that differ between the two
        faces of an edge or do not lead from the one's direction to the other's; a symmetry other than 1, 2 and 4.
)";

py::object field_from_turns(const py::object& mesh_object, const py::object& angles, const py::object& turns,
                            const py::object& symmetry) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const int wanted = as_integer(symmetry, "symmetry");
  const ArrayIn<double> own = as_reals(angles, "angles", mesh.face_count());
  const ArrayIn<double> rows = as_points3(turns, "turns");
  const JobIn job{py::none()};
  return keeping(mesh_object, without_gil([&] { return field_of_turns(mesh, wanted, own.values, rows.values, job); }));
}

py::object turned(const py::object& self, const py::object& angle) {
  const auto& field = py::cast<const DirectionField&>(self);
  return keeping(self, field.turned(as_real(angle, "angle")));
}

py::dict singularities_of(const DirectionField& field) {
  py::dict result;
  for (const Singularity& s : field.singularities())
    result[py::int_(s.vertex)] = static_cast<double>(s.units) / field.symmetry();
  return result;
}

py::array directions_at(const DirectionField& field, const py::object& points) {
  const SurfacePoints places = as_surface_points(points, field.mesh(), "points");
  return to_array(without_gil([&] {
    std::vector<Vec3> result;
    result.reserve(places.size());
    for (const SurfacePoint& place : places)
      result.push_back(direction_in_space(field.mesh(), place.face, field.angle_at(place)));
    return result;
  }));
}

py::tuple save_field(const py::object& self) {
  const auto& field = py::cast<const DirectionField&>(self);
  const py::object mesh = py::cast(field.mesh(), py::return_value_policy::reference);  // the object that it keeps alive
  return py::make_tuple(mesh, field.symmetry(), self.attr("angles"), self.attr("turns"));
}

py::object load_field(const py::tuple& state) {
  const py::tuple parts = as_state(state, 4);
  const py::object owner = parts[0];
  const Mesh& mesh = as_mesh(owner, "state");
  int symmetry = 1;
  std::vector<double> angles;
  std::vector<Vec3> turns;
  restore(parts[1], symmetry);
  restore(parts[2], angles);
  restore(parts[3], turns);
  std::vector<double> flat;
  for (const Vec3& row : turns) flat.insert(flat.end(), row.begin(), row.end());
  return keeping(parts[0], DirectionField(mesh, symmetry, std::move(angles), std::move(flat)));
}

void bind_direction_field(py::module_& m) {
  py::class_<DirectionField>(m, "DirectionField", py::module_local(), k_field_doc)
      .def_static("from_vectors", &field_from_vectors, py::arg("mesh"), py::arg("vectors"), py::arg("symmetry") = 1,
                  k_of_vectors_doc)
      .def_static("from_turns", &field_from_turns, py::arg("mesh"), py::arg("angles"), py::arg("turns"),
                  py::arg("symmetry") = 1, k_of_turns_doc)
      .def_property_readonly("symmetry", &DirectionField::symmetry, "1: vectors, 2: lines, 4: crosses.")
      .def_property_readonly(
          "vectors", [](const DirectionField& field) { return to_array(field.vectors()); },
          "(F, 3) float64: one of the directions at the center of each face, unit vectors.")
      .def_property_readonly(
          "angles",
          [](const py::object& self) { return view_of(py::cast<const DirectionField&>(self).angles(), self); },
          "(F,) float64: the same directions as angles, radians, in the chart of the face (corner 0 to corner 1 is 0).")
      .def_property_readonly(
          "turns",
          [](const py::object& self) {
            return view_of(py::cast<const DirectionField&>(self).turns(), self).attr("reshape")(-1, 3);
          },
          "(F, 3) float64: by how much the field turns where it crosses edge i (corner i to i + 1) of the face "
          "outwards, "
          "radians, besides the transport that keeps directions straight; 0 on the boundary.")
      .def_property_readonly("singularities", &singularities_of,
                             "{vertex: index} of the interior vertices whose index is not 0.")
      .def_property_readonly(
          "loop_indices",
          [](const DirectionField& field) {
            std::vector<double> result;
            for (const Index units : field.loop_units())
              result.push_back(static_cast<double>(units) / field.symmetry());
            return to_array(std::move(result));
          },
          "(boundary loops,) float64: how often the field turns against the boundary along each loop.")
      .def_property_readonly("largest_turn", &DirectionField::largest_turn,
                             "The largest of `turns`, radians. Below pi / symmetry the vectors alone tell the "
                             "singularities; beyond, faces are too large for how fast the field has to turn.")
      .def_property_readonly(
          "sharp_edges",
          [](const DirectionField& field) {
            std::vector<Index> result;
            for (const Index h : field.sharp_edges())
              result.insert(result.end(), {Mesh::face_of(h), Mesh::face_of(field.mesh().twin(h))});
            return to_array(std::move(result)).attr("reshape")(-1, 2);
          },
          "(n, 2) int32: pairs of neighboring faces between which the field turns by pi / symmetry or more, where the "
          "vectors alone do not tell the singularities. With given singularities only what no other choice of turns "
          "around handles was found to avoid: faces there are too large. O(F).")
      .def("directions", &directions_at, py::arg("points"),
           "(n, 3) float64: the field at vertices or SurfacePoints, unit vectors in the planes of the points' faces; "
           "continuous but at vertices, about which it turns evenly (there a mean is given).")
      .def("turned", &turned, py::arg("angle"),
           "Returns the field turned everywhere by an angle, radians counter-clockwise. Raises InputError for one that "
           "is "
           "not finite.")
      .def("__repr__", [](const DirectionField& field) {
        return message("<DirectionField: symmetry ", field.symmetry(), ", ", field.angles().size(), " faces, ",
                       field.singularities().size(), " singularities>");
      });
}

py::tuple save_stroke(const py::object& self) {
  const auto& stroke = py::cast<const Stroke&>(self);
  const py::object mesh = py::cast(stroke.curve.mesh(), py::return_value_policy::reference);
  return py::make_tuple(mesh, stroke.curve.points(), stroke.curve.closed(), stroke.is_hard, stroke.weight);
}

py::object load_stroke(const py::tuple& state) {
  const py::tuple parts = as_state(state, 5);
  const auto [points, closed] = std::pair(py::cast<SurfacePoints>(parts[1]), py::cast<bool>(parts[2]));
  const SurfaceCurve curve(as_mesh(parts[0], "state"), points, closed);
  return keeping(parts[0], Stroke{curve, py::cast<bool>(parts[3]), py::cast<double>(parts[4])});
}

void bind_strokes(py::module_& m) {
  py::class_<Stroke>(m, "Stroke", py::module_local(), k_stroke_doc)
      .def(py::init([](const py::object& curve, bool hard, const py::object& weight) {
             if (!py::isinstance<SurfaceCurve>(curve)) throw InputError("curve: wanted a SurfaceCurve");
             return Stroke{py::cast<const SurfaceCurve&>(curve), hard, as_real(weight, "weight")};
           }),
           py::arg("curve"), py::arg("hard") = false, py::arg("weight") = 1.0, py::keep_alive<1, 2>())
      .def_readonly("hard", &Stroke::is_hard, "True if it is met exactly.")
      .def_readonly("weight", &Stroke::weight, "Weight of a soft stroke.");
}

/// A curve that knows why it ends.
struct StreamlinePath : GeodesicPath {
  std::size_t start = 0;
  StreamlineEnd begin_reason{}, end_reason{};
};

auto fields_of(StreamlinePath& of) {
  return std::tie(of.points, of.surface, of.length, of.start, of.begin_reason, of.end_reason);
}

const char* name_of(StreamlineEnd reason) {
  if (reason == StreamlineEnd::length) return "length";
  return reason == StreamlineEnd::boundary ? "boundary" : "singularity";
}

StreamlinePath follow(const py::object& mesh_object, const py::object& field_object, const py::object& start,
                      const py::object& length, bool both, const py::object& heading, const py::object& max_curvature,
                      const py::object& job) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  if (!py::isinstance<DirectionField>(field_object)) throw InputError("field: wanted a DirectionField");
  const auto& field = py::cast<const DirectionField&>(field_object);
  if (&field.mesh() != &mesh) throw InputError("field: it belongs to another mesh");
  const SurfacePoint point = as_surface_point(start, mesh, "start");
  StreamlineOptions options;
  options.length = as_real(length, "length");
  options.both = both;
  if (!heading.is_none()) options.heading = as_vec3(heading, "heading");
  options.max_curvature = as_real(max_curvature, "max_curvature");
  const JobIn token(job);
  options.job = token;
  return without_gil([&] {
    Streamline line = streamline(field, point, options);
    return StreamlinePath{std::move(line.path), line.start, line.begin_reason, line.end_reason};
  });
}

void bind_streamline(py::module_& m) {
  py::class_<StreamlinePath, GeodesicPath>(m, "Streamline", py::module_local(),
                                           "A curve along a direction field and why it ends.")
      .def_readonly("start", &StreamlinePath::start, "Index of the point that it was started from.")
      .def_property_readonly(
          "begin_reason", [](const StreamlinePath& line) { return name_of(line.begin_reason); },
          "The reason why it goes no farther back: \"length\", \"boundary\" or \"singularity\".")
      .def_property_readonly(
          "end_reason", [](const StreamlinePath& line) { return name_of(line.end_reason); },
          "The reason why it goes no farther ahead.");
  m.def("streamline", &follow, py::arg("mesh"), py::arg("field"), py::arg("start"), py::arg("length"),
        py::arg("both") = false, py::kw_only(), py::arg("heading") = py::none(),
        py::arg("max_curvature") = std::numeric_limits<double>::infinity(), py::arg("job") = py::none(),
        k_streamline_doc);
}

py::array spread(const py::object& mesh_object, const py::object& places, const py::object& values,
                 const py::object& method, const py::object& job) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const SurfacePoints points = as_surface_points(places, mesh, "places");
  const ArrayIn<double> known = as_reals(values, "values");
  const std::string name = py::isinstance<py::str>(method) ? py::cast<std::string>(method) : "";
  if (name != "harmonic" && name != "biharmonic")
    throw InputError(
        message("method: wanted \"biharmonic\" or \"harmonic\", got ", py::cast<std::string>(py::repr(method))));
  const JobIn token(job);
  const SpreadOptions options{name == "harmonic" ? SpreadMethod::harmonic : SpreadMethod::biharmonic, token};
  return to_array(without_gil([&] { return spread_values(mesh, points, known.values, options); }));
}

py::tuple curvatures_of(const py::object& mesh_object) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const JobIn job{py::none()};
  PrincipalCurvatures found = without_gil([&] { return principal_curvatures(mesh, job); });
  return py::make_tuple(to_array(std::move(found.smallest)), to_array(std::move(found.largest)),
                        to_array(std::move(found.direction)));
}

}  // namespace

/// Runs after bind_surface and bind_paths, whose classes it takes.
void bind_fields(py::module_& m) {
  bind_direction_field(m);
  bind_strokes(m);
  bind_streamline(m);
  m.def("spread_values", &spread, py::arg("mesh"), py::arg("places"), py::arg("values"),
        py::arg("method") = "biharmonic", py::kw_only(), py::arg("job") = py::none(), k_spread_doc);
  m.def("principal_curvatures", &curvatures_of, py::arg("mesh"), k_curvature_doc);
  py::class_<Editor>(m, "DirectionFieldEditor", py::module_local(), k_editor_doc)
      .def(py::init([](const py::object& mesh, const py::object& symmetry) {
             return std::make_unique<Editor>(mesh, as_integer(symmetry, "symmetry"));
           }),
           py::arg("mesh"), py::arg("symmetry") = 1)
      .def("field", &edit, py::arg("singularities") = py::none(), py::arg("strokes") = py::tuple(),
           py::arg("align") = "none", py::kw_only(), py::arg("loop_indices") = py::none(),
           py::arg("align_weight") = 1.0, py::arg("directions") = py::none(), py::arg("weights") = py::none(),
           py::arg("job") = py::none(), "Finds a field as `direction_field` does.");
  m.def("direction_field", &field_of, py::arg("mesh"), py::arg("symmetry") = 1, py::arg("singularities") = py::none(),
        py::arg("strokes") = py::tuple(), py::arg("align") = "none", py::kw_only(),
        py::arg("loop_indices") = py::none(), py::arg("align_weight") = 1.0, py::arg("directions") = py::none(),
        py::arg("weights") = py::none(), py::arg("job") = py::none(), k_direction_doc);
  let_travel<DirectionField>(m, "DirectionField", &save_field, &load_field);
  let_travel<Stroke>(m, "Stroke", &save_stroke, &load_stroke);
  let_travel<StreamlinePath>(m, "Streamline");
}

}  // namespace saddleback::bindings
