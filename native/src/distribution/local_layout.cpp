#include "distribution/local_layout.h"

#include <algorithm>

#include "mesh/tables/outgoing.h"
#include "shape_mapping/sight.h"

namespace saddleback::distribution {
namespace {

/// A line of sight that misses an edge by this share of it may as well pass through: another edge would hardly do
/// better.
constexpr double k_clear_sight = 0.1;

}  // namespace

LocalLayout::LocalLayout(const Mesh& mesh, const FlatFaces& flat)
    : mesh_(&mesh),
      flat_(&flat),
      nodes_(static_cast<std::size_t>(mesh.vertex_count())),
      face_stamps_(static_cast<std::size_t>(mesh.face_count()), 0) {}

const std::vector<FacePlace>& LocalLayout::about(std::span<const LaidVertex> vertices, std::span<const Index> known,
                                                 double reach) {
  begin(reach);
  for (const Index face : known) face_stamps_[face] = stamp_;
  for (const LaidVertex& laid : vertices) put(laid.vertex, laid.place);
  spread();
  while (!turned_away_.empty()) {
    waiting_.swap(turned_away_);
    for (const Index h : waiting_)
      if (!has(mesh_->apex(h))) insert(h, k_most_miss);
    waiting_.clear();
    spread();
  }
  return faces_;
}

void LocalLayout::begin(double reach) {
  if (++stamp_ == 0) {
    for (Node& node : nodes_) node.stamp = 0;
    std::fill(face_stamps_.begin(), face_stamps_.end(), 0);
    stamp_ = 1;
  }
  reach_ = reach;
  ring_ = 0;
  faces_.clear();
}

void LocalLayout::put(Index vertex, const Vec2& place) {
  nodes_[vertex] = {place, stamp_};
  const int ring = static_cast<int>(std::min(place.norm() / reach_ * k_rings, k_rings - 1.0));
  rings_[std::max(ring, ring_)].push_back(vertex);
}

void LocalLayout::spread() {
  for (ring_ = 0; ring_ < k_rings; ++ring_) {
    // Looking around may add to the same ring.
    for (std::size_t i = 0; i < rings_[ring_].size(); ++i) look_around(rings_[ring_][i]);
    rings_[ring_].clear();
  }
  ring_ = 0;
}

/// Tells whether an edge is, somewhere.
bool LocalLayout::is_within_reach(const Vec2& from, const Vec2& to) const {
  const double square = reach_ * reach_;
  if (from.squaredNorm() <= square || to.squaredNorm() <= square) return true;
  const Vec2 along = to - from;
  const double share = -from.dot(along), length = along.squaredNorm();
  return share > 0 && share < length && (length * from + share * along).squaredNorm() <= square * length * length;
}

void LocalLayout::look_around(Index vertex) {
  for (const Index h : outgoing(*mesh_, vertex)) {
    const Index face = Mesh::face_of(h);
    if (face_stamps_[face] != stamp_) {
      const bool has_next = has(mesh_->to(h)), has_apex = has(mesh_->apex(h));
      if (has_next && has_apex) {
        write_down(face);
      } else if (has_next || has_apex) {
        const Index base = has_next ? h : Mesh::prev(h);
        if (is_within_reach(place(mesh_->from(base)), place(mesh_->to(base))) && !insert(base, k_clear_sight))
          turned_away_.push_back(base);
      }
    }
  }
}

/// Lays the face of the half-edge beside the places of its ends.
bool LocalLayout::insert(Index halfedge, double most_miss) {
  constexpr double k_corners[3][2] = {{0, 0}, {1, 0}, {0, 1}};
  const Index face = Mesh::face_of(halfedge);
  Vec2 corner[3];
  for (int i = 0; i < 3; ++i) {
    const auto& [along, up] = k_corners[(halfedge % 3 + i) % 3];
    corner[i] = flat_->place(face, {along, up});
  }
  const Vec2 arm = corner[2] - corner[0];
  const double length = mesh_->length(halfedge);
  const Vec2 way = (corner[1] - corner[0]) / length;
  const UnfoldedTriangle triangle(length, {way.dot(arm), cross(way, arm)});
  const Sight sight = sight_of_point(triangle, place(mesh_->from(halfedge)), place(mesh_->to(halfedge)));
  if (sight.miss > most_miss) return false;
  put(mesh_->apex(halfedge), sight.place);
  write_down(face);
  return true;
}

void LocalLayout::write_down(Index face) {
  face_stamps_[face] = stamp_;
  const Index h = 3 * face;
  const Vec2& origin = place(mesh_->from(h));
  const Vec2 e1 = place(mesh_->to(h)) - origin, e2 = place(mesh_->apex(h)) - origin;
  if (cross(e1, e2) > 0) faces_.push_back({face, origin, flat_->turn_to(face, e1, e2)});
}

}  // namespace saddleback::distribution
