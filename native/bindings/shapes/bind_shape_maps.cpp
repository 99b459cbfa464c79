// Shapes on the surface: what they cover, bent copies, cut faces, attributes.

#include <limits>

#include "saddleback/shape_mapping/bent_copies.h"
#include "saddleback/shape_mapping/cut_shapes.h"
#include "saddleback/shape_mapping/shape_attributes.h"

#include "convert/fields.h"
#include "convert/mapped_shapes.h"
#include "convert/points.h"
#include "convert/state.h"

namespace saddleback::bindings {
namespace {

constexpr const char* k_map_doc = R"(Lays shapes on the surface: by the exponential map, or bent along a field.

Each shape's plane is laid on the surface by a continuous map that is linear in every face. About a point it keeps
lengths and directions from the center; with a field it keeps arc length along the field's curve through the center and
distance from it, so that long shapes bend. Exact where the surface can be unrolled. A shape is laid only where its map
is injective, stays on the surface and stretches within limits, which is checked face by face, exactly.

Args:
    mesh: a mesh.
    shapes: a Shape or a sequence of them.
    placements: a Placements.
    field: None for the exponential map, or a DirectionField of the same mesh; or a sequence of them, one a shape.
    limits: (smallest, largest) factor by which lengths may change from the plane to the surface: the singular values.
    threads: 0 for all cores; never changes the result.
    job: progress and cancellation.

Returns:
    MappedShapes.

Raises:
    InputError: placements that do not fit mesh or shapes, a field of another mesh, limits in the wrong order.
    Cancelled: the job was.

Notes:
    O(n log n + c m) a shape, for n vertices about it, m within it and c corners. After [melvaer2012].
)";

constexpr const char* k_mapped_doc =
    "Shapes laid on a surface by `map_shapes`. Those that could not be laid have no part.";

constexpr const char* k_conform_doc = R"(An object bent onto the surface.

x and y go through the map of the shape, z along the smooth normal of the surface, all to the placement's scale. What
reaches over the outline is laid as far as the surface goes on unfolded. Faces of mirrored copies turn over.

Args:
    vertices: (n, 3), or (n, 2) with z = 0: in the shape's own units.
    i: which placement.

Raises:
    InputError: bad vertices, a shape that could not be laid.
    IndexError: i is out of range.
)";

constexpr const char* k_bend_doc =
    R"(Meshes bent onto the surface, one for each placement, divided until they lie on it.

As `conform` for all copies at once. Between the vertices of a mesh that is bent lie chords; where those leave the
surface (they cross an edge of it, or bridge a hollow) edges and triangles are divided, and neighbors agree.

Args:
    solids: for each shape (vertices (n, 3) or (n, 2) with z = 0 in the shape's own units, triangles (t, 3)), or None
        for a shape that has none.
    tolerance: how far edges and triangles may leave the surface that their vertices lie on or stand above, as a share
        of the copy's circumradius; 0 keeps the vertices as they are.
    threads, job: as in `map_shapes`.

Returns:
    BentCopies.

Raises:
    InputError: bad vertices or triangles, another number of solids than shapes, a tolerance that is negative or not
        finite.
    Cancelled: the job was.
)";

constexpr const char* k_attributes_doc = R"(Returns attributes of the mesh's vertices by the shapes near them.

Args:
    reach: distance from the outlines, mesh units, up to which vertices outside of shapes count, too.
    threads, job: as in `map_shapes`.

Returns:
    ShapeAttributes.

Raises:
    InputError: a reach that is negative or not finite.
    Cancelled: the job was.
)";

const char* name_of(MapFailure failure) {
  switch (failure) {
    case MapFailure::none:
      return "none";
    case MapFailure::boundary:
      return "boundary";
    case MapFailure::fold:
      return "fold";
    case MapFailure::stretched:
      return "stretched";
  }
  return "none";
}

MapLimits as_limits(const py::object& value) {
  if (!py::isinstance<py::sequence>(value) || py::len(value) != 2)
    throw InputError("limits: wanted (smallest, largest)");
  return {as_real(value[py::int_(0)], "limits"), as_real(value[py::int_(1)], "limits")};
}

}  // namespace

const Mesh& MappedShapes::mesh() const { return as_mesh(mesh_object, "mesh"); }

Index MappedShapes::checked(const py::object& index) const {
  const Index i = as_integer(index, "i"), count = static_cast<Index>(placements.size());
  if (i < -count || i >= count) throw py::index_error(message("copy ", i, " is out of range, there are ", count));
  return i < 0 ? i + count : i;
}

