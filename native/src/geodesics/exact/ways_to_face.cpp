#include "geodesics/exact/ways_to_face.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saddleback/mesh/surface_points.h"

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
// The margin by which a way must be longer, relative to its length: rounding stays far below it.
constexpr double k_margin = 1e-11;

/// Tells whether ways through it leap: along the line of their edge, beyond the window's ends.
bool leaps(const KeptWindow& window) { return window.sy == 0 && std::isfinite(window.b0); }

}  // namespace

WaysToFace::WaysToFace(const ExactSurface& surface, const ExactPropagation& propagation, const KeptWindows& windows,
                       std::span<const Index> nearest, Index face)
    : surface_(&surface) {
  if (!surface.holds(face)) return;
  first_ = 3 * surface.face_of(face);
  const auto add = [&](const KeptWindow& window, Index root, const Vec2& image, int edge) {
    const bool is_vertex = root < surface.vertex_count();
    const Index source = is_vertex ? nearest[surface.mesh_vertex(root)] : root - surface.vertex_count();
    ways_.push_back(
        {window, is_vertex ? propagation.distance(root) : 0, image, source, static_cast<std::int8_t>(edge)});
    sources_.push_back(source);
  };
  for (const SourceInFace& source : surface.sources_in(first_ / 3)) {
    const Vec2 image = surface.in_frame(first_, source.barycentric);
    add({image.x(), image.y(), -k_infinity, k_infinity}, surface.vertex_count() + source.source, image, 0);
  }
  for (int edge = 0; edge < 3; ++edge) {
    const Vec2 start = surface.in_frame(first_, Vec3::Unit(edge)),
               end = surface.in_frame(first_, Vec3::Unit((edge + 1) % 3)), along = (end - start).normalized(),
               up(-along.y(), along.x());
    add({0, 0, -k_infinity, k_infinity}, surface.frame(first_ + edge).from, start, edge);
    windows.visit(first_ + edge,
                  [&](const KeptWindow& w, Index root) { add(w, root, Vec2(start + w.sx * along + w.sy * up), edge); });
  }
  std::ranges::sort(sources_);
  sources_.erase(std::ranges::unique(sources_).begin(), sources_.end());
  for (Way& way : ways_)
    way.source = static_cast<Index>(std::ranges::lower_bound(sources_, way.source) - sources_.begin());
}

WaysToFace::Places WaysToFace::places_of(const Vec3& barycentric) const {
  return {surface_->in_frame(first_, barycentric), surface_->in_frame(first_ + 1, barycentric),
          surface_->in_frame(first_ + 2, barycentric)};
}

void WaysToFace::at(const Vec3& barycentric, std::vector<ExactField::Way>& ways) const {
  ways.clear();
  for (const Index source : sources_) ways.push_back({source, k_infinity, 0, Vec2::Zero()});
  const Places places = places_of(barycentric);
  for (const Way& way : ways_) {
    ExactField::Way& best = ways[way.source];
    if (const double distance = through(way, places).distance; distance < best.distance)
      best = {best.source, distance, way.before, way.image};
  }
}

ExactField::Sight WaysToFace::nearest_at(const Vec3& barycentric) const {
  const Places places = places_of(normalized_barycentric(barycentric));
  ExactField::Sight nearest{k_none, k_infinity};
  for (const Way& way : ways_)
    if (const double distance = through(way, places).distance; distance < nearest.distance)
      nearest = {sources_[way.source], distance};
  return nearest;
}

/// The length of a way is a convex function of its end: no less than the plane that touches it in the middle, and in
/// the triangle no more than the plane through what it is at the corners. So of two ways from one source one is longer
/// everywhere if by these bounds it is so at the corners.
void WaysToFace::find_inside(const std::array<Vec3, 3>& corners, WaysToFace& result) const {
  struct Bound {
    double at_middle = k_infinity;
    std::array<double, 3> most{};
  };
  result.surface_ = surface_;
  result.first_ = first_;
  result.sources_ = sources_;
  result.ways_.clear();
  const Places middle = places_of((corners[0] + corners[1] + corners[2]) / 3);
  const std::array<Places, 3> at{places_of(corners[0]), places_of(corners[1]), places_of(corners[2])};
  std::vector<Bound> bounds(sources_.size());
  for (const Way& way : ways_) {
    Bound& bound = bounds[way.source];
    const double length = through(way, middle).distance;
    if (leaps(way.window) || !(length < bound.at_middle)) continue;
    bound.at_middle = length;
    for (int i = 0; i < 3; ++i) bound.most[i] = (1 + k_margin) * through(way, at[i]).distance;
  }
  for (const Way& way : ways_) {
    const Bound& bound = bounds[way.source];
    const WayThrough there = through(way, middle);
    const Vec2 &place = middle[way.edge], slope = (place - there.last_bend).normalized();
    const auto is_longer = [&](int i) { return there.distance + slope.dot(at[i][way.edge] - place) > bound.most[i]; };
    if (leaps(way.window) || there.distance <= bound.at_middle || !(is_longer(0) && is_longer(1) && is_longer(2)))
      result.ways_.push_back(way);
  }
}

}  // namespace saddleback
