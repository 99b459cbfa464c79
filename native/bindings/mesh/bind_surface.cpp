// SurfacePoints and what makes them: project, sample, trace; GeodesicPath.

#include <cmath>

#include "saddleback/mesh/project.h"
#include "saddleback/mesh/sample.h"
#include "saddleback/mesh/trace.h"

#include "convert/points.h"
#include "convert/state.h"

namespace saddleback::bindings {
namespace {

constexpr const char* k_points_doc =
    R"(Points anywhere on a mesh: a face index and three barycentric coordinates each. Immutable.

Args:
    faces: (n,) face indices, integers >= 0.
    barycentric: (n, 3) coordinates in the order of the face's corners, >= 0 and summing to 1; rounding (up to 1e-6,
        as float32 brings) is removed.

Raises:
    InputError: wrong shape or type, a negative face, coordinates not finite, negative or of another sum.
)";

constexpr const char* k_project_doc = R"(The nearest surface point for each position.

Of equally near points the one in the smallest face is given; on an edge or vertex its coordinates are exactly 0 or 1.
A bounding volume hierarchy is built for each call: O((F + n) log F).

Args:
    xyz: (n, 3) positions, mesh units.
    threads: 0 for all cores; never changes the result.

Raises:
    InputError: wrong shape, a coordinate that is not finite.
    Cancelled: the job was.
)";

constexpr const char* k_sample_doc =
    R"(Points whose number per area follows the density, spread evenly: systematic sampling along a Hilbert curve.

The same seed gives the same points on every platform. O(F log F + count).

Args:
    count: number of points, at least 1.
    density: (V,) wanted points per area, >= 0; only ratios matter; linear over each face. None: the same everywhere.
    one_per_component: every connected component gets a point, by area where its density is zero.
    job: a Job that tells how far it is and may stop it.

Raises:
    InputError: count too small, density of the wrong length, not finite, negative or zero everywhere.
    Cancelled: the job was.
)";

constexpr const char* k_trace_doc = R"(Walks straight on over the surface: the exponential map.

Through a vertex the curve goes on with half of the total angle on either side [polthier1998]; at the boundary it stops,
unless it runs along a straight border or touches a corner. O(faces crossed).

Args:
    point: one surface point, or a vertex index.
    direction: an angle in radians, or a (3,) vector, which is projected onto the surface. Angles are measured
        counter-clockwise in the chart of the point's face (corner 0 to corner 1 is 0) or, at a vertex, on the surface
        about it from its first edge.
    length: mesh units, >= 0.
    job: a Job that tells how far it is and may stop it.

Raises:
    InputError: bad point, direction or length; a vector across the surface; a curve over more than a million faces.
)";

/// A traced curve: a GeodesicPath that also knows how it ended.
struct TracedPath : GeodesicPath {
  double end_angle = 0;
  Vec3 end_direction = Vec3::Zero();
  bool hit_boundary = false;
};
auto fields_of(TracedPath& of) {
  return std::tie(of.points, of.surface, of.length, of.end_angle, of.end_direction, of.hit_boundary);
}

SurfacePoints make_points(const py::object& faces, const py::object& barycentric) {
  const ArrayIn<Index> face = as_indices(faces, "faces");
  const ArrayIn<double> weights = as_points3(barycentric, "barycentric");
  return without_gil([&] { return surface_points(face.values, weights.values); });
}

const SurfacePoints& points_of(const py::object& self) { return py::cast<const SurfacePoints&>(self); }

// Views of the interleaved points; numpy strides over what lies between.
py::array faces_of(const py::object& self) {
  const SurfacePoints& points = points_of(self);
  const std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(points.size())}, strides{sizeof(SurfacePoint)};
  static const SurfacePoint none;
  return read_only(py::array_t<Index>(shape, strides, &(points.empty() ? none : points.front()).face, self));
}

py::array barycentric_of(const py::object& self) {
  const SurfacePoints& points = points_of(self);
  const std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(points.size()), 3},
      strides{sizeof(SurfacePoint), sizeof(double)};
  static const SurfacePoint none;
  const SurfacePoint& first = points.empty() ? none : points.front();
  return read_only(py::array_t<double>(shape, strides, first.barycentric.data(), self));
}

py::array positions_of(const SurfacePoints& points, const py::object& mesh_object) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  return to_array(without_gil([&] {
    check_surface_points(mesh, points, "self");
    std::vector<Vec3> result;
    result.reserve(points.size());
    for (const SurfacePoint& point : points) result.push_back(position(mesh, point));
    return result;
  }));
}

SurfacePoints item(const SurfacePoints& points, const py::object& key) {
  const py::ssize_t count = static_cast<py::ssize_t>(points.size());
  if (py::isinstance<py::slice>(key)) {
    py::ssize_t start = 0, stop = 0, step = 0, length = 0;
    if (!py::cast<py::slice>(key).compute(count, &start, &stop, &step, &length)) throw py::error_already_set();
    SurfacePoints result;
    result.reserve(static_cast<std::size_t>(length));
    for (py::ssize_t i = 0; i < length; ++i) result.push_back(points[static_cast<std::size_t>(start + i * step)]);
    return result;
  }
  const py::ssize_t i = as_integer(key, "index");
  // IndexError, not InputError: Python's iteration ends on it.
  if (i < -count || i >= count) throw py::index_error(message("index ", i, " is out of range for ", count, " points"));
  return {points[static_cast<std::size_t>(i < 0 ? i + count : i)]};
}

