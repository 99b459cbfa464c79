// SurfacePoints and what makes them: project, sample, trace; GeodesicPath.

#include <cmath>

#include "points.h"
#include "saddleback/project.h"
#include "saddleback/sample.h"
#include "saddleback/trace.h"

namespace saddleback::bindings {
namespace {

/// A traced curve: a GeodesicPath that also knows how it ended.
struct TracedPath : GeodesicPath {
  double end_angle = 0;
  Vec3 end_direction = Vec3::Zero();
  bool hit_boundary = false;
};

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
                      const py::object& length) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const SurfacePoint start = as_surface_point(point, mesh, "point");
  const double angle = as_direction(direction, mesh, start);
  const double wanted = as_real(length, "length");
  return without_gil([&] {
    TraceResult result = trace(mesh, start, angle, wanted);
    const Index last_face = result.path.surface.back().face;
    const Vec3 arrival = direction_in_space(mesh, last_face, result.end_angle);
    return TracedPath{std::move(result.path), result.end_angle, arrival, result.hit_boundary};
  });
}

SurfacePoints project_onto(const py::object& mesh_object, const py::object& xyz, const py::object& threads,
                           const py::object& job) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  const ArrayIn<double> queries = as_points3(xyz, "xyz");
  const ProjectOptions options{.threads = as_integer(threads, "threads"), .job = as_job(job)};
  return without_gil([&] { return project(mesh, queries.values, options); });
}

SurfacePoints sample_on(const py::object& mesh_object, const py::object& count, const py::object& density,
                        const py::object& seed, bool one_per_component) {
  const Mesh& mesh = as_mesh(mesh_object, "mesh");
  SampleOptions options{.count = as_integer(count, "count"), .seed = as_seed(seed, "seed"),
                        .one_per_component = one_per_component};
  ArrayIn<double> weights;
  if (!density.is_none()) {
    weights = as_reals(density, "density", mesh.vertex_count());
    options.density = weights.values;
  }
  return without_gil([&] { return sample(mesh, options); });
}

void bind_points(py::module_& m) {
  py::class_<SurfacePoints>(m, "SurfacePoints", py::module_local(),
                            "Points anywhere on a mesh: a face index and three barycentric coordinates each.")
      .def(py::init(&make_points), py::arg("faces"), py::arg("barycentric"))
      .def_property_readonly("faces", &faces_of)
      .def_property_readonly("barycentric", &barycentric_of)
      .def("positions", &positions_of, py::arg("mesh"))
      .def("__len__", [](const SurfacePoints& points) { return points.size(); })
      .def("__getitem__", &item)
      .def("__repr__", [](const SurfacePoints& points) {
        return message("<SurfacePoints: ", points.size(), points.size() == 1 ? " point>" : " points>");
      });
  m.def("project", &project_onto, py::arg("mesh"), py::arg("xyz"), py::kw_only(), py::arg("threads") = 0,
        py::arg("job") = py::none());
  m.def("sample", &sample_on, py::arg("mesh"), py::arg("count"), py::arg("density") = py::none(), py::arg("seed") = 0,
        py::kw_only(), py::arg("one_per_component") = false);
}

void bind_paths(py::module_& m) {
  py::class_<GeodesicPath>(m, "GeodesicPath", py::module_local(), "A curve on the surface.")
      .def_property_readonly("points",
                             [](const py::object& self) {
                               return view_of(std::span<const Vec3>(py::cast<const GeodesicPath&>(self).points), self);
                             })
      .def_property_readonly("surface", [](const GeodesicPath& path) { return path.surface; })
      .def_readonly("length", &GeodesicPath::length)
      .def("__repr__", [](const GeodesicPath& path) {
        return message("<GeodesicPath: ", path.points.size(), " points, length ", path.length, ">");
      });
  py::class_<TracedPath, GeodesicPath>(m, "TracedPath", py::module_local(), "A traced curve and how it ended.")
      .def_readonly("end_angle", &TracedPath::end_angle)
      .def_property_readonly("end_direction",
                             [](const TracedPath& path) { return to_array(std::vector<double>{
                                 path.end_direction.x(), path.end_direction.y(), path.end_direction.z()}); })
      .def_readonly("hit_boundary", &TracedPath::hit_boundary);
  m.def("trace", &trace_from, py::arg("mesh"), py::arg("point"), py::arg("direction"), py::arg("length"));
}

}  // namespace

void bind_surface(py::module_& m) {
  bind_points(m);
  bind_paths(m);
}

}  // namespace saddleback::bindings
