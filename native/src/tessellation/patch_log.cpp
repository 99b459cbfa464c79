#include "tessellation/patch_log.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "geodesics/planar.h"
#include "tessellation/seen_between.h"

namespace saddleback {
namespace {

constexpr double k_far = std::numeric_limits<double>::infinity();
// Barycentric: nearer to an edge a point is seen end-on from beyond it.
constexpr double k_on_edge = 1e-9;
// A vertex that is placed already is placed again when another way is shorter by more than rounding.
constexpr double k_rounding = 1e-12;

Vec2 polar(double length, double angle) { return {length * std::cos(angle), length * std::sin(angle)}; }

}  // namespace

PatchLog::PatchLog(const Mesh& mesh, std::span<const Index> faces) : mesh_(mesh), faces_(faces) {
  // Corners by their vertices: sorted as numbers, the vertex above, the corner below.
  std::vector<std::uint64_t> order;
  order.reserve(3 * faces.size());
  for (const Index face : faces)
    for (const Index vertex : mesh.triangles()[face])
      order.push_back(static_cast<std::uint64_t>(vertex) << 32 | static_cast<std::uint64_t>(order.size()));
  std::ranges::sort(order);
  corners_.resize(faces.size());
  first_.push_back(0);
  around_.reserve(order.size());
  for (const std::uint64_t entry : order) {
    const auto vertex = static_cast<Index>(entry >> 32), corner = static_cast<Index>(entry & 0xFFFFFFFF);
    if (vertices_.empty() || vertices_.back() != vertex) {
      vertices_.push_back(vertex);
      first_.push_back(first_.back());
    }
    corners_[corner / 3][corner % 3] = static_cast<Index>(vertices_.size()) - 1;
    around_.push_back(corner / 3);
    ++first_.back();
  }
  edges_.reserve(order.size());
  for (const Index face : faces) {
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      const double length = mesh.length(h), right = mesh.length(Mesh::next(h)), left = mesh.length(Mesh::prev(h));
      const double x = (left * left - right * right + length * length) / (2 * length);
      edges_.push_back({length, left, right, {x, std::sqrt(std::max(0.0, left * left - x * x))}});
    }
  }
}

Index PatchLog::local_face(Index face) const {
  const auto found = std::ranges::lower_bound(faces_, face);
  return found != faces_.end() && *found == face ? static_cast<Index>(found - faces_.begin()) : k_none;
}

bool PatchLog::run(const SurfacePoint& centre) {
  const Index local = local_face(centre.face);
  if (local == k_none) return false;
  places_.assign(vertices_.size(), Vec2::Zero());
  distances_.assign(vertices_.size(), k_far);
  heap_.clear();
  if (const Index vertex = vertex_at(mesh_, centre); vertex != k_none)
    start_at_vertex(vertex);
  else
    start_in_face(centre, local);
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end());
    const auto [nearest, vertex] = heap_.back();
    heap_.pop_back();
    if (nearest > distances_[vertex]) continue;
    for (Index i = first_[vertex]; i < first_[vertex + 1]; ++i) {
      const Index face = around_[i];
      for (int edge = 0; edge < 3; ++edge)
        if (corners_[face][(edge + 2) % 3] != vertex) see_across(face, edge);
    }
  }
  return true;
}

void PatchLog::start_in_face(const SurfacePoint& centre, Index local) {
  const FaceChart chart(mesh_, centre.face);
  const Vec2 at = chart.to_plane(centre.barycentric);
  for (int i = 0; i < 3; ++i) offer(corners_[local][i], chart.corner[i] - at, (chart.corner[i] - at).norm());
  // On an edge, the face beyond lies just as near.
  for (int i = 0; i < 3; ++i) {
    const Index h = 3 * centre.face + i, twin = mesh_.twin(h);
    if (centre.barycentric[(i + 2) % 3] > k_on_edge || twin == k_none) continue;
    const Index beyond = local_face(Mesh::face_of(twin));
    if (beyond == k_none) continue;
    const FaceChart other(mesh_, Mesh::face_of(twin));
    const Vec2 &from = other.corner[twin % 3], along = (other.corner[(twin + 1) % 3] - from) / mesh_.length(twin);
    const Vec2 apex = other.corner[(twin + 2) % 3] - from;
    const Vec2 &here = chart.corner[(i + 1) % 3], back = (chart.corner[i] - here) / mesh_.length(h);
    const Vec2 turned = along.dot(apex) * back + cross(along, apex) * Vec2(-back.y(), back.x());
    offer(corners_[beyond][(twin + 2) % 3], here + turned - at, (here + turned - at).norm());
  }
}

void PatchLog::start_at_vertex(Index vertex) {
  const auto local = static_cast<Index>(std::ranges::lower_bound(vertices_, vertex) - vertices_.begin());
  const double scale = mesh_.is_boundary(vertex) ? 1 : 2 * M_PI / mesh_.total_angle(vertex);
  distances_[local] = 0;
  double angle = 0;
  for (Index h = mesh_.first_halfedge(vertex); h != k_none;) {
    if (const Index face = local_face(Mesh::face_of(h)); face != k_none) {
      const Index last = Mesh::prev(h);
      offer(corners_[face][(h + 1) % 3], polar(mesh_.length(h), scale * angle), mesh_.length(h));
      offer(corners_[face][last % 3], polar(mesh_.length(last), scale * (angle + mesh_.corner_angle(h))),
            mesh_.length(last));
    }
    angle += mesh_.corner_angle(h);
    h = mesh_.rotate(h);
    if (h == mesh_.first_halfedge(vertex)) break;
  }
}

void PatchLog::offer(Index vertex, const Vec2& place, double distance) {
  if (!(distance < (1 - k_rounding) * distances_[vertex])) return;
  distances_[vertex] = distance;
  places_[vertex] = place;
  heap_.push_back({distance, vertex});
  std::push_heap(heap_.begin(), heap_.end());
}

/// Straight on along an edge, in the direction of its start.
void PatchLog::walk(Index from, Index to, double length) {
  const double distance = distances_[from] + length;
  const double before = places_[from].norm();
  if (before > 0) offer(to, places_[from] * (distance / before), distance);
}

/// The corner of a face opposite an edge whose ends are placed.
void PatchLog::see_across(Index local, int edge) {
  const Index a = corners_[local][edge], b = corners_[local][(edge + 1) % 3], c = corners_[local][(edge + 2) % 3];
  const double to_a = distances_[a], to_b = distances_[b], known = distances_[c];
  if (known <= std::min(to_a, to_b)) return;
  const EdgeShape& shape = edges_[3 * local + edge];
  if (to_a < k_far && to_b < k_far) {
    // The edge runs along the x axis, the corner above, the centre below.
    const double square_a = to_a * to_a, length = shape.length;
    const double x = (square_a - to_b * to_b + length * length) / (2 * length), y = square_a - x * x;
    if (y > 0) {
      const Vec2 centre(x, -std::sqrt(y)), ray = shape.apex - centre, back_a = -centre, back_b(length - x, -centre.y());
      if (cross(ray, back_a) >= 0 && cross(back_b, ray) >= 0) {
        const double distance = ray.norm();
        if (distance < (1 - k_rounding) * known)
          offer(c, seen_between(places_[a], places_[b], back_a, back_b, ray), distance);
        return;
      }
    }
  }
  if (to_a < k_far) walk(a, c, shape.left);
  if (to_b < k_far) walk(b, c, shape.right);
}

}  // namespace saddleback