Index MappedShapes::laid(const py::object& index) const {
  const Index i = checked(index);
  if (mapped[i].failure != MapFailure::none)
    throw InputError(message("i: shape ", i, " could not be laid on the surface (", name_of(mapped[i].failure), ")"));
  return i;
}

namespace {

/// Returns what shapes laid on one mesh again and again share. They keep the mesh: no other has its address.
std::shared_ptr<SharedNormals> normals_for(const Mesh& mesh) {
  static std::mutex mutex;
  static std::weak_ptr<SharedNormals> last;
  const std::lock_guard lock(mutex);
  std::shared_ptr<SharedNormals> result = last.lock();
  if (!result || result->mesh != &mesh) {
    result = std::make_shared<SharedNormals>();
    result->mesh = &mesh;
    last = result;
  }
  return result;
}

}  // namespace

std::unique_ptr<MappedShapes> make_mapped(const py::object& mesh_object, const py::object& shapes,
                                          const py::object& placements, const py::object& field,
                                          const py::object& limits, const py::object& threads, const py::object& job) {
  auto result = std::make_unique<MappedShapes>();
  result->mesh_object = mesh_object;
  const Mesh& mesh = result->mesh();
  result->shared_normals = normals_for(mesh);
  result->field_object = kept_fields(field);
  result->shapes = as_shapes(shapes, "shapes");
  result->placements = as_placements(placements, mesh, result->shapes.size());
  result->limits = as_limits(limits);
  const JobIn token(job);
  const MapShapesOptions options{result->limits, result->fields(), as_integer(threads, "threads"), token};
  without_gil([&] { result->mapped = map_shapes(mesh, result->shapes, result->placements, options); });
  return result;
}

const std::vector<Vec3>& MappedShapes::normals(const Mesh& own) const {
  const std::lock_guard lock(shared_normals->mutex);
  if (shared_normals->found.empty()) shared_normals->found = vertex_normals(own);
  return shared_normals->found;
}

namespace {

py::object failures_of(const MappedShapes& self) {
  if (self.failures) return self.failures;
  py::dict result;
  for (std::size_t i = 0; i < self.mapped.size(); ++i)
    if (self.mapped[i].failure != MapFailure::none) result[py::int_(i)] = name_of(self.mapped[i].failure);
  return self.failures = std::move(result);
}

py::array stretch_of(const MappedShapes& self) {
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Vec2> result;
  result.reserve(self.mapped.size());
  for (const MappedShape& mapped : self.mapped)
    result.push_back(mapped.failure == MapFailure::none ? Vec2(mapped.outline.smallest, mapped.outline.largest)
                                                        : Vec2(k_nan, k_nan));
  return to_array(std::move(result));
}

std::vector<SurfacePoints> loops_of(const SurfaceOutline& outline) {
  std::vector<SurfacePoints> result;
  for (std::size_t loop = 0; loop + 1 < outline.loop_begins.size(); ++loop) {
    SurfacePoints& points = result.emplace_back();
    for (std::size_t k = outline.loop_begins[loop]; k < outline.loop_begins[loop + 1]; ++k)
      points.push_back(outline_point(outline.pieces[k].face, outline.pieces[k].begin));
  }
  return result;
}

py::list outline_surface(const MappedShapes& self, const py::object& index) {
  py::list result;
  for (SurfacePoints& loop : loops_of(self.mapped[self.laid(index)].outline)) result.append(py::cast(std::move(loop)));
  return result;
}

py::list outline_points(const MappedShapes& self, const py::object& index) {
  py::list result;
  for (const SurfacePoints& loop : loops_of(self.mapped[self.laid(index)].outline)) {
    std::vector<Vec3> points;
    points.reserve(loop.size());
    for (const SurfacePoint& point : loop) points.push_back(position(self.mesh(), point));
    result.append(to_array(std::move(points)));
  }
  return result;
}

/// A bent object, with where it is now.
struct Conformed {
  ConformedPoints points;
  std::vector<Vec3> positions;
};
auto fields_of(Conformed& of) { return std::tie(of.points, of.positions); }

std::vector<Vec3> as_vertices(const py::object& value) {
  std::vector<Vec3> result;
  const py::array array = as_array(value, "vertices", "shape (n, 3) of real numbers");
  if (array.ndim() == 2 && array.shape(1) == 2) {
    const ArrayIn<double> flat = as_points2(value, "vertices");
    for (Index i = 0; i < flat.count; ++i) result.emplace_back(flat.values[2 * i], flat.values[2 * i + 1], 0);
    return result;
  }
  const ArrayIn<double> solid = as_points3(value, "vertices");
  for (Index i = 0; i < solid.count; ++i)
    result.emplace_back(solid.values[3 * i], solid.values[3 * i + 1], solid.values[3 * i + 2]);
  return result;
}

Conformed conform_one(MappedShapes& self, const py::object& vertices, const py::object& index) {
  const Index i = self.laid(index);
  const std::vector<Vec3> points = as_vertices(vertices);
  const Mesh& mesh = self.mesh();
  const MapShapesOptions laid{self.limits, self.fields()};
  const DirectionField* const field = laid.field(self.placements[i].shape);
  return without_gil([&] {
    const std::lock_guard lock(self.mutex);
    if (!self.conformer) self.conformer = std::make_unique<Conformer>(mesh);
    Conformed result;
    result.points = self.conformer->conform(self.shape(i), self.placements[i], field, points, self.limits);
    result.positions = positions_of(mesh, self.normals(mesh), result.points.anchors, result.points.heights);
    return result;
  });
}

/// Anchored points on the same mesh with other positions.
py::array positions_on(const py::object& mesh_object, const SurfacePoints& anchors, std::span<const double> heights) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  return to_array(without_gil([&] {
    check_surface_points(mesh, anchors, "self");
    return positions_of(mesh, vertex_normals(mesh), anchors, heights);
  }));
}

