// Builds the flat half-edge structure: copy, check, twins from the edge table, then what follows from them. Each step
// relies on what the checks before it proved, so nothing here can meet a broken mesh.
#include "saddleback/mesh/mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>

#include "mesh/tables/edge_table.h"
#include "mesh/tables/face_shape.h"
#include "mesh/tables/offenders.h"
#include "mesh/tables/validate.h"
#include "support/disjoint_sets.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

// The corner angles' rounding errors add up to well below this share of 2 pi, so that a flat or developable vertex is
// not taken for a saddle; a true saddle sharper than flat by less than that bends no path measurably.
constexpr double k_saddle_tolerance = 1e-10;

std::vector<Vec3> copy_positions(std::span<const double> xyz) {
  if (xyz.size() % 3 != 0) throw MeshError(message("vertices: ", xyz.size(), " coordinates are not a multiple of 3"));
  std::vector<Vec3> positions(xyz.size() / 3);
  for (std::size_t v = 0; v < positions.size(); ++v) positions[v] = Vec3(xyz[3 * v], xyz[3 * v + 1], xyz[3 * v + 2]);
  return positions;
}

std::vector<Triangle> copy_triangles(std::span<const Index> indices) {
  if (indices.size() % 3 != 0)
    throw MeshError(message("triangles: ", indices.size(), " indices are not a multiple of 3"));
  std::vector<Triangle> triangles(indices.size() / 3);
  if (!indices.empty()) std::memcpy(triangles.data(), indices.data(), indices.size_bytes());
  return triangles;
}

std::vector<Index> twins_of(const EdgeTable& edges) {
  std::vector<Index> twins(edges.halfedges.size(), k_none);
  for (Index e = 0; e < edges.edge_count(); ++e) {
    const std::span<const Index> around = edges.edge(e);
    if (around.size() != 2) continue;
    twins[around[0]] = around[1];
    twins[around[1]] = around[0];
  }
  return twins;
}

std::uint64_t mix(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) * 0x9e3779b97f4a7c15u;
  return hash ^ (hash >> 29);
}

std::uint64_t hash_mesh(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  std::uint64_t hash = mix(positions.size(), triangles.size());
  for (const Vec3& p : positions)
    for (int i = 0; i < 3; ++i) hash = mix(hash, std::bit_cast<std::uint64_t>(p[i] + 0.0));  // -0 and 0 are one place
  for (const Triangle& t : triangles)
    for (const Index v : t) hash = mix(hash, static_cast<std::uint32_t>(v));
  return hash;
}

}  // namespace

Mesh::Mesh(std::span<const double> xyz, std::span<const Index> triangles, Job* job)
    : Mesh(xyz, triangles, JobStage(job, "Checking the mesh")) {}

Mesh::Mesh(std::span<const double> xyz, std::span<const Index> triangles, const JobStage& stage)
    : positions_(copy_positions(xyz)), triangles_(copy_triangles(triangles)) {
  stage.check();
  check_faces(positions_, triangles_);
  stage.update(0.15);
  {
    const EdgeTable edges = build_edge_table(triangles_, vertex_count());
    check_edges(triangles_, edges);
    stage.update(0.4);
    edge_count_ = edges.edge_count();
    twins_ = twins_of(edges);
  }
  order_vertices();
  stage.update(0.5);
  measure();
  stage.update(0.8);
  find_components();
  find_boundary_loops();
  const Index euler = vertex_count() - edge_count_ + face_count();
  genus_ = component_count_ - (euler + static_cast<Index>(boundary_loops_.size())) / 2;
  fingerprint_ = hash_mesh(positions_, triangles_);
  stage.update(1.0);
}

