// The outline is a polygon of the plane and the faces are laid out in the same plane, so its pieces are found by
// walking from face to face along its edges. Which edge the walk leaves a face by, and which vertices are inside, is
// decided by exact predicates that agree with each other (sides.h).
//
// That the map covers the shape once follows from three checks. All faces that the shape touches are upright: so the
// map from the surface to the plane is locally one to one there. The walk along each loop comes back to where it began.
// And the edges that have one end inside are exactly those that the walk crossed an odd number of times: a second sheet
// over the shape, or a branch point, would have a rim that the walk has not seen.

#include "shape_mapping/outline_mapper.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include "mesh/tables/outgoing.h"
#include "shape_mapping/face_weights.h"
#include "shape_mapping/sides.h"
#include "shape_mapping/sight.h"
#include "support/hypotenuse.h"

namespace saddleback {
namespace {

/// Ends the mapping from anywhere in it.
class Failed : public std::exception {
 public:
  explicit Failed(MapFailure reason) : reason_(reason) {}
  MapFailure reason() const { return reason_; }

 private:
  MapFailure reason_;
};

/// A walk over more faces than this is lost: outlines are at most as long as a few rounds of their box.
constexpr std::size_t k_most_pieces = 1'000'000;

}  // namespace

OutlineMapper::OutlineMapper(const Mesh& mesh)
    : mesh_(&mesh),
      plane_(mesh),
      face_stamps_(static_cast<std::size_t>(mesh.face_count()), 0),
      inside_stamps_(static_cast<std::size_t>(mesh.vertex_count()), 0) {}

/// Maps a shape. Everything in the shape must be laid out well, which is checked while the plane is laid: where the
/// surface folds, laying it to the end would take long.
MapFailure OutlineMapper::map(std::span<const Loop> loops, const Placement& placement, SurfaceOutline& outline,
                              const MapLimits& limits) {
  lay_corners(loops, placement, 0);
  begin(outline, limits);
  double radius = 0;
  for (const Vec2& corner : corners_) radius = std::max(radius, corner.norm());
  MapFailure failure = MapFailure::none;
  plane_.about_point(placement.center, placement.angle, box_, limits.largest * radius,
                     [&](Index vertex, std::span<const ShapeMap::Spoke> about) {
                       failure = look_at(vertex, about);
                       return failure == MapFailure::none;
                     });
  if (failure != MapFailure::none) return failure;
  settled_ = plane_.vertices().size();
  return cut();
}

MapFailure OutlineMapper::map_along(std::span<const Loop> loops, const Placement& placement, const CenterLine& line,
                                    SurfaceOutline& outline, const MapLimits& limits) {
  lay_corners(loops, placement, line.turn);
  begin(outline, limits);
  plane_.along_curve(line.curve, line.origin, box_);
  return cut();
}

/// Loops of a mirrored shape run the other way round, so that it stays on their left.
void OutlineMapper::lay_corners(std::span<const Loop> loops, const Placement& placement, double turn) {
  scale_ = placement.scale * Vec2(1, placement.mirrored ? -1 : 1);
  turn_ = turn == 0 ? Vec2(1, 0) : Vec2(std::cos(turn), std::sin(turn));
  corners_.clear();
  given_.clear();
  begins_.clear();
  box_ = {Vec2::Zero(), Vec2::Zero()};
  Index first = 0;
  for (const Loop& loop : loops) {
    begins_.push_back(corners_.size());
    const auto count = static_cast<Index>(loop.size());
    for (Index i = 0; i < count; ++i) {
      const Index source = placement.mirrored ? count - 1 - i : i;
      const Vec2 corner = laid(loop[source]);
      corners_.push_back(corner);
      given_.push_back(first + (placement.mirrored ? (source + count - 1) % count : i));
      box_.low = box_.low.cwiseMin(corner);
      box_.high = box_.high.cwiseMax(corner);
    }
    first += count;
  }
  begins_.push_back(corners_.size());
}

void OutlineMapper::begin(SurfaceOutline& outline, const MapLimits& limits) {
  if (++stamp_ == 0) {
    std::fill(face_stamps_.begin(), face_stamps_.end(), 0);
    std::fill(inside_stamps_.begin(), inside_stamps_.end(), 0);
    stamp_ = 1;
  }
  outline_ = &outline;
  limits_ = limits;
  outline.pieces.clear();
  outline.loop_begins.clear();
  outline.faces.clear();
  outline.inside.clear();
  outline.inside_plane.clear();
  outline.smallest = std::numeric_limits<double>::infinity();
  outline.largest = 0;
  crossed_.clear();
  touched_.clear();
  settled_ = 0;
}

MapFailure OutlineMapper::cut() {
  SurfaceOutline& outline = *outline_;
  face_ = plane_.center_face();
  plane_.complete(face_);
  try {
    for (std::size_t i = 0; i + 1 < begins_.size(); ++i) cut_loop(begins_[i], begins_[i + 1]);
    outline.loop_begins.push_back(outline.pieces.size());
    find_inside();
    check_crossings();
  } catch (const Failed& failed) {
    return failed.reason();
  }
  return MapFailure::none;
}

void OutlineMapper::cut_loop(std::size_t begin, std::size_t end) {
  outline_->loop_begins.push_back(outline_->pieces.size());
  if (const MapFailure failure = plane_.find(corners_[begin], face_); failure != MapFailure::none)
    throw Failed(failure);
  enter(face_);
  const Index first_face = face_;
  weights_ = weights_in_face(corners_[begin]);
  for (std::size_t i = begin; i < end; ++i) walk(corners_[i], corners_[i + 1 < end ? i + 1 : begin], given_[i]);
  if (face_ != first_face) throw Failed(MapFailure::fold);
}

bool OutlineMapper::is_in_face(const Vec2& corner) const {
  for (Index h = 3 * face_; h < 3 * face_ + 3; ++h)
    if (!is_corner_left(place(mesh_->from(h)), place(mesh_->to(h)), corner)) return false;
  return true;
}

Vec2 OutlineMapper::weights_in_face(const Vec2& corner) const {
  const Vec2& origin = place(mesh_->from(3 * face_));
  const Vec2 u = place(mesh_->to(3 * face_)) - origin, v = place(mesh_->apex(3 * face_)) - origin;
  const Vec2 arm = corner - origin;
  const double area = cross(u, v);
  return inner_weights(cross(arm, v) / area, cross(u, arm) / area);
}

/// The half-edge by which the line from a, in the face, to b leaves the face.
Index OutlineMapper::exit_of(const Vec2& a, const Vec2& b) const {
  bool is_left[3];
  for (int i = 0; i < 3; ++i) is_left[i] = is_vertex_left(a, b, place(mesh_->from(3 * face_ + i)));
  for (int i = 0; i < 3; ++i)
    if (!is_left[i] && is_left[(i + 1) % 3]) return 3 * face_ + i;
  throw Failed(MapFailure::fold);
}

/// Writes down the pieces from a, where the walk is, to b.
void OutlineMapper::walk(const Vec2& a, const Vec2& b, Index corner) {
  Index h = is_in_face(b) ? k_none : exit_of(a, b);
  while (h != k_none) {
    const Index twin = mesh_->twin(h);
    const double weight = edge_weight(cross_weight(h, a, b));
    const Vec2 exit = on_edge(h % 3, weight);
    const Vec2 at = (1 - weight) * place(mesh_->from(h)) + weight * place(mesh_->to(h));
    outline_->pieces.push_back({face_, corner, h, weights_, exit, given(at)});
    if (twin == k_none) throw Failed(MapFailure::boundary);
    if (outline_->pieces.size() > k_most_pieces) throw Failed(MapFailure::fold);
    crossed_.push_back(std::min(h, twin));
    weights_ = on_edge(twin % 3, 1 - weight);
    face_ = Mesh::face_of(twin);
    enter(face_);
    h = is_vertex_left(a, b, place(mesh_->apex(twin))) ? Mesh::next(twin) : Mesh::prev(twin);
    if (is_corner_left(place(mesh_->from(h)), place(mesh_->to(h)), b)) h = k_none;
  }
  const Vec2 end = weights_in_face(b);
  outline_->pieces.push_back({face_, corner, k_none, weights_, end, given(b)});
  weights_ = end;
}

/// Returns where the line from a to b crosses an edge, as the share of its end.
double OutlineMapper::cross_weight(Index h, const Vec2& a, const Vec2& b) const {
  const Vec2 along = b - a;
  const double right = std::abs(cross(along, place(mesh_->from(h)) - a));
  const double left = std::abs(cross(along, place(mesh_->to(h)) - a));
  return right + left > 0 ? right / (right + left) : 0.5;
}

/// Tells of most faces, without roots, that they are laid out well: the sum of the squares of the singular values is at
/// least the square of the larger one, and their product is the ratio of the areas.
bool OutlineMapper::is_soundly_laid(Index face) const {
  constexpr double k_margin = 1e-6;  // far above the rounding of triangles that are no needles
  const Vec2& a = place(mesh_->from(3 * face));
  const Vec2 u1 = place(mesh_->to(3 * face)) - a, u2 = place(mesh_->apex(3 * face)) - a;
  const auto [p, q, r] = mesh_->corners(3 * face);
  const Vec3 e1 = q - p, e2 = r - p;
  const double xx = e1.squaredNorm(), yy = e2.squaredNorm(), xy = e1.dot(e2);
  const double area = cross(u1, u2), square = xx * yy - xy * xy;
  const double sum = (1 + k_margin) * (u2.squaredNorm() * xx + u1.squaredNorm() * yy - 2 * u1.dot(u2) * xy);
  return area > 0 && square > k_margin * xx * yy && sum <= limits_.largest * limits_.largest * area * area &&
         square >= limits_.smallest * limits_.smallest * sum;
}

/// Finds the singular values of the map from the plane to a face, and whether it is laid out well.
MapFailure OutlineMapper::measure(Index face, Stretch& stretch) const {
  const Index i = mesh_->from(3 * face), j = mesh_->to(3 * face), k = mesh_->apex(3 * face);
  const Vec2 &a = place(i), &b = place(j), &c = place(k);
  if (!is_upright(a, b, c)) return MapFailure::fold;
  const auto [p, q, r] = mesh_->corners(3 * face);
  const Vec3 e1 = q - p, e2 = r - p;
  const Vec2 u1 = b - a, u2 = c - a;
  const double scale = 1 / cross(u1, u2);
  const Vec3 x = scale * (u2.y() * e1 - u1.y() * e2), y = scale * (u1.x() * e2 - u2.x() * e1);
  const double xx = x.squaredNorm(), yy = y.squaredNorm();
  const double largest = std::sqrt(0.5 * (xx + yy) + hypotenuse(0.5 * (xx - yy), x.dot(y)));
  stretch = {x.cross(y).norm() / largest, largest};
  const bool is_right = stretch.smallest >= limits_.smallest && stretch.largest <= limits_.largest;
  return is_right ? MapFailure::none : MapFailure::stretched;
}

/// Looks at the faces, of those about vertices in the shape, whose last corner this is.
MapFailure OutlineMapper::look_at(Index vertex, std::span<const ShapeMap::Spoke> about) {
  const Vec2& at = place(vertex);
  const bool is_in = is_in_shape(at);
  if (is_in && mesh_->is_boundary(vertex)) return MapFailure::boundary;
  if (is_in) {
    inside_stamps_[vertex] = stamp_;
    plane_.mark_inside(vertex);
  }
  using enum ShapeMap::State;
  for (const auto& [h, to, apex, to_state, apex_state] : about) {
    if (std::min(to_state, apex_state) < settled || !(is_in || std::max(to_state, apex_state) == inside)) continue;
    const Index face = Mesh::face_of(h);
    if (is_soundly_laid(face)) continue;
    Stretch stretch;
    if (const MapFailure failure = measure(face, stretch); failure != MapFailure::none) return failure;
  }
  return MapFailure::none;
}

/// The shape touches this face: all of it must be laid out well.
void OutlineMapper::enter(Index face) {
  if (face_stamps_[face] == stamp_) return;
  face_stamps_[face] = stamp_;
  plane_.complete(face);
  Stretch stretch;
  if (const MapFailure failure = measure(face, stretch); failure != MapFailure::none) throw Failed(failure);
  outline_->smallest = std::min(outline_->smallest, stretch.smallest);
  outline_->largest = std::max(outline_->largest, stretch.largest);
  outline_->faces.push_back(face);
  touched_.push_back(face);
}

MapFailure OutlineMapper::find(const Vec2& point, Index& face) {
  const auto touches = [this](Index f) { return face_stamps_[f] == stamp_; };
  MapFailure found = plane_.find(point, face);
  if (found == MapFailure::none && touches(face)) return found;
  Index other = plane_.center_face();
  const MapFailure from_center = plane_.find(point, other);
  if (found != MapFailure::none || (from_center == MapFailure::none && touches(other)))
    found = from_center, face = other;
  const bool is_near = (point.array() >= box_.low.array()).all() && (point.array() <= box_.high.array()).all();
  if (is_near && (found != MapFailure::none || !touches(face))) {
    const auto own = std::find_if(touched_.begin(), touched_.end(), [&](Index f) { return plane_.is_in(point, f); });
    if (own != touched_.end()) face = *own, found = MapFailure::none;
  }
  if (found != MapFailure::none) face = plane_.center_face();
  return found;
}

/// Finds the vertices that are laid into the shape. Their stars are completed, which may lay out more.
void OutlineMapper::find_inside() {
  for (std::size_t i = 0; i < plane_.vertices().size(); ++i) {
    const Index vertex = plane_.vertices()[i];
    const Vec2& at = place(vertex);
    if (i < settled_ ? !has_inside(vertex) : !is_in_shape(at)) continue;
    if (mesh_->is_boundary(vertex)) throw Failed(MapFailure::boundary);
    inside_stamps_[vertex] = stamp_;
    outline_->inside.push_back(vertex);
    outline_->inside_plane.push_back(given(at));
    complete_star(vertex);
  }
}

/// Counts the edges of the outline that the ray to the right of the vertex meets.
bool OutlineMapper::is_in_shape(const Vec2& vertex) const {
  if ((vertex.array() < box_.low.array()).any() || (vertex.array() > box_.high.array()).any()) return false;
  bool inside = false;
  for (std::size_t loop = 0; loop + 1 < begins_.size(); ++loop) {
    Vec2 a = corners_[begins_[loop + 1] - 1];
    for (std::size_t i = begins_[loop]; i < begins_[loop + 1]; ++i) {
      const Vec2& b = corners_[i];
      const bool from_below = is_vertex_above(a, vertex), to_below = is_vertex_above(b, vertex);
      if (from_below != to_below && is_vertex_left(a, b, vertex) == from_below) inside = !inside;
      a = b;
    }
  }
  return inside;
}

void OutlineMapper::complete_star(Index vertex) {
  Index h = mesh_->first_halfedge(vertex);
  while (!plane_.has(mesh_->to(h))) h = mesh_->rotate(h);
  const Index first = h;
  do {
    enter(Mesh::face_of(h));
    h = mesh_->rotate(h);
  } while (h != first);
}

void OutlineMapper::check_crossings() {
  std::sort(crossed_.begin(), crossed_.end());
  std::size_t odd = 0, mixed = 0;
  for (std::size_t i = 0; i < crossed_.size();) {
    const Index h = crossed_[i];
    std::size_t count = 0;
    for (; i < crossed_.size() && crossed_[i] == h; ++i) ++count;
    if (count % 2 == 0) continue;
    ++odd;
    if (has_inside(mesh_->from(h)) == has_inside(mesh_->to(h))) throw Failed(MapFailure::fold);
  }
  for (const Index vertex : outline_->inside) {
    for (const Index h : outgoing(*mesh_, vertex)) {
      if (!has_inside(mesh_->to(h))) ++mixed;
    }
  }
  if (mixed != odd) throw Failed(MapFailure::fold);
}

MapFailure map_shape(OutlineMapper& mapper, const Shape& shape, const Placement& placement, const DirectionField* field,
                     SurfaceOutline& outline, const MapLimits& limits) {
  if (field) {
    const std::optional<CenterLine> line = center_line(*field, placement, box_of(shape.loops(), placement));
    if (line) return mapper.map_along(shape.loops(), placement, *line, outline, limits);
  }
  return mapper.map(shape.loops(), placement, outline, limits);
}

}  // namespace saddleback