/// Bent meshes, with where they are now.
struct BentMeshes {
  BentCopies copies;
  std::vector<Vec3> positions;
};
auto fields_of(BentMeshes& of) { return std::tie(of.copies, of.positions); }

std::vector<Solid> as_solids(const py::object& value, std::size_t count) {
  if (!py::isinstance<py::sequence>(value) || py::len(value) != count)
    throw InputError(
        message("solids: wanted a sequence of one (vertices, triangles) or None for each of the ", count, " shapes"));
  std::vector<Solid> result(count);
  for (std::size_t s = 0; s < count; ++s) {
    const py::object solid = value[py::int_(s)];
    if (solid.is_none()) continue;
    if (!py::isinstance<py::sequence>(solid) || py::len(solid) != 2)
      throw InputError(message("solids: wanted (vertices, triangles) or None at [", s, "]"));
    result[s].vertices = as_vertices(solid[py::int_(0)]);
    const ArrayIn<Index> triangles = as_triangles(solid[py::int_(1)], "solids");
    for (Index t = 0; t < triangles.count; ++t)
      result[s].triangles.push_back(
          {triangles.values[3 * t], triangles.values[3 * t + 1], triangles.values[3 * t + 2]});
  }
  return result;
}

BentMeshes bend_all(const MappedShapes& self, const py::object& solids, const py::object& tolerance,
                    const py::object& threads, const py::object& job) {
  const Mesh& mesh = self.mesh();
  const std::vector<Solid> given = as_solids(solids, self.shapes.size());
  const JobIn token(job);
  BendOptions options{
      {self.limits, self.fields(), as_integer(threads, "threads"), token}, as_real(tolerance, "tolerance"), {}};
  return without_gil([&] {
    options.normals = self.normals(mesh);
    BentMeshes result{bent_copies(mesh, self.shapes, self.placements, given, options), {}};
    result.positions = positions_of(mesh, options.normals, result.copies.anchors, result.copies.heights);
    return result;
  });
}

/// A cut mesh, with where it is now.
struct CutSurface {
  CutMesh cut;
  std::vector<Vec3> positions;
};
auto fields_of(CutSurface& of) { return std::tie(of.cut, of.positions); }

CutSurface with_positions(const Mesh& mesh, CutMesh cut) {
  CutSurface result{std::move(cut), {}};
  result.positions.reserve(result.cut.vertices.size());
  for (const SurfacePoint& point : result.cut.vertices) result.positions.push_back(position(mesh, point));
  return result;
}

CutSurface cut_surface(const MappedShapes& self, CutPart part, const py::object& job) {
  const Mesh& mesh = self.mesh();
  const JobIn watched(job);
  return without_gil([&] { return with_positions(mesh, cut_shapes(mesh, self.mapped, part, watched)); });
}

