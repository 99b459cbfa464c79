#include "geodesics/wavefront/curve_windows.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geodesics/wavefront/directions_at_point.h"
#include "support/planar.h"

namespace saddleback {
namespace {

constexpr double k_right_angle = std::numbers::pi / 2;
// A vertex nearer to a segment than this share of its face is on it, one this little beyond its ends beside it.
constexpr double k_on_curve = 1e-13;

Vec2 left_of(const Vec2& v) { return {-v.y(), v.x()}; }

RayWindow rays_from_foot(double along, int side) {
  return {Vec2::Zero(), 0, 0, 0, along, k_none, Rays::from_foot, static_cast<std::int8_t>(side), false};
}

}  // namespace

SurfacePoint end_point(const CurveSegment& segment, bool at_begin) {
  SurfacePoint point{segment.face, at_begin ? segment.begin : segment.end};
  for (int i = 0; i < 3; ++i)
    if (point.barycentric[i] <= k_on_curve) point.barycentric[i] = 0;
  point.barycentric = normalized_barycentric(point.barycentric);
  return point;
}

double direction_of(const Mesh& mesh, const DirectionsAtPoint& star, const CurveSegment& segment, bool at_begin) {
  const FaceChart chart(mesh, segment.face);
  Vec2 along = chart.to_plane(segment.end) - chart.to_plane(segment.begin);
  if (!at_begin) along = -along;
  return star.angle_of(segment.face, std::atan2(along.y(), along.x()));
}

void CurveWindows::from_curve(const SurfaceCurve& curve, const RayLimits& limits, std::vector<CurveFoot>& feet,
                              const JobStage& stage, const WatchedPlaces* places, const ReportRays& report) {
  feet.clear();
  field_.begin(places);
  const auto segments = curve.segments();
  stage.check();
  add_sources(curve);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    stage.update(static_cast<double>(i) / static_cast<double>(segments.size()));
    if (places) reach_places(segments[i]);
    emit_from_segment(segments[i], 1);
    emit_from_segment(segments[i], -1);
    if (i > 0) emit_from_bend(segments[i - 1], segments[i], segments[i].start, 0);
  }
  if (curve.closed()) {
    emit_from_bend(segments.back(), segments.front(), 0, 0);
  } else {
    emit_from_end(segments.front(), true, 0);
    emit_from_end(segments.back(), false, curve.length());
  }
  stage.update(1);
  field_.run(limits, stage, report);
  for (const Index vertex : field_.settled()) {
    const RayLabel& label = field_.label(vertex);
    const double distance = std::max(0.0, label.distance);
    const int side = distance > 0 ? label.side : 0;
    double along = std::clamp(label.value, 0.0, curve.length());
    if (curve.closed() && along >= curve.length() * (1 - k_on_curve)) along = 0;  // the end is the start
    feet.push_back({vertex, distance, along, static_cast<std::int8_t>(side), label.shadowed});
  }
}

/// No ray crosses the curve, whose vertices are where rays set out.
void CurveWindows::add_sources(const SurfaceCurve& curve) {
  for (const CurveSegment& s : curve.segments()) {
    field_.barriers().add(s.face, s.begin, s.end);
    for (const bool at_begin : {true, false}) {
      const Index vertex = vertex_at(mesh_, end_point(s, at_begin));
      if (vertex != k_none) field_.add_source(vertex, {0, at_begin ? s.start : s.start + s.length, 0, false});
    }
  }
}

void CurveWindows::from_border(std::span<const BorderPart> border, const RayLimits& limits, const WatchedPlaces* places,
                               const JobStage& stage) {
  field_.begin(places);
  for (const BorderPart& part : border) {
    stage.check();
    add_sources(*part.curve);
  }
  for (const BorderPart& part : border) {
    stage.check();
    const auto segments = part.curve->segments();
    for (std::size_t i = 0; i < segments.size(); ++i) {
      if (places) reach_places(segments[i]);
      emit_from_segment(segments[i], part.side);
      if (i > 0) emit_from_bend(segments[i - 1], segments[i], 0, part.side);
    }
    if (part.curve->closed())
      emit_from_bend(segments.back(), segments.front(), 0, part.side);
    else
      emit_from_corners(part, border);
  }
  field_.run(limits, stage);
}

