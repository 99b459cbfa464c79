// Nearest points on a mesh.
//
// The hierarchy halves the faces at the median of their centers along the longest side; its boxes are float32, relative
// to the mesh's center and widened beyond every rounding, so that no box is ever passed over that holds a nearest
// point. Queries go through it in the order of a Hilbert curve, each starting from the face that the one before it
// found.
//
// Of equally near points the one in the smallest face wins. Since a point on an edge or vertex is computed with
// different rounding in each of its faces, such a point is first moved exactly onto the edge or vertex, then to its
// smallest face.

#include "saddleback/mesh/project.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "saddleback/error.h"

#include "mesh/tables/flat_face.h"
#include "mesh/tables/hilbert.h"
#include "mesh/tables/outgoing.h"
#include "support/key_order.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

constexpr Index k_leaf_size = 4;
constexpr Index k_chunk = 1024;  ///< queries

/// Bounds queries, whose squared distance beyond would overflow; it is pulled in along its line from the origin, which
/// changes nothing that double coordinates could tell (meshes end at 1e60).
constexpr double k_farthest_query = 1e100;

struct Nearest {
  double squared_distance = std::numeric_limits<double>::infinity();
  Index face = k_none;
  Vec3 barycentric = Vec3::Zero();
};

/// Lowers `best` to the nearest point of the face when that is nearer, or as near in a smaller face.
void consider(const Mesh& mesh, Index face, const Vec3& query, Nearest& best) {
  const Triangle& t = mesh.triangles()[face];
  const std::array<Vec3, 3> corner{mesh.position(t[0]), mesh.position(t[1]), mesh.position(t[2])};
  // Edges before the query comes in: it may be so far away that all corners would look the same.
  const std::array<Vec3, 3> edge{corner[1] - corner[0], corner[2] - corner[1], corner[0] - corner[2]};
  const Vec3 from_query = corner[0] - query;
  const auto offer = [&](const Vec3& b) {
    const double squared = (from_query + b[1] * edge[0] - b[2] * edge[2]).squaredNorm();
    if (squared < best.squared_distance || (squared == best.squared_distance && face < best.face))
      best = {squared, face, b};
  };
  // Barycentric coordinates of the query's foot, times the square of twice the face's area.
  const Vec3 normal = edge[2].cross(edge[0]);
  const double whole = normal.squaredNorm();
  const double second = normal.dot(edge[2].cross(from_query)) * -1, third = normal.dot(edge[0].cross(from_query)) * -1;
  const Vec3 share(whole - second - third, second, third);
  // A point outside is nearest to one of the edges that it sees. Signs within rounding count as seen: then both the
  // inside and the edge are tried, and the nearer wins.
  const double rounding = 1e-9 * whole;
  if (share.minCoeff() > -rounding) offer(normalized_barycentric(share));
  for (int i = 0; i < 3; ++i) {
    if (share[i] > rounding) continue;
    const int from = (i + 1) % 3, to = (i + 2) % 3;
    const double along = (query - corner[from]).dot(edge[from]) / edge[from].squaredNorm();
    Vec3 b = Vec3::Zero();
    b[to] = std::clamp(along, 0.0, 1.0);
    b[from] = 1 - b[to];
    offer(b);
  }
}