/// A float angle or a 3-vector.
double as_direction(const py::object& value, const Mesh& mesh, const SurfacePoint& start) {
  if (PyFloat_Check(value.ptr()) || PyLong_Check(value.ptr()) || !py::hasattr(value, "__len__"))
    return as_real(value, "direction");
  return start_angle(mesh, start, as_vec3(value, "direction"));
}

TracedPath trace_from(const py::object& mesh_object, const py::object& point, const py::object& direction,
                      const py::object& length, const py::object& job_object) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const SurfacePoint start = as_surface_point(point, mesh, "point");
  const double angle = as_direction(direction, mesh, start);
  const double wanted = as_real(length, "length");
  const JobIn job(job_object);
  return without_gil([&] {
    TraceResult result = trace(mesh, start, angle, wanted, job);
    const Index last_face = result.path.surface.back().face;
    const Vec3 arrival = direction_in_space(mesh, last_face, result.end_angle);
    return TracedPath{std::move(result.path), result.end_angle, arrival, result.hit_boundary};
  });
}

SurfacePoints project_onto(const py::object& mesh_object, const py::object& xyz, const py::object& threads,
                           const py::object& job) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const ArrayIn<double> queries = as_points3(xyz, "xyz");
  const JobIn token(job);
  const ProjectOptions options{.threads = as_integer(threads, "threads"), .job = token};
  return without_gil([&] { return project(mesh, queries.values, options); });
}

SurfacePoints sample_on(const py::object& mesh_object, const py::object& count, const py::object& density,
                        const py::object& seed, bool one_per_component, const py::object& job) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const JobIn token(job);
  SampleOptions options{.count = as_integer(count, "count"),
                        .seed = as_seed(seed, "seed"),
                        .one_per_component = one_per_component,
                        .job = token};
  ArrayIn<double> weights;
  if (!density.is_none()) {
    weights = as_reals(density, "density", mesh.vertex_count());
    options.density = weights.values;
  }
  return without_gil([&] { return sample(mesh, options); });
}

void bind_points(py::module_& m) {
  py::class_<SurfacePoints>(m, "SurfacePoints", py::module_local(), k_points_doc)
      .def(py::init(&make_points), py::arg("faces"), py::arg("barycentric"))
      .def_property_readonly("faces", &faces_of, "(n,) int32: face indices; read-only view.")
      .def_property_readonly("barycentric", &barycentric_of, "(n, 3) float64: coordinates; read-only view.")
      .def("positions", &positions_of, py::arg("mesh"), "(n, 3) float64: positions in space on that mesh.")
      .def("__len__", [](const SurfacePoints& points) { return points.size(); })
      .def("__getitem__", &item)
      .def("__iter__",
           [](const py::object& self) { return py::reinterpret_steal<py::object>(PySeqIter_New(self.ptr())); })
      .def("__repr__", [](const SurfacePoints& points) {
        return message("<SurfacePoints: ", points.size(), points.size() == 1 ? " point>" : " points>");
      });
  m.def("project", &project_onto, py::arg("mesh"), py::arg("xyz"), py::kw_only(), py::arg("threads") = 0,
        py::arg("job") = py::none(), k_project_doc);
  m.def("sample", &sample_on, py::arg("mesh"), py::arg("count"), py::arg("density") = py::none(), py::arg("seed") = 0,
        py::kw_only(), py::arg("one_per_component") = false, py::arg("job") = py::none(), k_sample_doc);
}

void bind_paths(py::module_& m) {
  py::class_<GeodesicPath>(m, "GeodesicPath", py::module_local(),
                           "A curve on the surface; consecutive points share a face.")
      .def_property_readonly(
          "points",
          [](const py::object& self) {
            return view_of(std::span<const Vec3>(py::cast<const GeodesicPath&>(self).points), self);
          },
          "(n, 3) float64: points in space.")
      .def_property_readonly(
          "surface", [](const GeodesicPath& path) { return path.surface; }, "These points as a SurfacePoints.")
      .def_readonly("length", &GeodesicPath::length, "Length of the curve, mesh units.")
      .def("__repr__", [](const GeodesicPath& path) {
        return message("<GeodesicPath: ", path.points.size(), " points, length ", path.length, ">");
      });
  py::class_<TracedPath, GeodesicPath>(m, "TracedPath", py::module_local(), "A traced curve and how it ended.")
      .def_readonly("end_angle", &TracedPath::end_angle,
                    "Direction of arrival, radians, in the chart of the last point's face (corner 0 to 1 is 0).")
      .def_property_readonly(
          "end_direction",
          [](const TracedPath& path) {
            return to_array(
                std::vector<double>{path.end_direction.x(), path.end_direction.y(), path.end_direction.z()});
          },
          "(3,) float64: direction of arrival, a unit vector.")
      .def_readonly("hit_boundary", &TracedPath::hit_boundary, "True when the boundary stopped the curve early.");
  m.def("trace", &trace_from, py::arg("mesh"), py::arg("point"), py::arg("direction"), py::arg("length"), py::kw_only(),
        py::arg("job") = py::none(), k_trace_doc);
}

}  // namespace

void bind_surface(py::module_& m) {
  bind_points(m);
  bind_paths(m);
  let_travel<TracedPath>(m, "TracedPath");
}

}  // namespace saddleback::bindings
