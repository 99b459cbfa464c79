#include "convert/points.h"

#include "convert/curves.h"

namespace saddleback::bindings {
namespace {

std::string type_of(const py::object& value) { return py::cast<std::string>(py::type::of(value).attr("__name__")); }

void check_vertices(std::span<const Index> vertices, const Mesh& mesh, const char* argument) {
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (vertices[i] < 0 || vertices[i] >= mesh.vertex_count())
      throw InputError(message(argument, ": vertex ", vertices[i], " at [", i, "] is out of range, the mesh has ",
                               mesh.vertex_count(), " vertices"));
}

std::vector<Index> as_vertices(const py::object& value, const char* argument) {
  if (PyIndex_Check(value.ptr()) && !py::isinstance<py::array>(value)) return {as_integer(value, argument)};
  const bool is_points_of_space =
      !py::isinstance<py::str>(value) && !value.is_none() && !holds_integers(value, argument);
  if (is_points_of_space)
    throw InputError(message(argument, ": wanted vertex indices or a SurfacePoints, got a ", type_of(value),
                             " that does not hold integers; saddleback.project turns positions into a SurfacePoints"));
  const ArrayIn<Index> indices = as_indices(value, argument);
  return {indices.values.begin(), indices.values.end()};
}

}  // namespace

PointsIn as_points(const py::object& value, const Mesh& mesh, const char* argument) {
  if (py::isinstance<SurfacePoints>(value)) {
    PointsIn result{py::cast<const SurfacePoints&>(value), false, {}};
    check_surface_points(mesh, result.points, argument);
    return result;
  }
  PointsIn result{{}, true, as_vertices(value, argument)};
  check_vertices(result.vertices, mesh, argument);
  result.points.reserve(result.vertices.size());
  for (const Index vertex : result.vertices) result.points.push_back(at_vertex(mesh, vertex));
  return result;
}

SurfacePoints as_surface_points(const py::object& value, const Mesh& mesh, const char* argument) {
  return as_points(value, mesh, argument).points;
}

SurfacePoint as_surface_point(const py::object& value, const Mesh& mesh, const char* argument) {
  const SurfacePoints points = as_surface_points(value, mesh, argument);
  if (points.size() != 1) throw InputError(message(argument, ": wanted one point, got ", points.size()));
  return points.front();
}

const Mesh& as_mesh(const py::object& value, const char* argument) {
  if (!py::isinstance<Mesh>(value)) throw InputError(message(argument, ": wanted a Mesh, got a ", type_of(value)));
  return py::cast<const Mesh&>(value);
}

const SaddleVertexGraph& as_graph(const py::object& value) {
  if (!py::isinstance<SaddleVertexGraph>(value))
    throw InputError(message("graph: wanted a SaddleVertexGraph, got a ", type_of(value)));
  return py::cast<const SaddleVertexGraph&>(value);
}

CurvesIn as_curves(const py::object& curves) {
  CurvesIn result;
  if (curves.is_none()) return result;
  const auto refuse = [](const py::handle& got) {
    throw InputError(message("curves: wanted SurfaceCurves, got a ", Py_TYPE(got.ptr())->tp_name));
  };
  if (!py::isinstance<py::iterable>(curves)) refuse(curves);
  result.kept = py::tuple(curves);
  for (const py::handle curve : result.kept) {
    if (!py::isinstance<SurfaceCurve>(curve)) refuse(curve);
    result.curves.push_back(&py::cast<const SurfaceCurve&>(curve));
  }
  return result;
}

}  // namespace saddleback::bindings
