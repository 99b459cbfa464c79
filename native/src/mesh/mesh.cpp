// Builds the flat half-edge structure: copy, check, twins from the edge table, then what follows from them. Each step
// relies on what the checks before it proved, so nothing here can meet a broken mesh.
#include "saddleback/mesh/mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <numeric>

#include "mesh/tables/edge_table.h"
#include "mesh/tables/face_shape.h"
#include "mesh/tables/offenders.h"
#include "mesh/tables/validate.h"
#include "support/disjoint_sets.h"
#include "support/hypotenuse.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

// The corner angles' rounding errors add up to well below this share of 2 pi, so that a flat or developable vertex is
// not taken for a saddle; a true saddle sharper than flat by less than that bends no path measurably.
constexpr double k_saddle_tolerance = 1e-10;

/// Copies the first three coordinates, zero where there are only two.
std::vector<Vec3> copy_positions(std::span<const double> xyz, std::size_t dimension) {
  if (dimension < 2) throw InputError(message("dimension: wanted 2 or more, got ", dimension));
  if (xyz.size() % dimension != 0)
    throw MeshError(message("vertices: ", xyz.size(), " coordinates are not a multiple of ", dimension));
  std::vector<Vec3> positions(xyz.size() / dimension);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const double* const p = xyz.data() + dimension * v;
    positions[v] = Vec3(p[0], p[1], dimension > 2 ? p[2] : 0);
  }
  return positions;
}

std::vector<Triangle> copy_triangles(std::span<const Index> indices) {
  if (indices.size() % 3 != 0)
    throw MeshError(message("triangles: ", indices.size(), " indices are not a multiple of 3"));
  std::vector<Triangle> triangles(indices.size() / 3);
  if (!indices.empty()) std::memcpy(triangles.data(), indices.data(), indices.size_bytes());
  return triangles;
}

std::uint64_t mix(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) * 0x9e3779b97f4a7c15u;
  return hash ^ (hash >> 29);
}

/// Lengths count where they are not those of the positions.
std::uint64_t hash_mesh(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                        std::span<const double> lengths) {
  std::uint64_t hash = mix(positions.size(), triangles.size());
  for (const Vec3& p : positions)
    for (int i = 0; i < 3; ++i) hash = mix(hash, std::bit_cast<std::uint64_t>(p[i] + 0.0));  // -0 and 0 are one place
  for (const Triangle& t : triangles)
    for (const Index v : t) hash = mix(hash, static_cast<std::uint32_t>(v));
  for (const double length : lengths) hash = mix(hash, std::bit_cast<std::uint64_t>(length));
  return hash;
}

}  // namespace

Mesh::Mesh(std::span<const double> xyz, std::span<const Index> triangles, Job* job)
    : Mesh(xyz, triangles, JobStage(job, "Checking the mesh")) {}

Mesh::Mesh(std::span<const double> xyz, std::span<const Index> triangles, const JobStage& stage)
    : Mesh(xyz, triangles, MeshMetric{}, stage) {}

Mesh::Mesh(std::span<const double> coordinates, std::span<const Index> triangles, const MeshMetric& metric, Job* job)
    : Mesh(coordinates, triangles, metric, JobStage(job, "Checking the mesh")) {}

Mesh::Mesh(std::span<const double> coordinates, std::span<const Index> triangles, const MeshMetric& metric,
           const JobStage& stage)
    : positions_(copy_positions(coordinates, static_cast<std::size_t>(metric.dimension))),
      triangles_(copy_triangles(triangles)),
      is_intrinsic_(metric.dimension > 3 || metric.lengths) {
  stage.check();
  check_faces(coordinates, metric.dimension, triangles_);
  stage.check();
  if (!is_intrinsic_) check_areas(positions_, triangles_);
  stage.update(0.15);
  {
    const EdgeTable edges = build_edge_table(triangles_, vertex_count());
    stage.check();
    check_edges(triangles_, edges);
    stage.update(0.4);
    edge_count_ = edges.edge_count();
    twins_ = twins_of(edges);
  }
  stage.check();
  order_vertices(stage);
  if (is_intrinsic_) take_lengths(coordinates, metric);
  stage.update(0.5);
  measure(stage);
  if (is_intrinsic_) measure_bird();
  stage.update(0.8);
  find_components();
  stage.check();
  find_boundary_loops();
  const Index euler = vertex_count() - edge_count_ + face_count();
  genus_ = component_count_ - (euler + static_cast<Index>(boundary_loops_.size())) / 2;
  fingerprint_ = hash_mesh(positions_, triangles_, is_intrinsic_ ? lengths_ : std::span<const double>());
  stage.update(1.0);
}

