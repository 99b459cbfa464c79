#include "saddleback/charts/disk_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "saddleback/error.h"

#include "charts/turn.h"
#include "mesh/tables/outgoing.h"
#include "support/sparse_cholesky.h"

namespace saddleback {
namespace {

// Least weight of an edge; those of equilateral triangles have 1.15. Smaller ones, and the negative ones of edges that
// are not Delaunay, would let faces flip; the map is a convex combination map there instead.
constexpr double k_least_weight = 1e-3;

void check_disk(const Mesh& mesh) {
  const auto borders = static_cast<Index>(mesh.boundary_loops().size());
  if (mesh.component_count() == 1 && borders == 1 && mesh.genus() == 0) return;
  const auto count = [](Index number, const char* what) { return message(number, " ", what, number == 1 ? "" : "s"); };
  throw InputError(message("mesh: wanted a disk (1 part, 1 border, 0 handles), got ",
                           count(mesh.component_count(), "part"), ", ", count(borders, "border"), " and ",
                           count(mesh.genus(), "handle"), "; cut it open or choose a part of it"));
}

double cotangent(double angle) { return std::cos(angle) / std::sin(angle); }

/// Returns the weight of the edge of a half-edge, from the angles opposite to it; the same for both half-edges.
double weight(const Mesh& mesh, Index h) {
  double sum = cotangent(mesh.corner_angle(Mesh::prev(h)));
  if (mesh.twin(h) != k_none) sum += cotangent(mesh.corner_angle(Mesh::prev(mesh.twin(h))));
  return std::max(sum, k_least_weight);
}

void place_border(const Mesh& mesh, std::vector<Vec2>& places) {
  const std::vector<Index>& loop = mesh.boundary_loops()[0];
  std::vector<double> until{0};
  for (const Index v : loop) until.push_back(until.back() + mesh.length(mesh.first_halfedge(v)));
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const double angle = 2 * std::numbers::pi * until[i] / until.back();
    places[loop[i]] = {std::cos(angle), std::sin(angle)};
  }
}

/// Each inner vertex at the mean of its neighbors: one equation each, and what border vertices bring to the right
/// side.
struct Equations {
  std::vector<Index> vertices;  ///< the inner ones
  SymmetricMatrix matrix;
  std::vector<Vec2> right;
};

Equations set_up(const Mesh& mesh, const std::vector<Vec2>& places) {
  Equations result;
  std::vector<Index> row(mesh.vertex_count(), k_none);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (mesh.is_boundary(v)) continue;
    row[v] = static_cast<Index>(result.vertices.size());
    result.vertices.push_back(v);
  }
  result.matrix.offsets.push_back(0);
  for (const Index v : result.vertices) {
    double sum = 0;
    Vec2 from_border(0, 0);
    for (const Index h : outgoing(mesh, v)) {
      const Index other = mesh.to(h);
      const double w = weight(mesh, h);
      sum += w;
      if (row[other] == k_none) {
        from_border += w * places[other];
      } else {
        result.matrix.columns.push_back(row[other]);
        result.matrix.values.push_back(-w);
      }
    }
    result.matrix.offsets.push_back(static_cast<Index>(result.matrix.columns.size()));
    result.matrix.diagonal.push_back(sum);
    result.right.push_back(from_border);
  }
  return result;
}

void place_inner_vertices(const Mesh& mesh, std::vector<Vec2>& places, const JobStage& stage) {
  const Equations equations = set_up(mesh, places);
  if (equations.vertices.empty()) return;
  std::vector<Vec3> where;
  for (const Index v : equations.vertices) where.push_back(mesh.position(v));
  stage.update(0.02);
  std::vector<Index> order = dissection_order(equations.matrix, where);
  stage.update(0.05);
  const SparseCholesky factors(equations.matrix, std::move(order), stage.part(0.05, 0.97));
  const std::vector<Vec2> solution = factors.solve(equations.right);
  for (std::size_t i = 0; i < solution.size(); ++i) places[equations.vertices[i]] = solution[i];
}

}  // namespace

std::vector<Vec2> harmonic_map(const Mesh& mesh, Job* job) {
  check_disk(mesh);
  const JobStage stage(job, "Flattening the surface");
  std::vector<Vec2> places(mesh.vertex_count());
  place_border(mesh, places);
  place_inner_vertices(mesh, places, stage);
  stage.check();
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const Triangle& t = mesh.triangles()[f];
    if (charts::turn(places[t[0]], places[t[1]], places[t[2]]) != predicates::Sign::positive)
      throw InputError(message("mesh: face ", f, " vanishes in the disk: the surface is too long or too deep for its ",
                               "border; cut it open farther or choose a flatter part of it"));
  }
  stage.update(1);
  return places;
}

}  // namespace saddleback
