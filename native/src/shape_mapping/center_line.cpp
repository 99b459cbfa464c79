#include "shape_mapping/center_line.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace saddleback {
namespace {

/// Curvature of the line times half the width of what is laid along it. On the inner side lengths shrink by this share,
/// which has to stay below a half (MapLimits) with something to spare for the surface's own curvature.
constexpr double k_most_bend = 0.4;
/// The line is longer than the shape by this factor, so that its outline has feet on both ends.
constexpr double k_spare_length = 1.05;

/// The field's direction nearest to an angle, in the chart of the point's face.
double nearest_direction(const DirectionField& field, const SurfacePoint& point, double angle) {
  const double quantum = 2 * std::numbers::pi / field.symmetry();
  const double base = field.angle_at(point);
  return base + quantum * std::round((angle - base) / quantum);
}

PlaneBox turned(const PlaneBox& box, double angle) {
  const Vec2 x(std::cos(angle), std::sin(angle)), y(-x.y(), x.x());
  PlaneBox result{Vec2::Zero(), Vec2::Zero()};
  for (const double a : {box.low.x(), box.high.x()})
    for (const double b : {box.low.y(), box.high.y()}) {
      const Vec2 corner = a * x + b * y;
      result.low = result.low.cwiseMin(corner);
      result.high = result.high.cwiseMax(corner);
    }
  return result;
}

}  // namespace

PlaneBox box_of(std::span<const std::vector<Vec2>> loops, const Placement& placement) {
  PlaneBox box{Vec2::Zero(), Vec2::Zero()};
  for (const std::vector<Vec2>& loop : loops)
    for (const Vec2& point : loop) {
      const Vec2 corner = placement.scale * Vec2(point.x(), placement.mirrored ? -point.y() : point.y());
      box.low = box.low.cwiseMin(corner);
      box.high = box.high.cwiseMax(corner);
    }
  return box;
}

std::optional<CenterLine> center_line(const DirectionField& field, const Placement& placement, const PlaneBox& box) {
  const Mesh& mesh = field.mesh();
  const double along = nearest_direction(field, placement.center, placement.angle);
  const double turn = placement.angle - along;
  const PlaneBox reach = turned(box, turn);
  const double half_length = std::max(-reach.low.x(), reach.high.x());
  const double half_width = std::max(-reach.low.y(), reach.high.y());
  const StreamlineOptions options{.length = 2 * k_spare_length * half_length,
                                  .both = true,
                                  .heading = direction_in_space(mesh, placement.center.face, along),
                                  .max_curvature = k_most_bend / half_width};
  Streamline line = streamline(field, placement.center, options);
  if (!(line.path.length > 0)) return std::nullopt;
  double origin = 0;
  for (std::size_t i = 0; i < line.start; ++i) origin += (line.path.points[i + 1] - line.path.points[i]).norm();
  return CenterLine{SurfaceCurve(mesh, std::move(line.path.surface)), origin, turn};
}

}  // namespace saddleback