// One half-edge a vertex, the clockwise-most on a boundary; a vertex whose half-edges are not all met by rotating from
// it joins several fans and is refused.
void Mesh::order_vertices(const JobStage& stage) {
  constexpr Index k_at_a_time = 1 << 16;  // half-edges or vertices between two looks whether to stop
  first_halfedges_.assign(vertex_count(), k_none);
  boundary_.assign(vertex_count(), 0);
  std::vector<Index> degrees(vertex_count(), 0);
  for (Index h = 0; h < halfedge_count(); ++h) {
    if (h % k_at_a_time == 0) stage.check();
    const Index v = from(h);
    ++degrees[v];
    if (first_halfedges_[v] == k_none || twins_[h] == k_none) first_halfedges_[v] = h;
    if (twins_[h] == k_none) boundary_[v] = boundary_[to(h)] = 1;
  }
  Offenders bow_ties;
  for (Index v = 0; v < vertex_count(); ++v) {
    if (v % k_at_a_time == 0) stage.check();
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

/// Three lengths a face, of coordinates or given; the half-edge that speaks for an edge speaks for both of its sides.
void Mesh::take_lengths(std::span<const double> coordinates, const MeshMetric& metric) {
  const auto edge_count = static_cast<std::size_t>(edge_count_), side_count = 3 * triangles_.size();
  lengths_.resize(side_count);
  const std::span<const double> given = metric.lengths.value_or(std::span<const double>());
  if (!metric.lengths) {
    using Place = Eigen::Map<const Eigen::VectorXd>;
    const Eigen::Index d = metric.dimension;
    for (Index h = 0; h < halfedge_count(); ++h)
      lengths_[h] = (Place(&coordinates[d * to(h)], d) - Place(&coordinates[d * from(h)], d)).norm();
  } else if (given.size() == side_count) {
    lengths_.assign(given.begin(), given.end());
  } else if (given.size() == edge_count) {
    std::size_t edge = 0;
    for (Index h = 0; h < halfedge_count(); ++h) lengths_[h] = is_second_side(h) ? lengths_[twins_[h]] : given[edge++];
  } else {
    throw InputError(message("lengths: wanted one for each of the ", edge_count, " edges or of the ", side_count,
                             " sides of the faces, got ", given.size()));
  }
  check_lengths(lengths_, triangles_, twins_);
  for (Index h = 0; h < halfedge_count(); ++h)
    if (is_second_side(h)) lengths_[h] = lengths_[twins_[h]];
}

void Mesh::require_space(const char* call) const {
  if (!is_intrinsic_) return;
  throw InputError(message(call, " needs the shape in space, but the mesh has lengths of its own, which its positions ",
                           "do not show; ask a mesh made without them"));
}

std::array<Vec3, 3> Mesh::laid_flat(Index h) const {
  const Index f = face_of(h);
  const double base = lengths_[3 * f], side = lengths_[3 * f + 2], twice = 2 * face_areas_[f];
  const double along = side * std::cos(corner_angles_[3 * f]);
  const std::array<Vec3, 3> corner{Vec3(0, 0, 0), Vec3(base, 0, 0), Vec3(along, twice / base, 0)};
  return {corner[h % 3], corner[(h + 1) % 3], corner[(h + 2) % 3]};
}

/// Finds the bound of all faces, which holds between any two places: one over the largest
/// singular value of the map from the face laid flat to space.
void Mesh::measure_bird() {
  constexpr double k_rounding = 1 - 1e-9;
  double most = 0;  // squared
  for (Index f = 0; f < face_count(); ++f) {
    const Triangle& t = triangles_[f];
    const std::array<Vec3, 3> flat = laid_flat(3 * f);
    const Vec3 x = (positions_[t[1]] - positions_[t[0]]) / flat[1].x();
    const Vec3 y = (positions_[t[2]] - positions_[t[0]] - flat[2].x() * x) / flat[2].y();
    const double xx = x.squaredNorm(), yy = y.squaredNorm(), xy = x.dot(y);
    most = std::max(most, 0.5 * (xx + yy) + hypotenuse(0.5 * (xx - yy), xy));
  }
  bird_ =
      most > 0 ? k_rounding / std::sqrt(most) : std::numeric_limits<double>::min();  // all in one place: nothing told
}

void Mesh::measure(const JobStage& stage) {
  constexpr Index k_chunk = 4096;  // faces a thread takes at once
  lengths_.resize(halfedge_count());
  corner_angles_.resize(halfedge_count());
  face_areas_.resize(face_count());
  parallel_for(face_count(), 0, k_chunk, [&](Index f, int) {
    if (f % k_chunk == 0) stage.check();
    const Triangle& t = triangles_[f];
    const FaceShape shape = is_intrinsic_ ? measure_face(std::span<const double, 3>(&lengths_[3 * f], 3))
                                          : measure_face(positions_[t[0]], positions_[t[1]], positions_[t[2]]);
    face_areas_[f] = shape.area;
    std::copy(shape.length.begin(), shape.length.end(), lengths_.begin() + 3 * f);
    std::copy(shape.angle.begin(), shape.angle.end(), corner_angles_.begin() + 3 * f);
  });
  stage.check();
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