/// Places in the segment's own face; where an end lies on an edge, in the face behind it as well.
void CurveWindows::reach_places(const CurveSegment& segment) {
  PlaceDistances& places = field_.places();
  const FaceChart chart(mesh_, segment.face);
  const Vec2 begin = chart.to_plane(segment.begin), end = chart.to_plane(segment.end);
  places.places().in_face(segment.face, [&](Index index, const Vec3& weights) {
    places.offer(index, distance_to_segment(chart.to_plane(weights), begin, end));
  });
  for (const bool at_begin : {true, false}) {
    const SurfacePoint point = end_point(segment, at_begin);
    for (int i = 0; i < 3; ++i) {
      const Index twin = mesh_.twin(3 * segment.face + (i + 1) % 3);
      if (point.barycentric[i] > 0 || twin == k_none) continue;
      const Index behind = Mesh::face_of(twin);
      const FaceChart other(mesh_, behind);
      const Vec2 place = other.to_plane(*barycentric_in(mesh_, point, behind));
      places.places().in_face(behind, [&](Index index, const Vec3& weights) {
        places.offer(index, (other.to_plane(weights) - place).norm());
      });
    }
  }
}

void CurveWindows::emit_from_segment(const CurveSegment& segment, int side) {
  const FaceChart chart(mesh_, segment.face);
  const Vec2 begin = chart.to_plane(segment.begin);
  const Vec2 tangent = (chart.to_plane(segment.end) - begin).normalized();
  const Vec2 normal = side * left_of(tangent);
  for (int i = 0; i < 3; ++i) {
    const Index g = 3 * segment.face + i;
    const Vec2 from = chart.corner[i], to = chart.corner[(i + 1) % 3];
    const double size = (to - from).norm();
    const double along = tangent.dot(from - begin), height = normal.dot(from - begin);
    if (along >= -k_on_curve * size && along <= segment.length + k_on_curve * size && height >= -k_on_curve * size) {
      const RayLabel label{std::abs(height) <= k_on_curve * size ? 0 : height,
                           segment.start + std::clamp(along, 0.0, segment.length), static_cast<std::int8_t>(side),
                           false};
      field_.offer(mesh_.from(g), label, angle_at_corner(unfolding_, g, chart, from - normal * size));
    }
    const Index entered = mesh_.twin(g);
    if (entered == k_none) continue;
    const Vec2 axis = (from - to) / size;  // of the entered half-edge, which starts where g ends
    const Vec2 ray(normal.dot(axis), cross(axis, normal));
    if (ray.y() <= k_on_curve) continue;
    // The part of the edge beside the segment, and on the right side of it.
    double b0 = 0, b1 = size;
    const auto keep = [&](double at_origin, double slope, double least) {  // at_origin + slope x >= least
      const double room = at_origin - least;
      if (std::abs(slope) <= k_on_curve) {
        if (room < -k_on_curve * size) b1 = b0;
      } else if (slope > 0) {
        b0 = std::max(b0, -room / slope);
      } else {
        b1 = std::min(b1, -room / slope);
      }
    };
    const double s = tangent.dot(to - begin), slope = tangent.dot(axis), h = normal.dot(to - begin);
    keep(s, slope, 0);
    keep(-s, -slope, -segment.length);
    keep(h, ray.x(), 0);
    if (b1 <= b0) continue;
    field_.add_window(
        {ray, b0, b1, h, segment.start + s, entered, Rays::perpendicular, static_cast<std::int8_t>(side), false});
  }
}