/// Returns the same point in the smallest of its faces, exactly on the edge or vertex that it is on within rounding.
SurfacePoint settled(const Mesh& mesh, Index face, const Vec3& barycentric) {
  const FlatFace flat(mesh.position(mesh.triangles()[face][0]), mesh.position(mesh.triangles()[face][1]),
                      mesh.position(mesh.triangles()[face][2]));
  SurfacePoint point{face, snapped(flat, barycentric)};
  if (const Index vertex = vertex_at(mesh, point); vertex != k_none) {
    Index smallest = mesh.first_halfedge(vertex);
    for (const Index h : outgoing(mesh, vertex)) smallest = std::min(smallest, h);
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

SurfacePoint nearest_on_face(const Mesh& mesh, Index face, const Vec3& query) {
  Nearest best;
  consider(mesh, face, query, best);
  return {face, best.barycentric};
}

Vec3 NearestSurface::to_box_units(const Vec3& point) const { return (point - center_) / unit_; }

NearestSurface::NearestSurface(const Mesh& mesh, const JobStage& stage) : mesh_(mesh) {
  Vec3 low = mesh.position(0), high = low;
  for (const Vec3& p : mesh.positions()) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  center_ = 0.5 * (low + high);
  unit_ = (high - low).maxCoeff();
  // Float32 rounds to 6e-8 of a coordinate, double to 1e-16 of the largest one: four times both and more.
  const double largest = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  slack_ = 2.5e-7 + 1e-15 * largest / unit_;

  std::vector<Item> items(static_cast<std::size_t>(mesh.face_count()));
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const Vec3 center = to_box_units(position(mesh, {f, Vec3::Constant(1.0 / 3)}));
    items[f] = {{static_cast<float>(center.x()), static_cast<float>(center.y()), static_cast<float>(center.z())}, f};
  }
  stage.check();
  faces_.resize(items.size());
  nodes_.reserve(items.size());
  build(items, 0, mesh.face_count(), stage);
}

Index NearestSurface::build(std::span<Item> items, Index begin, Index end, const JobStage& stage) {
  const Index index = static_cast<Index>(nodes_.size());
  nodes_.emplace_back();
  if (end - begin <= k_leaf_size) {
    make_leaf(nodes_[index], items, begin, end);
    return index;
  }
  if (end - begin > 10000) stage.check();
  const Index middle = halve(items.subspan(begin, end - begin)) + begin;
  build(items, begin, middle, stage);
  const Index second = build(items, middle, end, stage);
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

/// Puts the half that lies lower along the longest side of the centers' box first.
Index NearestSurface::halve(std::span<Item> items) {
  std::array<float, 3> low = items[0].center, high = low;
  for (const Item& item : items)
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], item.center[i]);
      high[i] = std::max(high[i], item.center[i]);
    }
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (high[i] - low[i] > high[axis] - low[axis]) axis = i;
  const auto middle = items.begin() + items.size() / 2;
  std::nth_element(items.begin(), middle, items.end(), [axis](const Item& a, const Item& b) {
    return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis] : a.face < b.face;
  });
  return static_cast<Index>(items.size() / 2);
}

void NearestSurface::make_leaf(Node& node, std::span<const Item> items, Index begin, Index end) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (Index i = begin; i < end; ++i) {
    faces_[i] = items[i].face;
    for (const Index v : mesh_.triangles()[faces_[i]]) {
      const Vec3 local = to_box_units(mesh_.position(v));
      low = low.cwiseMin(local);
      high = high.cwiseMax(local);
    }
  }
  for (int i = 0; i < 3; ++i) {
    node.low[i] = static_cast<float>(low[i] - slack_);
    node.high[i] = static_cast<float>(high[i] + slack_);
  }
  node.first = begin;
  node.count = end - begin;
}

/// Returns the distance from a point (in box units) to the box, in mesh units, never too large.
double NearestSurface::squared_distance(const Node& node, const Vec3& local) const {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const double outside = std::max(0.0, std::max(node.low[i] - local[i], local[i] - node.high[i]));
    sum += outside * outside;
  }
  constexpr double k_rounding = 1e-14;  // of the few operations here
  return sum * (1 - k_rounding) * (unit_ * unit_);
}

SurfacePoint NearestSurface::nearest(const Vec3& wanted, Index hint) const {
  const Vec3 query = pulled_in(wanted), local = to_box_units(query);
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
  mesh.require_space("project");
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
  const std::vector<Index> order = order_of(keys, options.threads, stage);

  SurfacePoints result(static_cast<std::size_t>(count));
  const Index chunks = (count + k_chunk - 1) / k_chunk;
  std::atomic<Index> done{0};
  parallel_for(chunks, options.threads, 1, [&](Index chunk, int) {
    const Index end = std::min(count, (chunk + 1) * k_chunk);
    Index last = k_none;
    for (Index k = chunk * k_chunk; k < end; ++k) {
      stage.check();  // of a sphere's center all faces are as near, and a query takes a while
      const Index i = order[k];
      result[i] = surface.nearest(query(i), last);
      last = result[i].face;
    }
    stage.update(static_cast<double>(++done) / chunks);
  });
  stage.update(1);
  return result;
}

}  // namespace saddleback
