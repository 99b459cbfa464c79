#include "shape_mapping/curve_bend.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "saddleback/mesh/mesh.h"

namespace saddleback {
namespace {

double angle_of(const Vec2& v) { return std::atan2(v.y(), v.x()); }

double chart_angle(const FaceChart& chart, int i) { return angle_of(chart.corner[(i + 1) % 3] - chart.corner[i]); }

/// Returns the angle of a segment in the chart of its face.
double angle_in(const FaceChart& chart, const CurveSegment& segment) {
  return angle_of(chart.to_plane(segment.end) - chart.to_plane(segment.begin));
}

/// Returns the turn from one segment to the next; 0 through a vertex, where no face tells.
double turn_between(const Mesh& mesh, const CurveSegment& a, const CurveSegment& b) {
  const FaceChart here(mesh, a.face), there(mesh, b.face);
  double turn = angle_in(there, b) - angle_in(here, a);
  if (a.face == b.face) return std::remainder(turn, 2 * std::numbers::pi);
  for (int i = 0; i < 3; ++i) {
    const Index twin = mesh.twin(3 * a.face + i);
    if (twin == k_none || Mesh::face_of(twin) != b.face) continue;
    turn += chart_angle(here, i) - chart_angle(there, twin % 3) - std::numbers::pi;
    return std::remainder(turn, 2 * std::numbers::pi);
  }
  return 0;
}

}  // namespace

void CurveBend::measure(const SurfaceCurve& curve, double origin) {
  places_.clear();
  headings_.clear();
  double sum = 0;
  const std::span<const CurveSegment> segments = curve.segments();
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (i > 0) sum += turn_between(curve.mesh(), segments[i - 1], segments[i]);
    places_.push_back(segments[i].start + 0.5 * segments[i].length - origin);
    headings_.push_back(sum);
  }
}

double CurveBend::heading(double place) const {
  const auto after =
      static_cast<std::size_t>(std::lower_bound(places_.begin(), places_.end(), place) - places_.begin());
  if (after == 0) return headings_.front();
  if (after == places_.size()) return headings_.back();
  const double share = (place - places_[after - 1]) / (places_[after] - places_[after - 1]);
  return headings_[after - 1] + share * (headings_[after] - headings_[after - 1]);
}

double CurveBend::curvature(double place, double reach) const {
  return (heading(place + reach) - heading(place - reach)) / (2 * reach);
}

}  // namespace saddleback
