#include "geodesics/unfolding/chain_points.h"

#include <algorithm>

#include "saddleback/mesh/surface_curve.h"

namespace saddleback {
namespace {

// A crossing this near to an end of its edge is at the vertex: as a share of the edge or, where that is less than the
// mean edge, of the mean edge, so that long and short edges of a vertex agree; but never more than a small share.
constexpr double k_at_vertex = 1e-12, k_at_most = 1e-6;

}  // namespace

void append_points(const Mesh& mesh, const LegChain& chain, std::vector<Vec3>& points, SurfacePoints& surface) {
  const std::size_t first = points.size();
  const auto is_last = [&](const SurfacePoint& point, const Vec3& place) {
    return mesh.is_intrinsic() ? step_length(mesh, surface.back(), point) == 0 : points.back() == place;
  };
  const auto add = [&](const SurfacePoint& point, const Vec3& place) {
    if (points.size() > first && is_last(point, place)) {
      surface.back() = point;
      return;
    }
    points.push_back(place);
    surface.push_back(point);
  };
  const auto add_crossing = [&](Index h, double t) {
    double b = t;
    if (t < k_at_most || t > 1 - k_at_most) {
      const double near = std::min(k_at_most, k_at_vertex * std::max(1.0, mesh.mean_edge_length() / mesh.length(h)));
      b = t < near ? 0 : t > 1 - near ? 1 : t;
    }
    const double a = 1 - b;
    SurfacePoint point{Mesh::face_of(h), Vec3::Zero()};
    point.barycentric[h % 3] = a;
    point.barycentric[(h + 1) % 3] = b;
    add(point, a * mesh.position(mesh.from(h)) + b * mesh.position(mesh.to(h)));
  };
  const auto add_end = [&](const LegEnd& end) { add(end.point, position(mesh, end.point)); };
  add_end(chain.ends[0]);
  for (std::size_t i = 0; i < chain.leg_count; ++i) {
    const UnfoldedArc& leg = chain.legs[i];
    for (std::size_t k = 0; k < leg.entered.size(); ++k) add_crossing(leg.entered[k], leg.crossings[k]);
    add_end(chain.ends[i + 1]);
  }
}

}  // namespace saddleback
