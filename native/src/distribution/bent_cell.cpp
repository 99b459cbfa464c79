#include "distribution/bent_cell.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "saddleback/mesh/trace.h"

namespace saddleback::distribution {
namespace {

constexpr double k_unknown = std::numeric_limits<double>::infinity();
/// Off the corners of a cell, which may be vertices, where the field has no direction.
constexpr double k_off = 0.01;
/// Copies between those at the corners may move a little farther than these.
constexpr double k_slack = 1.2;
constexpr Index k_border_corners = 24;

/// Where a point of the shape's plane is beside the curve, in mesh units.
Vec2 beside(const CenterLine& line, double scale, const Vec2& of_copy) {
  const double c = scale * std::cos(line.turn), s = scale * std::sin(line.turn);
  return {c * of_copy.x() - s * of_copy.y(), s * of_copy.x() + c * of_copy.y()};
}

const CurveSegment& segment_at(const SurfaceCurve& curve, double along) {
  const std::span<const CurveSegment> segments = curve.segments();
  const auto starts_after = [](double at, const CurveSegment& segment) { return at < segment.start; };
  return *(std::upper_bound(segments.begin() + 1, segments.end(), along, starts_after) - 1);
}

}  // namespace

BentCell::BentCell(const PlacingRules& rules, const PlacedShapes& settled, const Cell& cell, Index kind,
                   const Copy& copy)
    : rules_(rules), settled_(settled), cell_(cell), kind_(kind), center_{copy} {}

std::array<BentCell::Laid, 3>& BentCell::corners() {
  if (has_corners_) return corners_;
  has_corners_ = true;
  constexpr double k_at[3][2] = {{k_off, k_off}, {1 - 2 * k_off, k_off}, {k_off, 1 - 2 * k_off}};
  for (int i = 0; i < 3; ++i) {
    const SurfacePoint point = point_at(cell_.face, cell_.weights(k_at[i][0], k_at[i][1]));
    const double scale = rules_.smallest_factor() * rules_.size_at(rules_.kinds()[kind_].shape, point);
    corners_[i] = {rules_.copy(kind_, point, rules_.field_angle(kind_, point), scale)};
  }
  return corners_;
}

/// None where the field has no direction.
std::optional<BentCell::Place> BentCell::place_of(Laid& laid, const Vec2& of_copy) const {
  if (!laid.is_known) {
    laid.line = rules_.line(laid.copy.placement);
    laid.is_known = true;
  }
  if (!laid.line) return std::nullopt;
  const SurfaceCurve& curve = laid.line->curve;
  const Vec2 wanted = beside(*laid.line, laid.copy.placement.scale, of_copy);
  const double along = laid.line->origin + wanted.x();
  const CurveSegment& segment = segment_at(curve, along);
  const double share = std::clamp((along - segment.start) / segment.length, 0.0, 1.0);
  const SurfacePoint foot{segment.face, normalized_barycentric((1 - share) * segment.begin + share * segment.end)};
  const FaceChart chart(curve.mesh(), segment.face);
  const Vec2 ahead = chart.to_plane(segment.end) - chart.to_plane(segment.begin);
  // The plane is laid on straight beyond the ends of a curve.
  const Vec2 way(along - segment.start - share * segment.length, wanted.y());
  const double heading = std::atan2(ahead.y(), ahead.x()), turn = std::atan2(way.y(), way.x());
  const TraceEnd end = trace_end(curve.mesh(), foot, angle_about(curve.mesh(), foot, heading + turn), way.norm());
  return Place{end.point, end.angle - turn + laid.line->turn, end.hit_boundary ? way.norm() - end.length : 0};
}

/// The largest of what `measure` returns for the place of the point of a copy at a corner.
template <class Measure>
double BentCell::motion(const Vec2& of_copy, Measure&& measure) {
  double most = 0;
  for (Laid& corner : corners()) {
    const std::optional<Place> there = place_of(corner, of_copy);
    if (!there) return k_unknown;
    most = std::max(most, measure(*there));
  }
  return k_slack * most;
}

double BentCell::motion() {
  const Mesh& mesh = settled_.mesh();
  const CollisionShape& body = *center_.copy.body;
  double most = 0;
  for (const Vec2& side : {Vec2(0, 0), Vec2(1, 1), Vec2(1, -1), Vec2(-1, 1), Vec2(-1, -1)}) {
    const Vec2 point = side == Vec2::Zero() ? side : Vec2(body.box_center + side.cwiseProduct(body.box_half));
    const std::optional<Place> here = place_of(center_, point);
    if (!here) return k_unknown;
    most = std::max(most, motion(point, [&](const Place& there) { return apart(mesh, *here, there); }));
  }
  return most;
}

double BentCell::apart(const Mesh& mesh, const Place& a, const Place& b) {
  return (position(mesh, a.point) - position(mesh, b.point)).norm() + std::abs(a.beyond - b.beyond);
}

/// Looks at the point of a disk of the copy that is deepest in both: how deep it is in the other copy, against how far
/// it moves. Lengths are those of the other's plane, where its outline is what lies there.
bool BentCell::is_covered_by(const Copy& there, Index other, const Disk& disk, const Place& place, const Vec2& in_other,
                             const Vec2& x_axis, double radius, bool& meets) {
  const double scale = center_.copy.placement.scale, other_scale = there.placement.scale;
  const auto distance_at = [&](const Vec2& at) { return other_scale * there.body->distance.exact(at / other_scale); };
  const double distance = other_scale * there.body->distance.upper(in_other / other_scale);
  const double overlap = scale * disk.radius - distance;
  const double rounded = k_rounding * (center_.copy.radius() + there.radius());
  if (overlap <= (meets ? radius : rounded)) return false;  // it moves at least as far as the center
  Vec2 point = disk.center, found;
  if (const double step = disk.radius > 0 ? std::max(0.0, distance + 0.9 * overlap) : 0; step > 0) {
    const Vec2 way = there.body->distance.way_in(in_other / other_scale);
    point += step / scale * Vec2(x_axis.dot(way), x_axis.x() * way.y() - x_axis.y() * way.x());
    const std::optional<Place> deeper = place_of(center_, point);
    if (!deeper || deeper->beyond > 0 || !settled_.place_within(other, deeper->point, found)) return false;
  } else if (!settled_.place_within(other, place.point, found)) {
    return false;
  }
  const double depth = -distance_at(found) - rounded;
  if (depth <= 0) return false;
  meets = true;
  if (depth <= radius) return false;
  return depth > motion(point, [&](const Place& moved) {
           Vec2 at;
           return moved.beyond == 0 && settled_.place_within(other, moved.point, at) ? (at - found).norm() : k_unknown;
         });
}

bool BentCell::is_covered(double radius, bool& meets) {
  const double scale = center_.copy.placement.scale;
  for (const Disk& disk : center_.copy.body->disks) {
    const std::optional<Place> place = place_of(center_, disk.center);
    if (!place) return false;
    if (place->beyond > 0) continue;
    const Vec2 in_face = rules_.flat().place(place->point), x(std::cos(place->x_angle), std::sin(place->x_angle));
    const Vec2 weights(place->point.barycentric[1], place->point.barycentric[2]);
    if (settled_.visit(place->point.face, weights, scale * disk.radius,
                       [&](Index other, const Vec2& origin, const Eigen::Matrix2d& turn) {
                         const Copy& there = settled_.copies()[other];
                         const Vec2 at = origin + turn * in_face;
                         return at.norm() < there.radius() + scale * disk.radius &&
                                is_covered_by(there, other, disk, *place, at, (turn * x).normalized(), radius, meets);
                       }))
      return true;
  }
  return false;
}

bool BentCell::is_beyond_border(std::span<const std::uint8_t> forbidden, const std::vector<double>& depth,
                                bool& meets) {
  const CollisionShape& body = *center_.copy.body;
  const Mesh& mesh = settled_.mesh();
  Index number = 0;
  const Index stride = 1 + body.shape.corner_count() / k_border_corners;
  for (const Shape::Loop& loop : body.shape.loops())
    for (const Vec2& corner : loop) {
      if (number++ % stride != 0) continue;
      const std::optional<Place> place = place_of(center_, corner);
      if (!place) return false;
      double deep = place->beyond;
      if (deep == 0 && !depth.empty() && forbidden[place->point.face]) {
        deep = k_unknown;
        for (const Index vertex : mesh.triangles()[place->point.face]) deep = std::min(deep, depth[vertex]);
      }
      meets = meets || deep > 0;
      if (deep > 0 && deep > motion(corner, [&](const Place& moved) { return apart(mesh, *place, moved); }))
        return true;
    }
  return false;
}

}  // namespace saddleback::distribution
