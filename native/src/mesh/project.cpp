// Nearest points on a mesh.
//
// The hierarchy halves the faces along a Hilbert curve, so it is built by one sort and one sweep; its boxes are float32,
// relative to the mesh's centre and widened beyond every rounding, so that no box is ever passed over that holds a nearest
// point. Queries go through it in Hilbert order too, each starting from the face that the one before it found.
//
// Of equally near points the one in the smallest face wins. Since a point on an edge or vertex is computed with different
// rounding in each of its faces, such a point is first moved exactly onto the edge or vertex, then to its smallest face.

#include "saddleback/project.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "../support/parallel.h"
#include "flat_face.h"
#include "hilbert.h"
#include "saddleback/error.h"

namespace saddleback {
namespace {

constexpr Index k_leaf_size = 4;
constexpr Index k_chunk = 1024;  ///< queries between two looks at the job

/// Beyond this a query's squared distance would overflow; it is pulled in along its line from the origin, which changes
/// nothing that double coordinates could tell (meshes end at 1e60).
constexpr double k_farthest_query = 1e100;

struct Nearest {
  double squared_distance = std::numeric_limits<double>::infinity();
  Index face = k_none;
  Vec3 barycentric = Vec3::Zero();
};

/// Nearest point of the segment from a to a + ab to the origin, as a share of ab.
double nearest_on_segment(const Vec3& a, const Vec3& ab) { return std::clamp(-a.dot(ab) / ab.squaredNorm(), 0.0, 1.0); }

/// Lowers `best` to the nearest point of the face when that is nearer, or as near in a smaller face.
void consider(const Mesh& mesh, Index face, const Vec3& query, Nearest& best) {
  const Triangle& t = mesh.triangles()[face];
  const std::array<Vec3, 3> p{mesh.position(t[0]) - query, mesh.position(t[1]) - query, mesh.position(t[2]) - query};
  const auto offer = [&](const Vec3& b, const Vec3& at) {
    const double squared = at.squaredNorm();
    if (squared < best.squared_distance || (squared == best.squared_distance && face < best.face))
      best = {squared, face, b};
  };
  // Twice the signed areas of the three triangles that the query's foot makes with the edges, times that of the face.
  const Vec3 ab = p[1] - p[0], ac = p[2] - p[0], normal = ab.cross(ac);
  const double whole = normal.squaredNorm();
  const double second = normal.dot(p[0].cross(ac)) * -1, third = normal.dot(ab.cross(p[0])) * -1;
  const Vec3 share(whole - second - third, second, third);
  // A point outside is nearest to one of the edges that it sees. Signs within rounding count as seen: then both the inside
  // and the edge are tried, and the nearer wins.
  const double rounding = 1e-9 * whole;
  if (share.minCoeff() > -rounding) {
    const Vec3 b = normalised_barycentric(share);
    offer(b, b[0] * p[0] + b[1] * p[1] + b[2] * p[2]);
  }
  for (int i = 0; i < 3; ++i) {
    if (share[i] > rounding) continue;
    const int from = (i + 1) % 3, to = (i + 2) % 3;
    const Vec3 edge = p[to] - p[from];
    const double s = nearest_on_segment(p[from], edge);
    Vec3 b = Vec3::Zero();
    b[from] = 1 - s;
    b[to] = s;
    offer(b, s == 1 ? p[to] : Vec3(p[from] + s * edge));
  }
}

/// The same point in the smallest of its faces, exactly on the edge or vertex that it is on within rounding.
SurfacePoint settled(const Mesh& mesh, Index face, const Vec3& barycentric) {
  const FlatFace flat(mesh.position(mesh.triangles()[face][0]), mesh.position(mesh.triangles()[face][1]),
                      mesh.position(mesh.triangles()[face][2]));
  SurfacePoint point{face, snapped(flat, barycentric)};
  if (const Index vertex = vertex_at(mesh, point); vertex != k_none) {
    const Index first = mesh.first_halfedge(vertex);
    Index smallest = first, h = first;
    do {
      if (h < smallest) smallest = h;
      h = mesh.rotate(h);
    } while (h != k_none && h != first);
    return {Mesh::face_of(smallest), Vec3::Unit(smallest % 3)};
  }
  for (int i = 0; i < 3; ++i) {
    if (point.barycentric[i] != 0) continue;
    const Index h = 3 * face + (i + 1) % 3, twin = mesh.twin(h);  // the edge opposite corner i
    if (twin == k_none || twin > h) return point;
    SurfacePoint other{Mesh::face_of(twin), Vec3::Zero()};
    other.barycentric[twin % 3] = point.barycentric[(i + 2) % 3];
    other.barycentric[(twin + 1) % 3] = point.barycentric[(i + 1) % 3];
    return other;
  }
  return point;
}

Vec3 pulled_in(const Vec3& query) {
  const double largest = query.cwiseAbs().maxCoeff();
  return largest > k_farthest_query ? Vec3(query * (k_farthest_query / largest)) : query;
}

}  // namespace

NearestSurface::NearestSurface(const Mesh& mesh, const JobStage& stage) : mesh_(mesh) {
  Vec3 low = mesh.position(0), high = low;
  for (const Vec3& p : mesh.positions()) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  centre_ = 0.5 * (low + high);
  // Float32 rounds to 6e-8 of a coordinate, double to 1e-16 of the largest one: four times both.
  const double largest = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  slack_ = 2.5e-7 * (high - low).maxCoeff() + 1e-15 * largest;

  const HilbertCurve curve(mesh.positions());
  std::vector<std::uint64_t> keys(static_cast<std::size_t>(mesh.face_count()));
  for (Index f = 0; f < mesh.face_count(); ++f) keys[f] = curve.key(position(mesh, {f, Vec3::Constant(1.0 / 3)}));
  stage.check();
  faces_ = order_of(keys);
  nodes_.reserve(faces_.size());
  build(0, mesh.face_count(), stage);
}

Index NearestSurface::build(Index begin, Index end, const JobStage& stage) {
  const Index index = static_cast<Index>(nodes_.size());
  nodes_.emplace_back();
  if (end - begin > k_leaf_size) {
    if (end - begin > 10000) stage.check();
    const Index middle = begin + (end - begin) / 2;
    build(begin, middle, stage);
    const Index second = build(middle, end, stage);
    Node& node = nodes_[index];
    const Node &a = nodes_[index + 1], &b = nodes_[second];
    for (int i = 0; i < 3; ++i) {
      node.low[i] = std::min(a.low[i], b.low[i]);
      node.high[i] = std::max(a.high[i], b.high[i]);
    }
    node.first = second;
    node.count = 0;
    return index;
  }
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (Index i = begin; i < end; ++i)
    for (const Index v : mesh_.triangles()[faces_[i]]) {
      low = low.cwiseMin(mesh_.position(v) - centre_);
      high = high.cwiseMax(mesh_.position(v) - centre_);
    }
  Node& node = nodes_[index];
  for (int i = 0; i < 3; ++i) {
    node.low[i] = static_cast<float>(low[i] - slack_);
    node.high[i] = static_cast<float>(high[i] + slack_);
  }
  node.first = begin;
  node.count = end - begin;
  return index;
}

/// From a point (relative to the centre) to the box, never too large.
double NearestSurface::squared_distance(const Node& node, const Vec3& local) const {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const double outside = std::max({node.low[i] - local[i], 0.0, local[i] - node.high[i]});
    sum += outside * outside;
  }
  constexpr double k_rounding = 1e-14;  // of the few operations here
  return sum * (1 - k_rounding);
}