CutSurface patch_of(const MappedShapes& self, const py::object& index) {
  const Index i = self.laid(index);
  const Mesh& mesh = self.mesh();
  return without_gil([&] {
    CutSurface result = with_positions(mesh, cut_shapes(mesh, std::span(&self.mapped[i], 1), CutPart::shapes));
    for (Index& shape : result.cut.triangle_shape) shape = i;
    return result;
  });
}

ShapeAttributes attributes_of(const MappedShapes& self, const py::object& reach, const py::object& threads,
                              const py::object& job) {
  const double distance = as_real(reach, "reach");
  const Mesh& mesh = self.mesh();
  const JobIn token(job);
  const MapShapesOptions options{self.limits, self.fields(), as_integer(threads, "threads"), token};
  return without_gil([&] { return shape_attributes(mesh, self.shapes, self.placements, distance, options); });
}

py::tuple frames_of(const MappedShapes& self, const py::object& mesh_object) {
  const Mesh& mesh = mesh_object.is_none() ? self.mesh() : as_mesh(mesh_object, "mesh");
  check_placements(mesh, self.shapes.size(), self.placements);
  const std::vector<RigidFrame> frames = without_gil([&] {
    return mesh_object.is_none() ? rigid_frames(mesh, self.normals(mesh), self.placements)
                                 : rigid_frames(mesh, vertex_normals(mesh), self.placements);
  });
  std::vector<Vec3> points, scales;
  std::vector<double> rotations;
  for (const RigidFrame& frame : frames) {
    points.push_back(frame.position);
    scales.push_back(frame.scale);
    const Eigen::Quaterniond& q = frame.rotation;
    rotations.insert(rotations.end(), {q.w(), q.x(), q.y(), q.z()});
  }
  return py::make_tuple(to_array(std::move(points)), to_array(std::move(rotations)).attr("reshape")(-1, 4),
                        to_array(std::move(scales)));
}

void bind_bent_copies(py::module_& m) {
  py::class_<BentMeshes>(m, "BentCopies", py::module_local(),
                         "Meshes bent onto a surface and fixed to it, one after the other.")
      .def_property_readonly(
          "vertices",
          [](const py::object& self) {
            return view_of(std::span<const Vec3>(py::cast<const BentMeshes&>(self).positions), self);
          },
          "(n, 3) float64: where the vertices are.")
      .def_property_readonly(
          "surface", [](const BentMeshes& self) { return self.copies.anchors; },
          "SurfacePoints that the vertices stand on.")
      .def_property_readonly(
          "heights",
          [](const py::object& self) {
            return view_of(std::span<const double>(py::cast<const BentMeshes&>(self).copies.heights), self);
          },
          "(n,) float64: height of the vertices above the surface along its smooth normal, mesh units.")
      .def_property_readonly(
          "begins",
          [](const py::object& self) {
            return view_of(std::span<const std::int64_t>(py::cast<const BentMeshes&>(self).copies.begins), self);
          },
          "(placements + 1,) int64: first vertex of each copy; those of its solid come first, then those in between.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            return view_of(std::span<const Triangle>(py::cast<const BentMeshes&>(self).copies.triangles), self);
          },
          "(m, 3) int32; of mirrored copies the other way round, so that the outside stays outside.")
      .def_property_readonly(
          "triangle_copy",
          [](const py::object& self) {
            return view_of(std::span<const Index>(py::cast<const BentMeshes&>(self).copies.triangle_copy), self);
          },
          "(m,) int32: placement.")
      .def_property_readonly(
          "triangle_source",
          [](const py::object& self) {
            return view_of(std::span<const Index>(py::cast<const BentMeshes&>(self).copies.triangle_source), self);
          },
          "(m,) int32: triangle of the solid that it is, or is a part of.")
      .def_property_readonly(
          "weights",
          [](const py::object& self) {
            const auto& weights = py::cast<const BentMeshes&>(self).copies.weights;
            return view_of_rows<double>(std::span<const std::array<Vec3, 3>>(weights), self).attr("reshape")(-1, 3, 3);
          },
          "(m, 3, 3) float64: of each corner, where it lies in that triangle (barycentric), for what the solid's "
          "corners carry.")
      .def_property_readonly(
          "deviations",
          [](const py::object& self) {
            return view_of(std::span<const double>(py::cast<const BentMeshes&>(self).copies.deviations), self);
          },
          "(placements,) float64: how far edges and triangles still leave the surface, as far as samples tell, as "
          "shares of the circumradius; not a number for those that could not be laid, or without a tolerance.")
      .def_property_readonly(
          "lost",
          [](const py::object& self) {
            return view_of(std::span<const std::int64_t>(py::cast<const BentMeshes&>(self).copies.lost), self);
          },
          "int64: vertices beside the outline for which there is no surface; they are put at the center.")
      .def(
          "positions",
          [](const BentMeshes& self, const py::object& mesh) {
            return positions_on(mesh, self.copies.anchors, self.copies.heights);
          },
          py::arg("mesh"),
          "(n, 3) float64: where they are on the same mesh with other positions; InputError where it has other faces.");
}