/// Emits from a bend: on the side where the curve turns away, rays from the bend fill the wedge between the segments'
/// own. On one side only, or on both for 0.
void CurveWindows::emit_from_bend(const CurveSegment& in, const CurveSegment& out, double along, int only) {
  const DirectionsAtPoint star(unfolding_, end_point(out, true));
  const double ahead = direction_of(mesh_, star, out, true);
  const double back = direction_of(mesh_, star, in, false);
  const double first = star.begin(), total = star.total_angle(), last = first + total;
  const auto emit = [&](double begin, double end, int side) {
    if (begin <= end && side != -only) star.emit(field_, rays_from_foot(along, side), begin, end);
  };
  if (star.is_round()) {
    const double left = back >= ahead ? back - ahead : back - ahead + total;
    emit(ahead + k_right_angle, ahead + left - k_right_angle, 1);
    emit(back + k_right_angle, back + (total - left) - k_right_angle, -1);
    return;
  }
  // Of the two sides one lies between the segments, the other is cut in two by the boundary.
  const bool left_between = back >= ahead;
  const double low = std::min(back, ahead), high = std::max(back, ahead);
  emit(low + k_right_angle, high - k_right_angle, left_between ? 1 : -1);
  emit(first, low - k_right_angle, left_between ? -1 : 1);
  emit(high + k_right_angle, last, left_between ? -1 : 1);
}

/// Emits from where a part of a border starts, into the wedge up to the next part that ends there; and, where one ends
/// at the mesh's boundary, into the wedge before it.
void CurveWindows::emit_from_corners(const BorderPart& part, std::span<const BorderPart> border) {
  struct Leaving {
    const CurveSegment& segment;
    bool at_begin;
  };
  const auto leaving = [](const BorderPart& from, bool at_start) -> Leaving {
    const bool at_begin = at_start == (from.side > 0);
    const auto segments = from.curve->segments();
    return {at_begin ? segments.front() : segments.back(), at_begin};
  };
  const auto emit = [&](const DirectionsAtPoint& star, double begin, double end) {
    if (begin <= end) star.emit(field_, rays_from_foot(0, 0), begin, end);
  };
  for (const bool at_start : {true, false}) {
    const auto [segment, at_begin] = leaving(part, at_start);
    const DirectionsAtPoint star(unfolding_, end_point(segment, at_begin));
    if (!at_start && star.is_round()) continue;
    const double own = direction_of(mesh_, star, segment, at_begin), total = star.total_angle();
    double wedge = star.is_round() ? total : at_start ? star.begin() + total - own : own - star.begin();
    bool meets = false;
    for (const BorderPart& other : border) {
      if (at_start ? other.end != part.start : other.start != part.end) continue;
      const auto [next, next_at_begin] = leaving(other, !at_start);
      double turn = direction_of(mesh_, star, next, next_at_begin) - own;
      if (!at_start) turn = -turn;
      if (turn < 0 && star.is_round()) turn += total;
      if (turn < 0) continue;
      wedge = std::min(wedge, turn);
      meets = true;
    }
    const double free = meets ? k_right_angle : 0;  // of the wedge at the other part, whose own rays fill it
    if (at_start)
      emit(star, own + k_right_angle, own + wedge - free);
    else if (!meets)
      emit(star, own - wedge, own - k_right_angle);
  }
}

/// Emits from an end: beyond an end all rays come from it; the curve run straight on tells left from right.
void CurveWindows::emit_from_end(const CurveSegment& segment, bool is_start, double along) {
  const DirectionsAtPoint star(unfolding_, end_point(segment, is_start));
  const double into = direction_of(mesh_, star, segment, is_start);
  const double first = star.begin(), total = star.total_angle(), last = first + total;
  const int after = is_start ? 1 : -1;  // the side that comes first when turning counter-clockwise from the curve
  const auto emit = [&](double begin, double end, int side) {
    if (begin <= end) star.emit(field_, rays_from_foot(along, side), begin, end);
  };
  if (star.is_round()) {
    emit(into + k_right_angle, into + total / 2, after);
    emit(into + total / 2, into + total - k_right_angle, -after);
  } else {
    emit(into + k_right_angle, last, after);
    emit(first, into - k_right_angle, -after);
  }
}

}  // namespace saddleback
