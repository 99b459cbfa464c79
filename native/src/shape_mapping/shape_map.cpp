// Coordinates spread from the source outwards, nearest vertex first, as Dijkstra's algorithm does; a vertex gets its
// own from the two ends of an edge that are settled, by unfolding the triangle on it (sight.h).

#include "shape_mapping/shape_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "saddleback/mesh/trace.h"

#include "mesh/tables/outgoing.h"
#include "shape_mapping/curve_bend.h"
#include "shape_mapping/sides.h"
#include "shape_mapping/sight.h"

namespace saddleback {
namespace {

/// A walk over more faces than this is lost.
constexpr Index k_most_steps = 1'000'000;

Vec2 unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// Tells whether both ends lie beyond the same side of the box: nothing seen through the edge is wanted then.
bool is_beyond(const PlaneBox& box, const Vec2& a, const Vec2& b) {
  return (a.x() < box.low.x() && b.x() < box.low.x()) || (a.x() > box.high.x() && b.x() > box.high.x()) ||
         (a.y() < box.low.y() && b.y() < box.low.y()) || (a.y() > box.high.y() && b.y() > box.high.y());
}

}  // namespace

ShapeMap::ShapeMap(const Mesh& mesh)
    : mesh_(&mesh),
      bend_(std::make_unique<CurveBend>()),
      nodes_(static_cast<std::size_t>(mesh.vertex_count())),
      status_(nodes_.size(), 0) {}

ShapeMap::~ShapeMap() = default;
ShapeMap::ShapeMap(ShapeMap&&) noexcept = default;
ShapeMap& ShapeMap::operator=(ShapeMap&&) noexcept = default;

void ShapeMap::begin() {
  stamp_ += k_states;
  if (stamp_ == 0) {  // after 2^30 maps the old stamps would come again
    std::ranges::fill(status_, 0);
    stamp_ = k_states;
  }
  reached_.clear();
  queue_.clear();
}

void ShapeMap::about_point(const SurfacePoint& center, double angle, const PlaneBox& box, double reach,
                           const Watch& watch) {
  begin();
  along_curve_ = false;
  center_ = position(*mesh_, center);
  reach_ = mesh_->in_space(reach);
  center_face_ = center.face;
  const Index vertex = vertex_at(*mesh_, center);
  if (vertex == k_none)
    seed_face(center, angle);
  else
    seed_star(center, vertex, angle);
  march(box, watch);
}

void ShapeMap::seed_face(const SurfacePoint& center, double angle) {
  const FaceChart chart(*mesh_, center.face);
  const Vec2 place = chart.to_plane(center.barycentric), x = unit(angle);
  for (int i = 0; i < 3; ++i) {
    const Vec2 arm = chart.corner[i] - place;
    put_source(mesh_->from(3 * center.face + i), {x.dot(arm), cross(x, arm)});
  }
}

void ShapeMap::seed_star(const SurfacePoint& center, Index vertex, double angle) {
  const double start = angle_about(*mesh_, center, angle);
  const double scale = mesh_->is_boundary(vertex) ? 1 : 2 * std::numbers::pi / mesh_->total_angle(vertex);
  put_source(vertex, Vec2::Zero());
  const Index first = mesh_->first_halfedge(vertex);
  Index h = first;
  double fan = 0;
  do {
    put_source(mesh_->to(h), mesh_->length(h) * unit((fan - start) * scale));
    fan += mesh_->corner_angle(h);
    const Index following = mesh_->rotate(h);
    if (following == k_none) put_source(mesh_->apex(h), mesh_->length(Mesh::prev(h)) * unit((fan - start) * scale));
    h = following;
  } while (h != k_none && h != first);
}

void ShapeMap::along_curve(const SurfaceCurve& curve, double origin, const PlaneBox& box) {
  begin();
  along_curve_ = true;
  reach_ = std::numeric_limits<double>::infinity();
  bend_->measure(curve, origin);
  center_face_ = curve.segments().front().face;
  for (const CurveSegment& segment : curve.segments()) {
    const double start = segment.start - origin;
    if (start <= 0) center_face_ = segment.face;
    if (start <= box.high.x() && start + segment.length >= box.low.x()) seed_segment(segment, start);
  }
  for (const Index vertex : reached_) {
    Node& node = nodes_[vertex];
    node.key = distance_of(node.place);
    queue_.push_back({node.key, vertex});
  }
  std::make_heap(queue_.begin(), queue_.end());
  march(box, {});
}

/// Corners of the faces that the curve crosses take their foot on the nearest segment, run on straight where it falls
/// beside: by how much is kept as the key until all segments have been seen.
void ShapeMap::seed_segment(const CurveSegment& segment, double start) {
  const FaceChart chart(*mesh_, segment.face);
  const Vec2 begin = chart.to_plane(segment.begin);
  const Vec2 along = (chart.to_plane(segment.end) - begin) / segment.length;
  for (int i = 0; i < 3; ++i) {
    const Vec2 arm = chart.corner[i] - begin;
    const double foot = along.dot(arm), miss = std::max({0.0, -foot, foot - segment.length});
    const Index vertex = mesh_->from(3 * segment.face + i);
    const bool is_new = !has(vertex);
    Node& node = reach(vertex, State::source);
    if (is_new || miss < node.key) node = {{start + foot, cross(along, arm)}, miss, 0};
  }
}

ShapeMap::Node& ShapeMap::reach(Index vertex, State state) {
  if (!has(vertex)) reached_.push_back(vertex);
  set(vertex, state);
  return nodes_[vertex];
}

void ShapeMap::put(Index vertex, const Vec2& place, double key, double miss, State state) {
  reach(vertex, state) = {place, key, miss};
  queue_.push_back({key, vertex});
  std::push_heap(queue_.begin(), queue_.end());
}

void ShapeMap::march(const PlaneBox& box, const Watch& watch) {
  while (!queue_.empty()) {
    const Entry entry = queue_.front();
    std::pop_heap(queue_.begin(), queue_.end());
    queue_.pop_back();
    if (state_of(entry.vertex) >= State::settled || nodes_[entry.vertex].key != entry.key) continue;
    set(entry.vertex, State::settled);
    find_spokes(entry.vertex);
    if (watch && !watch(entry.vertex, spokes_)) return;
    look_about(entry.vertex, box);
  }
}

/// Tells whether the straight way from the center to the edge is longer than the reach.
bool ShapeMap::is_out_of_reach(Index from, Index to) const {
  const Vec3 begin = mesh_->position(from) - center_, along = mesh_->position(to) - mesh_->position(from);
  const double foot = std::clamp(-begin.dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (begin + foot * along).squaredNorm() > reach_ * reach_;
}

/// Both the watch and the march go around each vertex: what they ask is looked up once.
void ShapeMap::find_spokes(Index vertex) {
  spokes_.clear();
  const Index first = mesh_->first_halfedge(vertex);
  Index h = first, to = mesh_->to(h);
  State to_state = state_of(to);
  do {
    const Index last = Mesh::prev(h), apex = mesh_->from(last);
    const State apex_state = state_of(apex);
    spokes_.push_back({h, to, apex, to_state, apex_state});
    to = apex;  // of which the next half-edge goes there
    to_state = apex_state;
    h = mesh_->twin(last);
  } while (h != k_none && h != first);
}

/// Looks through every edge of the vertex's faces that has now both ends settled.
void ShapeMap::look_about(Index vertex, const PlaneBox& box) {
  const Vec2 place = nodes_[vertex].place;
  const bool is_near = (mesh_->position(vertex) - center_).squaredNorm() <= reach_ * reach_;
  const auto is_open = [&](Index other, State state) {
    return state >= State::source && !is_beyond(box, place, nodes_[other].place) &&
           (is_near || !is_out_of_reach(vertex, other));
  };
  bool is_next_open = is_open(spokes_[0].to, spokes_[0].to_state);
  for (const auto& [h, to, apex, to_state, apex_state] : spokes_) {
    const bool is_apex_open = is_open(apex, apex_state);
    if (is_next_open && apex_state == State::waiting) look_through(h, vertex, to, apex);
    if (is_apex_open && to_state == State::waiting) look_through(Mesh::prev(h), apex, vertex, to);
    is_next_open = is_apex_open;
  }
}

Sight ShapeMap::sight_through(const UnfoldedTriangle& triangle, const Vec2& from, const Vec2& to) const {
  if (!along_curve_) return sight_of_point(triangle, from, to);
  return sight_of_line(triangle, from, to, bend_->curvature(0.5 * (from.x() + to.x()), triangle.edge));
}

/// Sees the apex, which waits, through the half-edge.
void ShapeMap::look_through(Index halfedge, Index from, Index to, Index apex) {
  const UnfoldedTriangle triangle(mesh_->corners(halfedge));
  const Sight sight = sight_through(triangle, nodes_[from].place, nodes_[to].place);
  // What is not seen well waits for an edge that it may be seen through after all.
  const double key = distance_of(sight.place) + sight.miss * triangle.edge;
  if (has(apex)) {
    const Node& node = nodes_[apex];
    if (sight.miss > node.miss || (sight.miss == node.miss && key >= node.key)) return;
  }
  put(apex, sight.place, key, sight.miss, State::waiting);
}

void ShapeMap::complete(Index face) {
  for (int i = 0; i < 3; ++i) {
    const Index h = 3 * face + i;
    const Index from = mesh_->from(h), to = mesh_->to(h), apex = mesh_->apex(h);
    if (has(apex) || !has(from) || !has(to)) continue;
    const UnfoldedTriangle triangle(mesh_->corners(h));
    const Vec2 place = sight_through(triangle, nodes_[from].place, nodes_[to].place).place;
    reach(apex, State::waiting) = {place, 0, 0};
  }
}

bool ShapeMap::is_in(const Vec2& point, Index face) const {
  for (Index h = 3 * face; h < 3 * face + 3; ++h)
    if (!is_corner_left(coordinates(mesh_->from(h)), coordinates(mesh_->to(h)), point)) return false;
  return true;
}

/// Crosses any edge that the point is beyond, beginning with a different one each time: no round is walked for ever.
MapFailure ShapeMap::find(const Vec2& point, Index& face) {
  MapFailure obstacle = MapFailure::fold;
  for (Index step = 0; step < k_most_steps; ++step) {
    Index onward = k_none;
    bool is_inside = true;
    for (Index i = 0; i < 3 && onward == k_none; ++i) {
      const Index h = 3 * face + (i + step) % 3;
      if (is_corner_left(coordinates(mesh_->from(h)), coordinates(mesh_->to(h)), point)) continue;
      is_inside = false;
      onward = mesh_->twin(h);
      if (onward == k_none) obstacle = MapFailure::boundary;
    }
    if (is_inside) return MapFailure::none;
    if (onward == k_none) return obstacle;
    face = Mesh::face_of(onward);
    complete(face);
    const Index h = 3 * face;
    if (!is_upright(coordinates(mesh_->from(h)), coordinates(mesh_->to(h)), coordinates(mesh_->apex(h)))) break;
  }
  return MapFailure::fold;
}

SurfacePoint ShapeMap::surface_point(const Vec2& point, Index face) const {
  const Vec2& origin = coordinates(mesh_->from(3 * face));
  const Vec2 u = coordinates(mesh_->to(3 * face)) - origin, v = coordinates(mesh_->apex(3 * face)) - origin;
  const Vec2 arm = point - origin;
  const double area = cross(u, v), first = cross(arm, v) / area, second = cross(u, arm) / area;
  return {face, normalized_barycentric({1 - first - second, first, second})};
}

}  // namespace saddleback