void bind_products(py::module_& m) {
  py::class_<Conformed>(m, "ConformedPoints", py::module_local(), "An object bent onto a surface and fixed to it.")
      .def_property_readonly(
          "points",
          [](const py::object& self) {
            return view_of(std::span<const Vec3>(py::cast<const Conformed&>(self).positions), self);
          },
          "(n, 3) float64: where its vertices are.")
      .def_property_readonly(
          "surface", [](const Conformed& self) { return self.points.anchors; },
          "SurfacePoints that the vertices stand on.")
      .def_property_readonly(
          "heights",
          [](const py::object& self) {
            return view_of(std::span<const double>(py::cast<const Conformed&>(self).points.heights), self);
          },
          "(n,) float64: height of the vertices above the surface along its smooth normal, mesh units.")
      .def_property_readonly(
          "lost",
          [](const py::object& self) {
            return view_of(std::span<const Index>(py::cast<const Conformed&>(self).points.lost), self);
          },
          "int32: vertices beside the outline for which there is no surface; they are put at the center.")
      .def(
          "positions",
          [](const Conformed& self, const py::object& mesh) {
            return positions_on(mesh, self.points.anchors, self.points.heights);
          },
          py::arg("mesh"),
          "(n, 3) float64: where they are on the same mesh with other positions; InputError where it has other faces.");
  bind_bent_copies(m);
  py::class_<CutSurface>(m, "CutSurface", py::module_local(), "Surface cut along the outlines of shapes.")
      .def_property_readonly(
          "surface", [](const CutSurface& self) { return self.cut.vertices; },
          "SurfacePoints of its vertices on the mesh that was cut.")
      .def_property_readonly(
          "vertices",
          [](const py::object& self) {
            return view_of(std::span<const Vec3>(py::cast<const CutSurface&>(self).positions), self);
          },
          "(n, 3) float64.")
      .def_property_readonly(
          "vertex_origin",
          [](const py::object& self) {
            return view_of(std::span<const Index>(py::cast<const CutSurface&>(self).cut.vertex_origin), self);
          },
          "(n,) int32: vertex of the mesh, -1 for those on outlines.")
      .def_property_readonly(
          "uv",
          [](const py::object& self) {
            return view_of_rows<double>(std::span<const Vec2>(py::cast<const CutSurface&>(self).cut.vertex_plane),
                                        self);
          },
          "(n, 2) float64: in the plane of its shape, in its units; 0 outside of all.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            return view_of(std::span<const Triangle>(py::cast<const CutSurface&>(self).cut.triangles), self);
          },
          "(m, 3) int32.")
      .def_property_readonly(
          "triangle_face",
          [](const py::object& self) {
            return view_of(std::span<const Index>(py::cast<const CutSurface&>(self).cut.triangle_face), self);
          },
          "(m,) int32: face of the mesh that the triangle is a part of.")
      .def_property_readonly(
          "triangle_shape",
          [](const py::object& self) {
            return view_of(std::span<const Index>(py::cast<const CutSurface&>(self).cut.triangle_shape), self);
          },
          "(m,) int32: placement whose shape it lies in, -1 outside of all.");
  py::class_<ShapeAttributes>(m, "ShapeAttributes", py::module_local(),
                              "Attributes of vertices by the shapes near them.")
      .def_property_readonly(
          "placement",
          [](const py::object& self) {
            return view_of(std::span<const Index>(py::cast<const ShapeAttributes&>(self).placement), self);
          },
          "(V,) int32: placement of the nearest shape, -1 where none is within reach.")
      .def_property_readonly(
          "distance",
          [](const py::object& self) {
            return view_of(std::span<const double>(py::cast<const ShapeAttributes&>(self).distance), self);
          },
          "(V,) float64: to its outline, as in its plane, mesh units; negative inside, infinite where there is none.")
      .def_property_readonly(
          "uv",
          [](const py::object& self) {
            return view_of_rows<double>(std::span<const Vec2>(py::cast<const ShapeAttributes&>(self).plane), self);
          },
          "(V, 2) float64: the vertex in the plane of that shape, in its units.");
}

