#include "tessellation/log_map/patch_log.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "support/planar.h"
#include "tessellation/log_map/interpolated_direction.h"

namespace saddleback {
namespace {

constexpr double k_far = std::numeric_limits<double>::infinity();
// Relative to the edge: nearer to it a point is seen end-on from beyond it, where rounding of the distances to its ends
// leaves too little of how near.
constexpr double k_on_edge = 1e-6;
// A vertex that is placed already is placed again when another way is shorter by more than rounding. That is more where
// an edge is short beside its distance, and makes vertices beside it nearer in turn without end: from the eighth time
// on each that gains little has to gain twice as much as the last. What gains more is mostly a straighter way.
constexpr double k_rounding = 1e-12, k_first_gain = k_rounding / 256, k_little = 1e-5, k_rise = 1.1;
// Odd, so that vertices next to each other in number fall into slots of their own.
constexpr std::uint32_t k_spread = 2654435761U;

/// Tells whether a point is as good as on one of the edges of its face.
bool is_on_edge(const Mesh& mesh, const SurfacePoint& point, int edge) {
  const double length = mesh.length(3 * point.face + edge);
  return 2 * mesh.face_area(point.face) * point.barycentric[(edge + 2) % 3] <= k_on_edge * length * length;
}

Vec2 polar(double length, double angle) { return {length * std::cos(angle), length * std::sin(angle)}; }

}  // namespace

void PatchLog::begin(std::span<const Index> faces) {
  faces_ = faces;
  for (const Index face : faces) {  // in no order of memory: all are asked for before any is waited for
    __builtin_prefetch(&mesh_.triangles()[face]);
    __builtin_prefetch(&mesh_.lengths()[3 * face]);
    __builtin_prefetch(&mesh_.lengths()[3 * face + 2]);
  }
  number_vertices();
  list_faces_around();
  edges_.clear();
  edges_.reserve(3 * faces.size());
  for (const Index face : faces) {
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      const double length = mesh_.length(h), right = mesh_.length(Mesh::next(h)), left = mesh_.length(Mesh::prev(h));
      const double share = 1 / (2 * length), x = (left * left - right * right + length * length) * share;
      const bool is_obtuse = left * left + right * right < length * length;
      edges_.push_back({length, share, left, right, is_obtuse, {x, std::sqrt(std::max(0.0, left * left - x * x))}});
    }
  }
}

/// Lists the faces around each vertex. The begin of each list is counted one place ahead, and moves on as faces are put
/// in.
void PatchLog::list_faces_around() {
  first_.assign(vertices_.size() + 2, 0);
  for (const auto& corners : corners_)
    for (const Index vertex : corners) ++first_[vertex + 2];
  for (std::size_t vertex = 0; vertex < vertices_.size(); ++vertex) first_[vertex + 2] += first_[vertex + 1];
  around_.resize(3 * faces_.size());
  for (Index face = 0; face < static_cast<Index>(faces_.size()); ++face)
    for (const Index vertex : corners_[face]) around_[first_[vertex + 1]++] = face;
}

/// Numbers the vertices in the order in which faces name them.
void PatchLog::number_vertices() {
  const std::size_t size = std::bit_ceil(4 * faces_.size() + 1);
  table_.assign(size, k_none);
  vertices_.clear();
  corners_.clear();
  vertices_.reserve(faces_.size());
  corners_.reserve(faces_.size());
  for (const Index face : faces_) {
    std::array<Index, 3>& corners = corners_.emplace_back();
    for (int i = 0; i < 3; ++i) {
      const Index vertex = mesh_.triangles()[face][i];
      std::size_t slot = k_spread * static_cast<std::uint32_t>(vertex) & (size - 1);
      while (table_[slot] != k_none && vertices_[table_[slot]] != vertex) slot = (slot + 1) & (size - 1);
      if (table_[slot] == k_none) {
        table_[slot] = static_cast<Index>(vertices_.size());
        vertices_.push_back(vertex);
      }
      corners[i] = table_[slot];
    }
  }
}

Index PatchLog::local_face(Index face) const {
  const auto found = std::ranges::lower_bound(faces_, face);
  return found != faces_.end() && *found == face ? static_cast<Index>(found - faces_.begin()) : k_none;
}

