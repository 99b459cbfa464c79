#include "geodesics/wavefront/directions_at_point.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "saddleback/mesh/surface_curve.h"

#include "mesh/tables/outgoing.h"
#include "support/planar.h"

namespace saddleback {
namespace {

constexpr double k_pi = std::numbers::pi;
// Corners this near to the border of a wedge belong to it.
constexpr double k_border = 1e-9;
// A point nearer to an edge than this share of its face is on it.
constexpr double k_on_edge = 1e-13;

double chart_angle(const FaceChart& chart, Index h) {
  const Vec2 along = chart.corner[(h + 1) % 3] - chart.corner[h % 3];
  return std::atan2(along.y(), along.x());
}

}  // namespace

double angle_at_corner(const Unfolding& unfolding, Index h, const FaceChart& chart, const Vec2& place) {
  const Vec2 corner = chart.corner[h % 3], along = chart.corner[(h + 1) % 3] - corner, there = place - corner;
  const double angle = std::atan2(cross(along, there), along.dot(there));
  return unfolding.polar(h) + std::clamp(angle, 0.0, unfolding.mesh().corner_angle(h));
}

DirectionsAtPoint::DirectionsAtPoint(const Unfolding& unfolding, const SurfacePoint& point)
    : unfolding_(unfolding), mesh_(unfolding.mesh()), point_(point), vertex_(vertex_at(mesh_, point)) {
  if (vertex_ != k_none) {
    total_ = mesh_.total_angle(vertex_);
    round_ = !mesh_.is_boundary(vertex_);
    for (const Index h : outgoing(mesh_, vertex_)) {
      const Index face = Mesh::face_of(h);
      sectors_.push_back({face, h, unfolding.polar(h), mesh_.corner_angle(h), chart_angle(FaceChart(mesh_, face), h)});
    }
    return;
  }
  total_ = 2 * k_pi;
  int opposite = -1;
  for (int i = 0; i < 3; ++i)
    if (point.barycentric[i] <= k_on_edge) opposite = i;
  if (opposite < 0) {
    sectors_.push_back({point.face, k_none, 0, total_, 0});
    return;
  }
  const Index g = 3 * point.face + (opposite + 1) % 3, t = mesh_.twin(g);
  point_.barycentric[opposite] = 0;
  const double along = chart_angle(FaceChart(mesh_, point.face), g);
  sectors_.push_back({point.face, k_none, along, k_pi, along});
  round_ = t != k_none;
  if (!round_) {
    total_ = k_pi;
    return;
  }
  const Index other = Mesh::face_of(t);
  sectors_.push_back({other, k_none, along + k_pi, k_pi, chart_angle(FaceChart(mesh_, other), t)});
}

double DirectionsAtPoint::angle_of(Index face, double chart_angle) const {
  for (const Sector& sector : sectors_) {
    if (sector.face != face) continue;
    double turn = std::remainder(chart_angle - sector.chart_begin, 2 * k_pi);
    if (sector.size >= 2 * k_pi) return sector.begin + turn;
    // Rounding may put a direction along the sector's border on its other side; a turn near -pi is one near pi.
    if (turn < 0 && turn + k_pi < -turn) turn += 2 * k_pi;
    return sector.begin + std::clamp(turn, 0.0, sector.size);
  }
  return chart_angle;
}

void DirectionsAtPoint::emit(WavefrontDistances& field, const RayWindow& window, double begin, double end) const {
  for (const Sector& sector : sectors_) {
    for (int round = round_ ? -2 : 0; round <= (round_ ? 2 : 0); ++round) {
      const double shift = round * total_;
      const double from = std::max(begin - shift, sector.begin), to = std::min(end - shift, sector.begin + sector.size);
      if (to - from < -k_border || (to < from && end - begin > k_border)) continue;
      emit_into(field, window, sector, from, std::max(from, to));
    }
  }
}

void DirectionsAtPoint::emit_into(WavefrontDistances& field, const RayWindow& window, const Sector& sector,
                                  double begin, double end) const {
  if (sector.leaving != k_none) return emit_from_corner(field, window, sector, begin, end);
  emit_inside(field, window, sector, begin, end);
}

void DirectionsAtPoint::emit_from_corner(WavefrontDistances& field, RayWindow window, const Sector& sector,
                                         double begin, double end) const {
  const Index h = sector.leaving, last = Mesh::prev(h);
  const double from = begin - sector.begin, to = end - sector.begin;
  const auto label = [&](double distance, double angle) {
    const double value = window.rays == Rays::from_point ? angle : window.value;
    return RayLabel{window.offset + distance, value, window.side, window.shadowed};
  };
  if (from <= k_border) field.offer(mesh_.to(h), label(mesh_.length(h), sector.begin), unfolding_.polar_of_reverse(h));
  if (to >= sector.size - k_border) {
    const double angle = sector.begin + sector.size;
    field.offer(mesh_.from(last), label(mesh_.length(last), angle), unfolding_.polar(last));
  }
  if (!window_of_corner(unfolding_, h, from, to, window)) return;
  // The x axis of the entered half-edge's frame is the opposite edge run backwards.
  if (window.rays == Rays::from_point) window.value = sector.begin - mesh_.corner_angle(Mesh::next(h));
  field.add_window(window);
}

void DirectionsAtPoint::emit_inside(WavefrontDistances& field, RayWindow window, const Sector& sector, double begin,
                                    double end) const {
  const FaceChart chart(mesh_, sector.face);
  const auto b = barycentric_in(mesh_, point_, sector.face, k_on_edge);
  const Vec2 place = chart.to_plane(b.value_or(point_.barycentric));
  const double first = sector.chart_begin + (begin - sector.begin), width = end - begin;  // in the chart
  const double to_direction = sector.begin - sector.chart_begin;
  for (int i = 0; i < 3; ++i) {
    const Index g = 3 * sector.face + i;
    const Vec2 from = chart.corner[i] - place, to = chart.corner[(i + 1) % 3] - place;
    // The corner's direction after `first`: 0 to 2 pi, but for rounding before `first`. From a point beside the corner
    // rounding is all the more.
    const double border = std::min(k_border + k_on_edge * mesh_.length(g) / from.norm(), k_pi / 2);
    double start = std::remainder(std::atan2(from.y(), from.x()) - first, 2 * k_pi);
    if (start < -border) start += 2 * k_pi;
    if (start <= width + border) {
      const double angle = first + start + to_direction;
      const double value = window.rays == Rays::from_point ? angle : window.value;
      field.offer(mesh_.from(g), {window.offset + from.norm(), value, window.side, window.shadowed},
                  angle_at_corner(unfolding_, g, chart, place));
    }
    const Index entered = mesh_.twin(g);
    const double spread = std::atan2(cross(from, to), from.dot(to));
    if (entered == k_none || spread <= 0 || (b && (*b)[(i + 2) % 3] <= k_on_edge)) continue;
    const double base = mesh_.length(g);
    const Vec2 axis = (from - to) / base;  // of the entered half-edge, which starts where g ends
    const Vec2 source(-to.dot(axis), -cross(axis, to));
    const auto met = [&](double turn) {
      const Vec2 ray(std::cos(first + turn), std::sin(first + turn));
      const Vec2 own(ray.dot(axis), cross(axis, ray));
      return own.y() > 0 ? std::clamp(source.x() - source.y() * own.x() / own.y(), 0.0, base) : 0.0;
    };
    window.source = {source.x(), std::min(0.0, source.y())};
    window.halfedge = entered;
    if (window.rays == Rays::from_point) window.value = std::atan2(axis.y(), axis.x()) + to_direction;
    const bool all_round = width >= 2 * k_pi - k_border;
    // The edge lies between `start` and its end, which may be beyond a whole turn.
    for (const double from_start : {start, start - 2 * k_pi}) {
      const double right = std::max(0.0, from_start), left = std::min(width, from_start + spread);
      if (!all_round && left <= right) continue;
      window.b0 = all_round || left >= from_start + spread ? 0 : met(left);
      window.b1 = all_round || right <= from_start ? base : met(right);
      if (window.b1 > window.b0) field.add_window(window);
      if (all_round) break;
    }
  }
}

}  // namespace saddleback