py::tuple save_mapped(const py::object& self) {
  const auto& mapped = py::cast<const MappedShapes&>(self);
  py::list shapes;
  for (const Shape& shape : mapped.shapes) shapes.append(shape);
  return py::make_tuple(mapped.mesh_object, shapes, mapped.placements, mapped.field_object,
                        py::make_tuple(mapped.limits.smallest, mapped.limits.largest));
}

/// Lays the shapes again, which takes less than to send what comes of it.
std::unique_ptr<MappedShapes> load_mapped(const py::tuple& state) {
  const py::tuple parts = as_state(state, 5);
  return make_mapped(parts[0], parts[1], parts[2], parts[3], parts[4], py::int_(0), py::none());
}

}  // namespace

void bind_shape_maps(py::module_& m) {
  bind_products(m);
  py::class_<MappedShapes>(m, "MappedShapes", py::module_local(), k_mapped_doc)
      .def_property_readonly(
          "placements", [](const MappedShapes& self) { return self.placements; }, "Placements.")
      .def_property_readonly("failures", &failures_of,
                             "{placement: why} of those that could not be laid: \"boundary\" (leaves the surface), "
                             "\"fold\" (would cover it "
                             "twice), \"stretched\" (beyond the limits).")
      .def_property_readonly("stretch", &stretch_of,
                             "(n, 2) float64: smallest and largest singular value of the map of each shape, not a "
                             "number for those that could not be laid.")
      .def("outline", &outline_points, py::arg("i"),
           "List of (k, 3) float64: the loops of a placement's outline on the surface, closed, straight in every face.")
      .def("outline_surface", &outline_surface, py::arg("i"),
           "These points as SurfacePoints; consecutive ones share the face of the first.")
      .def("conform", &conform_one, py::arg("vertices"), py::arg("i"), k_conform_doc)
      .def("bend", &bend_all, py::arg("solids"), py::arg("tolerance") = 0.01, py::kw_only(), py::arg("threads") = 0,
           py::arg("job") = py::none(), k_bend_doc)
      .def("patch", &patch_of, py::arg("i"), "CutSurface of the piece of surface that a placement's shape covers.")
      .def(
          "patches",
          [](const MappedShapes& self, const py::object& job) { return cut_surface(self, CutPart::shapes, job); },
          py::kw_only(), py::arg("job") = py::none(), "CutSurface of all pieces, each by itself.")
      .def(
          "cut",
          [](const MappedShapes& self, const py::object& job) { return cut_surface(self, CutPart::everything, job); },
          py::kw_only(), py::arg("job") = py::none(),
          "CutSurface of the whole surface, its own vertices first. Raises InputError where shapes overlap.")
      .def("attributes", &attributes_of, py::arg("reach") = 0.0, py::kw_only(), py::arg("threads") = 0,
           py::arg("job") = py::none(), k_attributes_doc)
      .def(
          "frames", &frames_of, py::arg("mesh") = py::none(),
          "Rigid copies: points (n, 3), unit quaternions (n, 4) as w x y z, scales (n, 3) with y negative for mirrored "
          "ones. z is along the smooth normal, x along the placement's direction. On `mesh` instead, if it is given: "
          "the same one with other positions.")
      .def("__len__", [](const MappedShapes& self) { return self.mapped.size(); })
      .def("__repr__", [](const MappedShapes& self) {
        return message("<MappedShapes: ", self.mapped.size(), ", ", py::len(failures_of(self)), " not laid>");
      });
  m.def("map_shapes", &make_mapped, py::arg("mesh"), py::arg("shapes"), py::arg("placements"),
        py::arg("field") = py::none(), py::kw_only(), py::arg("limits") = py::make_tuple(0.5, 2.0),
        py::arg("threads") = 0, py::arg("job") = py::none(), k_map_doc);
  let_travel<Conformed>(m, "ConformedPoints");
  let_travel<BentMeshes>(m, "BentCopies");
  let_travel<CutSurface>(m, "CutSurface");
  let_travel<MappedShapes>(m, "MappedShapes", &save_mapped, &load_mapped);
}

}  // namespace saddleback::bindings