bool PatchLog::run(const SurfacePoint& center) {
  const Index local = local_face(center.face);
  if (local == k_none) return false;
  places_.assign(vertices_.size(), Vec2::Zero());
  distances_.assign(vertices_.size(), k_far);
  gains_.assign(vertices_.size(), k_first_gain);
  changed_.assign(vertices_.size(), 0);
  visited_.assign(vertices_.size(), 0);
  visits_ = 0;
  heap_.clear();
  ways_.clear();
  last_way_.assign(vertices_.size(), k_none);
  first_face_ = k_none;
  if (const Index vertex = vertex_at(mesh_, center); vertex != k_none)
    start_at_vertex(vertex);
  else
    start_in_face(center, local);
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end());
    const auto [nearest, vertex] = heap_.back();
    heap_.pop_back();
    if (nearest > distances_[vertex]) continue;
    visited_[vertex] = ++visits_;
    for (Index i = first_[vertex]; i < first_[vertex + 1]; ++i) visit_face(around_[i], vertex);
  }
  return true;
}

void PatchLog::start_in_face(const SurfacePoint& center, Index local) {
  const FaceChart chart(mesh_, center.face);
  const Vec2 at = chart.to_plane(center.barycentric);
  for (int i = 0; i < 3; ++i) begin_with(corners_[local][i], chart.corner[i] - at, (chart.corner[i] - at).norm());
  first_face_ = local;
  // On an edge, the face beyond lies just as near.
  for (int i = 0; i < 3; ++i) {
    if (!is_on_edge(mesh_, center, i)) continue;
    first_face_ = k_none;
    const Index h = 3 * center.face + i, twin = mesh_.twin(h);
    if (twin == k_none) continue;
    const Index beyond = local_face(Mesh::face_of(twin));
    if (beyond == k_none) continue;
    const FaceChart other(mesh_, Mesh::face_of(twin));
    const Vec2 &from = other.corner[twin % 3], along = (other.corner[(twin + 1) % 3] - from) / mesh_.length(twin);
    const Vec2 apex = other.corner[(twin + 2) % 3] - from;
    const Vec2 &here = chart.corner[(i + 1) % 3], back = (chart.corner[i] - here) / mesh_.length(h);
    const Vec2 turned = along.dot(apex) * back + cross(along, apex) * Vec2(-back.y(), back.x());
    const Vec2 place = here + turned - at;
    if (cross(chart.corner[i] - at, place) >= 0 && cross(place, here - at) >= 0)
      begin_with(corners_[beyond][(twin + 2) % 3], place, place.norm());
  }
}

void PatchLog::start_at_vertex(Index vertex) {
  const auto local = static_cast<Index>(std::ranges::find(vertices_, vertex) - vertices_.begin());
  const double scale = mesh_.is_boundary(vertex) ? 1 : 2 * std::numbers::pi / mesh_.total_angle(vertex);
  distances_[local] = 0;
  double angle = 0;
  for (Index h = mesh_.first_halfedge(vertex); h != k_none;) {
    if (const Index face = local_face(Mesh::face_of(h)); face != k_none) {
      const Index last = Mesh::prev(h);
      const double next_angle = angle + mesh_.corner_angle(h);
      begin_with(corners_[face][(h + 1) % 3], polar(mesh_.length(h), scale * angle), mesh_.length(h));
      begin_with(corners_[face][last % 3], polar(mesh_.length(last), scale * next_angle), mesh_.length(last));
    }
    angle += mesh_.corner_angle(h);
    h = mesh_.rotate(h);
    if (h == mesh_.first_halfedge(vertex)) break;
  }
}

/// Tells whether a distance is less than the vertex's by the ways so far, by more than rounding.
bool PatchLog::is_nearer(Index vertex, double distance) const {
  return distance < (1 - std::max(k_rounding, gains_[vertex])) * distances_[vertex];
}

void PatchLog::begin_with(Index vertex, const Vec2& place, double distance) {
  if (is_nearer(vertex, distance)) offer({vertex, k_none, k_none}, place, distance);
}

void PatchLog::offer(const Way& way, const Vec2& place, double distance) {
  const Index vertex = way.vertex;
  last_way_[vertex] = static_cast<Index>(ways_.size());
  ways_.push_back(way);
  gains_[vertex] *= distance < (1 - k_little) * distances_[vertex] ? k_rise : 2;
  distances_[vertex] = distance;
  places_[vertex] = place;
  changed_[vertex] = visits_;
  heap_.push_back({distance, vertex});
  std::push_heap(heap_.begin(), heap_.end());
}

/// Goes from a vertex across its two edges of a face, unless that was done from their other ends, from the same places,
/// or the corner beyond is nearer than both ends, which only an obtuse one can be that is seen across.
void PatchLog::visit_face(Index local, Index vertex) {
  const auto& corners = corners_[local];
  const int at = corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2, next = (at + 1) % 3, last = (at + 2) % 3;
  const Index after = corners[next], before = corners[last];
  const double nearest = distances_[vertex];
  const auto serves = [&](int edge, Index other, Index beyond) {
    return (distances_[beyond] > std::min(nearest, distances_[other]) || edges_[3 * local + edge].is_obtuse) &&
           visited_[other] <= std::max(changed_[other], changed_[vertex]);
  };
  if (serves(at, after, before)) see_across(local, at);
  if (serves(last, before, after)) see_across(local, last);
}