// One half-edge a vertex, the clockwise-most on a boundary; a vertex whose half-edges are not all met by rotating from
// it joins several fans and is refused.
void Mesh::order_vertices() {
  first_halfedges_.assign(vertex_count(), k_none);
  boundary_.assign(vertex_count(), 0);
  std::vector<Index> degrees(vertex_count(), 0);
  for (Index h = 0; h < halfedge_count(); ++h) {
    const Index v = from(h);
    ++degrees[v];
    if (first_halfedges_[v] == k_none || twins_[h] == k_none) first_halfedges_[v] = h;
    if (twins_[h] == k_none) boundary_[v] = boundary_[to(h)] = 1;
  }
  Offenders bow_ties;
  for (Index v = 0; v < vertex_count(); ++v) {
    Index met = 0, h = first_halfedges_[v];
    do {
      ++met;
      h = rotate(h);
    } while (h != k_none && h != first_halfedges_[v]);
    if (met != degrees[v])
      bow_ties.add([&] { return message("vertex ", v, " joins ", degrees[v], " faces that are not one fan"); });
  }
  bow_ties.throw_if_any("non-manifold vertex", "non-manifold vertices", "saddleback.repair mends this");
}

void Mesh::measure() {
  constexpr Index k_chunk = 4096;  // faces a thread takes at once
  lengths_.resize(halfedge_count());
  corner_angles_.resize(halfedge_count());
  face_areas_.resize(face_count());
  parallel_for(face_count(), 0, k_chunk, [&](Index f, int) {
    const Triangle& t = triangles_[f];
    const FaceShape shape = measure_face(positions_[t[0]], positions_[t[1]], positions_[t[2]]);
    face_areas_[f] = shape.area;
    std::copy(shape.length.begin(), shape.length.end(), lengths_.begin() + 3 * f);
    std::copy(shape.angle.begin(), shape.angle.end(), corner_angles_.begin() + 3 * f);
  });
  // Sums go in the order of the faces, whatever the number of threads.
  total_angles_.assign(vertex_count(), 0.0);
  double length_sum = 0;
  for (Index h = 0; h < halfedge_count(); ++h) {
    total_angles_[from(h)] += corner_angles_[h];
    if (twins_[h] < h) length_sum += lengths_[h];  // once an edge; the boundary's twin is -1
  }
  mean_edge_length_ = length_sum / edge_count_;
  area_ = std::accumulate(face_areas_.begin(), face_areas_.end(), 0.0);
  saddle_.resize(vertex_count());
  constexpr double k_flat = 2 * std::numbers::pi * (1 + k_saddle_tolerance);
  for (Index v = 0; v < vertex_count(); ++v) saddle_[v] = boundary_[v] || total_angles_[v] > k_flat;
}

void Mesh::find_components() {
  DisjointSets sets(vertex_count());
  for (const Triangle& t : triangles_)
    for (int i = 1; i < 3; ++i) sets.join(t[0], t[i]);
  components_.resize(vertex_count());
  for (Index v = 0; v < vertex_count(); ++v) {
    const Index root = sets.root(v);  // not above v: components are numbered by their first vertices
    components_[v] = root == v ? component_count_++ : components_[root];
  }
}

void Mesh::find_boundary_loops() {
  std::vector<std::uint8_t> visited(vertex_count(), 0);
  for (Index v = 0; v < vertex_count(); ++v) {
    if (!boundary_[v] || visited[v]) continue;
    std::vector<Index>& loop = boundary_loops_.emplace_back();
    // The first half-edge out of a boundary vertex is the boundary's own, and a manifold vertex has only one.
    for (Index at = v; !visited[at]; at = to(first_halfedges_[at])) {
      visited[at] = 1;
      loop.push_back(at);
    }
  }
}

std::vector<Index> Mesh::saddle_vertices() const {
  std::vector<Index> result;
  for (Index v = 0; v < vertex_count(); ++v)
    if (is_saddle(v)) result.push_back(v);
  return result;
}

std::vector<Index> Mesh::boundary_vertices() const {
  std::vector<Index> result;
  for (Index v = 0; v < vertex_count(); ++v)
    if (is_boundary(v)) result.push_back(v);
  return result;
}

std::vector<Index> Mesh::edge_halfedges() const {
  std::vector<Index> result;
  result.reserve(edge_count_);
  for (Index h = 0; h < halfedge_count(); ++h)
    if (twins_[h] == k_none || h < twins_[h]) result.push_back(h);
  return result;
}

}  // namespace saddleback
