// Corners of triangles are joined across every edge that is no barrier: those of a vertex that hang together are one
// vertex of the barred mesh.

#include "saddleback/mesh/barriers.h"

#include <algorithm>
#include <optional>

#include "saddleback/error.h"

#include "mesh/cutting/barrier_cuts.h"
#include "mesh/tables/edge_table.h"
#include "mesh/tables/outgoing.h"
#include "support/disjoint_sets.h"

namespace saddleback {
namespace {

// In barycentric coordinates: a point as near to a part of a face lies in it, as curves as near to each other meet.
constexpr double k_beside = 1e-9;
constexpr Index k_between_looks = 1 << 12;

/// Triangles of nodes.
struct Cut {
  std::vector<Triangle> triangles;
  std::vector<Index> face_origin;
};

Cut cut_faces(const Mesh& whole, std::span<const std::uint8_t> left_out, BarrierCuts& barriers, const JobStage& stage) {
  Cut cut;
  cut.triangles.reserve(static_cast<std::size_t>(whole.face_count()));
  for (Index f = 0; f < whole.face_count(); ++f) {
    if (f % k_between_looks == 0) stage.update(static_cast<double>(f) / whole.face_count());
    if (!left_out.empty() && left_out[f]) continue;
    if (barriers.is_cut(f))
      barriers.cut(f, cut.triangles);
    else
      cut.triangles.push_back(whole.triangles()[f]);
    cut.face_origin.resize(cut.triangles.size(), f);
  }
  return cut;
}

/// Joins corners of triangles, numbered as half-edges, across all edges but barriers.
DisjointSets join_corners(const Cut& cut, const BarrierCuts& barriers) {
  DisjointSets corners(3 * static_cast<Index>(cut.triangles.size()));
  const EdgeTable edges = build_edge_table(cut.triangles, static_cast<Index>(barriers.points().size()));
  for (Index e = 0; e < edges.edge_count(); ++e) {
    const std::span<const Index> around = edges.edge(e);
    if (around.size() != 2) continue;
    const Index h = around[0], twin = around[1];
    if (barriers.is_barrier(halfedge_from(cut.triangles, h), halfedge_to(cut.triangles, h))) continue;
    corners.join(h, Mesh::next(twin));
    corners.join(Mesh::next(h), twin);
  }
  return corners;
}

/// Numbers the sets of corners: the first of each node in the order of nodes, then all others. Gives the nodes.
std::vector<Index> number_vertices(Cut& cut, const BarrierCuts& barriers) {
  DisjointSets corners = join_corners(cut, barriers);
  const auto count = 3 * static_cast<Index>(cut.triangles.size());
  std::vector<Index> first(barriers.points().size(), k_none), number(count, k_none), copies, nodes;
  const auto node_of = [&](Index corner) { return cut.triangles[corner / 3][corner % 3]; };
  for (Index c = 0; c < count; ++c) {
    const Index root = corners.root(c);
    if (root != c) continue;
    Index& known = first[node_of(c)];
    if (known == k_none)
      known = c;
    else
      copies.push_back(c);
  }
  const auto add = [&](Index corner) {
    number[corner] = static_cast<Index>(nodes.size());
    nodes.push_back(node_of(corner));
  };
  for (const Index corner : first)
    if (corner != k_none) add(corner);
  for (const Index corner : copies) add(corner);
  for (Index c = 0; c < count; ++c) number[c] = number[corners.root(c)];
  for (Index c = 0; c < count; ++c) cut.triangles[c / 3][c % 3] = number[c];
  return nodes;
}

void check(const Mesh& whole, const Barriers& barriers) {
  const auto faces = static_cast<std::size_t>(whole.face_count());
  if (!barriers.left_out.empty() && barriers.left_out.size() != faces)
    throw InputError(message("faces: wanted one for each of ", faces, " faces, got ", barriers.left_out.size()));
  if (!barriers.left_out.empty() && std::ranges::all_of(barriers.left_out, [](auto out) { return out != 0; }))
    throw InputError(message("faces: all ", faces, " faces are left out; keep some"));
  for (std::size_t i = 0; i < barriers.curves.size(); ++i)
    if (const Mesh& mesh = barriers.curves[i]->mesh(); &mesh != &whole && mesh.fingerprint() != whole.fingerprint())
      throw InputError(message("curves: curve ", i, " lies on another mesh"));
}

/// Calls `visit(face, barycentric)` for every face of the mesh that the point lies in.
template <class Visit>
void for_each_face(const Mesh& mesh, const SurfacePoint& point, Visit&& visit) {
  visit(point.face, point.barycentric);
  const auto beyond = [&](Index face) {
    if (face == point.face) return;
    if (const std::optional<Vec3> weights = barycentric_in(mesh, point, face, k_beside)) visit(face, *weights);
  };
  for (int i = 0; i < 3; ++i) {
    const Index h = 3 * point.face + i;
    if (point.barycentric[i] >= 1 - k_beside) {
      for (const Index g : outgoing(mesh, mesh.from(h))) beyond(Mesh::face_of(g));
      return;
    }
    if (point.barycentric[(i + 2) % 3] <= k_beside && mesh.twin(h) != k_none) beyond(Mesh::face_of(mesh.twin(h)));
  }
}

}  // namespace

BarredMesh add_barriers(const Mesh& whole, const Barriers& barriers, Job* job) {
  whole.require_space("add_barriers");
  const JobStage stage(job, "parting the surface along barriers");
  check(whole, barriers);
  BarrierCuts cuts(whole, barriers.edges, barriers.curves, stage.part(0, 0.1));
  stage.update(0.1);
  Cut cut = cut_faces(whole, barriers.left_out, cuts, stage.part(0.1, 0.3));
  const std::vector<Index> nodes = number_vertices(cut, cuts);
  stage.update(0.7);
  BarredMesh barred;
  std::vector<double> xyz;
  xyz.reserve(3 * nodes.size());
  for (const Index node : nodes) {
    const SurfacePoint& point = cuts.points()[node];
    const Index vertex = node < whole.vertex_count() ? node : k_none;
    barred.vertex_points.push_back(point);
    barred.vertex_origin.push_back(vertex);
    const Vec3 place = vertex == k_none ? position(whole, point) : whole.position(vertex);
    xyz.insert(xyz.end(), place.begin(), place.end());
  }
  barred.face_origin = std::move(cut.face_origin);
  const std::span indices(cut.triangles.front().data(), 3 * cut.triangles.size());
  barred.mesh = std::make_shared<Mesh>(xyz, indices, stage.part(0.7, 1.0));
  return barred;
}

PointsOnBarred points_on_barred(const Mesh& whole, const BarredMesh& barred, const SurfacePoints& points,
                                const char* argument) {
  check_surface_points(whole, points, argument);
  PointsOnBarred found;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t before = found.points.size();
    const auto add = [&](Index face, const Vec3& barycentric) {
      const SurfacePoint point{face, normalized_barycentric(barycentric)};
      for (std::size_t k = before; k < found.points.size(); ++k)
        if (barycentric_in(*barred.mesh, found.points[k], face, k_beside)) return;
      found.points.push_back(point);
      found.index.push_back(static_cast<Index>(i));
    };
    for_each_face(whole, points[i], [&](Index face, const Vec3& barycentric) {
      const auto [first, last] = std::ranges::equal_range(barred.face_origin, face);
      for (auto part = first; part != last; ++part) {
        const auto t = static_cast<Index>(part - barred.face_origin.begin());
        Eigen::Matrix3d corners;
        for (int k = 0; k < 3; ++k)
          corners.col(k) = *barycentric_in(whole, barred.vertex_points[barred.mesh->triangles()[t][k]], face);
        const Vec3 within = last - first == 1 ? barycentric : Vec3(corners.inverse() * barycentric);
        if (within.minCoeff() >= -k_beside) add(t, within);
      }
    });
    if (found.points.size() == before)
      throw InputError(message(argument, ": point ", i, " lies in face ", points[i].face, ", which is left out"));
  }
  return found;
}