SurfacePoint NearestSurface::nearest(const Vec3& wanted, Index hint) const {
  const Vec3 query = pulled_in(wanted), local = query - centre_;
  Nearest best;
  if (hint != k_none) consider(mesh_, hint, query, best);
  struct Pending {
    Index node;
    double squared_distance;
  };
  std::array<Pending, 64> pending;  // halving 2^31 faces nests 32 deep
  int waiting = 0;
  pending[waiting++] = {0, squared_distance(nodes_[0], local)};
  while (waiting > 0) {
    auto [index, squared] = pending[--waiting];
    while (squared <= best.squared_distance && nodes_[index].count == 0) {
      Index near = index + 1, far = nodes_[index].first;
      double near_squared = squared_distance(nodes_[near], local), far_squared = squared_distance(nodes_[far], local);
      if (far_squared < near_squared) std::swap(near, far), std::swap(near_squared, far_squared);
      pending[waiting++] = {far, far_squared};
      index = near, squared = near_squared;
    }
    if (squared > best.squared_distance) continue;
    const Node& leaf = nodes_[index];
    for (Index i = leaf.first; i < leaf.first + leaf.count; ++i) consider(mesh_, faces_[i], query, best);
  }
  return settled(mesh_, best.face, best.barycentric);
}

SurfacePoints project(const Mesh& mesh, std::span<const double> xyz, const ProjectOptions& options) {
  for (std::size_t i = 0; i < xyz.size(); ++i)
    if (!std::isfinite(xyz[i]))
      throw InputError(message("xyz: value ", xyz[i], " at [", i / 3, ", ", i % 3, "] is not finite"));
  const JobStage stage(options.job, "projecting");
  const NearestSurface surface(mesh, stage);
  const Index count = static_cast<Index>(xyz.size() / 3);
  const auto query = [&](Index i) { return Vec3(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]); };

  const HilbertCurve curve(mesh.positions());
  std::vector<std::uint64_t> keys(static_cast<std::size_t>(count));
  for (Index i = 0; i < count; ++i) keys[i] = curve.key(query(i));
  const std::vector<Index> order = order_of(keys);

  SurfacePoints result(static_cast<std::size_t>(count));
  const Index chunks = (count + k_chunk - 1) / k_chunk;
  std::atomic<Index> done{0};
  parallel_for(chunks, options.threads, 1, [&](Index chunk, int) {
    const Index end = std::min(count, (chunk + 1) * k_chunk);
    Index last = k_none;
    for (Index k = chunk * k_chunk; k < end; ++k) {
      const Index i = order[k];
      result[i] = surface.nearest(query(i), last);
      last = result[i].face;
    }
    stage.update(static_cast<double>(++done) / chunks);
  });
  return result;
}

}  // namespace saddleback
