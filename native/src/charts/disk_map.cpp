#include "saddleback/disk_map.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "saddleback/error.h"

#include "charts/turn.h"

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

/// Of the edge of a half-edge, from the angles opposite to it.
double weight(const Mesh& mesh, Index h) {
  double sum = cotangent(mesh.corner_angle(Mesh::prev(h)));
  if (mesh.twin(h) != k_none) sum += cotangent(mesh.corner_angle(Mesh::prev(mesh.twin(h))));
  return std::max(sum, k_least_weight);
}

void place_border(const Mesh& mesh, std::vector<Vec2>& places) {
  const std::vector<Index>& loop = mesh.boundary_loops()[0];
  std::vector<double> until{0};
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Index next = loop[(i + 1) % loop.size()];
    until.push_back(until.back() + (mesh.position(next) - mesh.position(loop[i])).norm());
  }
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const double angle = 2 * M_PI * until[i] / until.back();
    places[loop[i]] = {std::cos(angle), std::sin(angle)};
  }
}

void place_inner_vertices(const Mesh& mesh, std::vector<Vec2>& places, const JobStage& stage) {
  std::vector<Index> row(mesh.vertex_count(), k_none);
  Index count = 0;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (!mesh.is_boundary(v)) row[v] = count++;
  if (count == 0) return;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(count, 2);
  for (const Index h : mesh.edge_halfedges()) {
    const Index a = mesh.from(h), b = mesh.to(h);
    const double w = weight(mesh, h);
    for (const auto& [v, other] : {std::pair(a, b), std::pair(b, a)}) {
      if (row[v] == k_none) continue;
      entries.emplace_back(row[v], row[v], w);
      if (row[other] == k_none) {
        right.row(row[v]) += w * places[other];
      } else if (row[other] < row[v]) {
        entries.emplace_back(row[v], row[other], -w);
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  stage.update(0.1);
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
  solver.analyzePattern(matrix);
  stage.update(0.4);
  solver.factorize(matrix);
  stage.update(0.9);
  const Eigen::MatrixX2d solution = solver.solve(right);
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (row[v] != k_none) places[v] = solution.row(row[v]);
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