SurfacePoints points_on_whole(const Mesh& whole, const BarredMesh& barred, const SurfacePoints& points,
                              const char* argument) {
  check_surface_points(*barred.mesh, points, argument);
  SurfacePoints found;
  found.reserve(points.size());
  for (const SurfacePoint& point : points) {
    const Index face = barred.face_origin[point.face];
    Vec3 barycentric = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      const SurfacePoint& corner = barred.vertex_points[barred.mesh->triangles()[point.face][k]];
      barycentric += point.barycentric[k] * *barycentric_in(whole, corner, face);
    }
    found.push_back({face, barycentric});
  }
  return found;
}

std::vector<double> values_on_barred(const Mesh& whole, const BarredMesh& barred, std::span<const double> values) {
  if (values.size() != static_cast<std::size_t>(whole.vertex_count()))
    throw InputError(
        message("values: wanted one for each of ", whole.vertex_count(), " vertices, got ", values.size()));
  std::vector<double> found;
  found.reserve(barred.vertex_points.size());
  for (const SurfacePoint& point : barred.vertex_points) {
    double value = 0;
    for (int k = 0; k < 3; ++k)  // a corner that does not count may be infinite
      if (point.barycentric[k] != 0) value += point.barycentric[k] * values[whole.from(3 * point.face + k)];
    found.push_back(value);
  }
  return found;
}

std::vector<Index> least_copies(const Mesh& whole, const BarredMesh& barred, std::span<const double> values) {
  const std::vector<Index>& origin = barred.vertex_origin;
  if (values.size() != origin.size())
    throw InputError(message("values: wanted one for each of ", origin.size(), " vertices, got ", values.size()));
  std::vector<Index> least(whole.vertex_count(), k_none);
  for (std::size_t v = 0; v < origin.size(); ++v) {
    if (origin[v] == k_none) continue;
    Index& best = least[origin[v]];
    if (best == k_none || values[v] < values[best]) best = static_cast<Index>(v);
  }
  return least;
}

}  // namespace saddleback