/// Straight on along an edge, in the direction of its start.
void PatchLog::walk(const Way& way, double length) {
  const double distance = distances_[way.from] + length;
  if (!is_nearer(way.vertex, distance)) return;
  const double before = places_[way.from].norm();
  if (before > 0) offer(way, places_[way.from] * (distance / before), distance);
}

/// The center below an edge that runs along the x axis, the corner above: its foot on the edge's line and the square of
/// how far it is from there, not above 0 where the distances make no triangle.
PatchLog::Foot PatchLog::foot_of_center(const EdgeShape& edge, double to_start, double to_end) {
  const double square = to_start * to_start;
  const double x = (square - to_end * to_end + edge.length * edge.length) * edge.share;
  return {x, square - x * x};
}

/// The corner of a face opposite an edge whose ends are placed.
void PatchLog::see_across(Index local, int edge) {
  const Index a = corners_[local][edge], b = corners_[local][(edge + 1) % 3], c = corners_[local][(edge + 2) % 3];
  const double to_a = distances_[a], to_b = distances_[b], known = distances_[c];
  const Index across = 3 * local + edge;
  const EdgeShape& shape = edges_[across];
  if (to_a < k_far && to_b < k_far) {
    if (const auto [x, depth_2] = foot_of_center(shape, to_a, to_b); depth_2 > 0) {
      // Ways along the edges are no shorter than the ray, and most rays are no shorter than the way that is known: that
      // is decided without roots. A ray's square is the sum below and twice the height times the root of depth_2.
      const double beside = shape.apex.x() - x, height = shape.apex.y();
      const double room = known * known - (beside * beside + height * height + depth_2);
      if (!(room > 0 && room * room > 4 * height * height * depth_2)) return;
      const Vec2 center(x, -std::sqrt(depth_2)), ray = shape.apex - center;
      const Vec2 back_a = -center, back_b(shape.length - x, -center.y());
      if (cross(ray, back_a) >= 0 && cross(back_b, ray) >= 0) {
        if (const double distance = ray.norm(); is_nearer(c, distance))
          offer({c, across, k_none}, seen_between(places_[a], places_[b], back_a, back_b, ray), distance);
        return;
      }
    }
  }
  if (to_a < k_far) walk({c, across, a}, shape.left);
  if (to_b < k_far) walk({c, across, b}, shape.right);
}

bool PatchLog::run_again(const SurfacePoint& center) {
  if (first_face_ == k_none || faces_[first_face_] != center.face) return false;
  for (int i = 0; i < 3; ++i)
    if (is_on_edge(mesh_, center, i)) return false;
  const FaceChart chart(mesh_, center.face);
  const Vec2 at = chart.to_plane(center.barycentric);
  for (int i = 0; i < 3; ++i) {
    const Index vertex = corners_[first_face_][i];
    places_[vertex] = chart.corner[i] - at;
    distances_[vertex] = places_[vertex].norm();
  }
  for (Index i = 0; i < static_cast<Index>(ways_.size()); ++i) {
    const Way& way = ways_[i];
    if (way.edge != k_none && last_way_[way.vertex] == i && !follow(way, i)) return false;
  }
  return true;
}

/// Places a vertex by the way of that number; false where it does not lead there, or from what was placed later.
bool PatchLog::follow(const Way& way, Index number) {
  const Index local = way.edge / 3, edge = way.edge % 3;
  const Index a = corners_[local][edge], b = corners_[local][(edge + 1) % 3];
  if (last_way_[a] > number || last_way_[b] > number) return false;
  const EdgeShape& shape = edges_[way.edge];
  Vec2& place = places_[way.vertex];
  double& distance = distances_[way.vertex];
  if (way.from != k_none) {
    const double before = places_[way.from].norm();
    distance = distances_[way.from] + (way.from == a ? shape.left : shape.right);
    place = places_[way.from] * (distance / before);
    return before > 0;
  }
  const auto [x, depth_2] = foot_of_center(shape, distances_[a], distances_[b]);
  if (!(depth_2 > 0)) return false;
  const Vec2 center(x, -std::sqrt(depth_2)), ray = shape.apex - center, back_b(shape.length - x, -center.y());
  place = seen_between(places_[a], places_[b], -center, back_b, ray);
  distance = ray.norm();
  return true;
}

}  // namespace saddleback
