// A shortest path ends with a straight line from a root. It is followed backwards from face to face, the image of the
// root unfolded with it, until a face has the root where its image is; the root is a source or a vertex, from which the
// path goes on backwards by the vertex's own arrival. A line that meets a vertex on its way does not depend on which
// side of it rounding says: it ends there, and the path goes on by the arrival of that vertex, which is no longer way.

#include "geodesics/exact/exact_path.h"

#include <algorithm>
#include <cmath>

#include "saddleback/error.h"
#include "saddleback/mesh/surface_curve.h"

#include "support/planar.h"

namespace saddleback {
namespace {

// Relative to the face: a line this near to a vertex meets it, up to rounding.
constexpr double k_meet = 1e-12;
// Relative to the face: the unfolded image of a root is off its place by rounding and by what the gaps between windows
// allow (k_miss in the propagation).
constexpr double k_same_place = 1e-5;

}  // namespace

ExactTracer::ExactTracer(const ExactSurface& surface, const SurfacePoints& sources, const ExactPropagation& propagation,
                         const KeptWindows& windows)
    : surface_(surface), sources_(sources), propagation_(propagation), windows_(windows) {}

SurfacePoint ExactTracer::on_edge(Index halfedge, double place) const {
  const Index h = surface_.mesh_halfedge(halfedge);
  const double share = std::clamp(place / surface_.frame(halfedge).length, 0.0, 1.0);
  Vec3 b = Vec3::Zero();
  b[h % 3] = 1 - share;
  b[Mesh::next(h) % 3] = share;
  return {Mesh::face_of(h), b};
}

Approach ExactTracer::approach(const SurfacePoint& point) const {
  const Mesh& mesh = surface_.mesh();
  if (!surface_.holds(point.face)) return {};
  if (const Index vertex = vertex_at(mesh, point); vertex != k_none) return approach_vertex(surface_.vertex_of(vertex));
  const Vec3 b = normalized_barycentric(point.barycentric);
  const Index first = 3 * surface_.face_of(point.face);
  Approach best;
  for (const SourceInFace& source : surface_.sources_in(first / 3)) {
    const double distance = (surface_.in_frame(first, b) - surface_.in_frame(first, source.barycentric)).norm();
    if (distance < best.distance) best = {distance, surface_.vertex_count() + source.source, {}};
  }
  for (Index h = first; h < first + 3; ++h) {
    const Vec2 place = surface_.in_frame(h, b);
    const Index corner = surface_.frame(h).from;
    const double round_corner = propagation_.distance(corner) + place.norm();
    if (round_corner < best.distance) best = {round_corner, corner, {}};
    SightLine line;
    line.distance = best.distance;
    windows_.improve(h, place, line);
    if (line.halfedge != k_none) best = {line.distance, line.root, line};
  }
  return best;
}

Approach ExactTracer::approach_vertex(Index vertex) const {
  const Arrival& arrival = propagation_.arrival(vertex);
  Approach result{propagation_.distance(vertex), arrival.root, {}};
  if (arrival.halfedge == Arrival::k_at_source) result.root = surface_.vertex_count() + arrival.root;
  if (arrival.halfedge < 0) return result;
  for (const SourceInFace& source : surface_.sources_in(arrival.halfedge / 3))
    if (surface_.vertex_count() + source.source == arrival.root) return result;
  const EdgeFrame& frame = surface_.frame(arrival.halfedge);
  windows_.improve(arrival.halfedge, {frame.apex_x, frame.apex_y}, result.line);
  return result;
}

/// Tells whether the root lies in the face of the half-edge, where `image` is.
bool ExactTracer::is_image_of(Index root, Index halfedge, const Vec2& image) const {
  const EdgeFrame& frame = surface_.frame(halfedge);
  const double reach = k_same_place * (frame.length + frame.left_length + frame.right_length);
  if (root == frame.apex) return (image - Vec2(frame.apex_x, frame.apex_y)).norm() <= reach;
  if (root == frame.from) return image.norm() <= reach;
  if (root == frame.to) return (image - Vec2(frame.length, 0)).norm() <= reach;
  for (const SourceInFace& source : surface_.sources_in(halfedge / 3))
    if (surface_.vertex_count() + source.source == root)
      return (image - surface_.in_frame(halfedge, source.barycentric)).norm() <= reach;
  return false;
}

/// Follows the line from a point of the face of line.halfedge back along the line to its root, or to a vertex that it
/// meets on the way; returns which. Notes down the edges crossed.
Index ExactTracer::follow(const SightLine& line, const Vec2& from, SurfacePoints& backwards) const {
  const EdgeFrame* frame = &surface_.frame(line.halfedge);
  if (line.crossing <= k_meet * frame->length) return frame->from;
  if (line.crossing >= (1 - k_meet) * frame->length) return frame->to;
  if (from.y() > 0) backwards.push_back(on_edge(line.halfedge, line.crossing));
  // From here on in the frame of the half-edge through which the next face is entered, at (place, 0).
  Index h = surface_.twin(line.halfedge);
  double place = frame->length - line.crossing;
  Vec2 image(frame->length - line.image.x(), -line.image.y());
  for (Index faces = 0; faces < surface_.halfedge_count(); ++faces) {
    if (is_image_of(line.root, h, image)) return line.root;
    frame = &surface_.frame(h);
    const Vec2 apex(frame->apex_x, frame->apex_y), here(place, 0), ahead = image - here, to_apex = apex - here;
    const double side = cross(ahead, to_apex);
    const double size = frame->length + frame->left_length + frame->right_length;
    const bool goes_right = side > 0;
    const Index exit = goes_right ? frame->right : frame->left;
    const double along_line = ahead.dot(to_apex);
    const bool is_between = along_line > 0 && along_line < ahead.squaredNorm();  // not beyond the root
    if ((is_between && std::abs(side) <= k_meet * size * ahead.norm()) || exit == k_none) return frame->apex;
    const Vec2 origin = goes_right ? apex : Vec2(0, 0);
    const double length = goes_right ? frame->right_length : frame->left_length;
    const Vec2 along = (goes_right ? Vec2(frame->to_end(), -apex.y()) : apex) / length;
    const auto turned = [&](const Vec2& p) { return Vec2(along.dot(p - origin), cross(along, p - origin)); };
    const Vec2 back = turned(here);
    image = turned(image);
    place = std::clamp(back.x() - (image.x() - back.x()) * (back.y() / (image.y() - back.y())), 0.0, length);
    h = exit;
    backwards.push_back(on_edge(h, place));
  }
  throw Error("a shortest path could not be followed back to its source");
}

GeodesicPath ExactTracer::path(const SurfacePoint& target) const {
  const Mesh& mesh = surface_.mesh();
  const Index vertices = surface_.vertex_count();
  SurfacePoints backwards{{target.face, normalized_barycentric(target.barycentric)}};
  Approach last = approach(target);
  Vec2 from =
      last.line.halfedge == k_none ? Vec2::Zero() : surface_.in_frame(last.line.halfedge, backwards[0].barycentric);
  if (vertex_at(mesh, target) != k_none) from = Vec2(0, 1);  // never on the half-edge that it is the apex of
  Index at = vertex_at(mesh, target) == k_none ? k_none : surface_.vertex_of(vertex_at(mesh, target));
  while (at == k_none || propagation_.arrival(at).halfedge != Arrival::k_at_source) {
    const Index root = last.line.halfedge == k_none ? last.root : follow(last.line, from, backwards);
    if (root >= vertices) {
      backwards.push_back(sources_[root - vertices]);
      break;
    }
    backwards.push_back(at_vertex(mesh, surface_.mesh_vertex(root)));
    at = root;
    last = approach_vertex(at);
    from = Vec2(0, 1);
  }
  GeodesicPath result;
  result.surface.assign(backwards.rbegin(), backwards.rend());
  result.points.reserve(result.surface.size());
  for (const SurfacePoint& point : result.surface) result.points.push_back(position(mesh, point));
  for (std::size_t i = 1; i < result.surface.size(); ++i)
    result.length += step_length(mesh, result.surface[i - 1], result.surface[i]);
  return result;
}

}  // namespace saddleback
