#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <set>

#include "saddleback/error.h"
#include "saddleback/tessellation/cell_polygons.h"

#include "tessellation/cells/cell_topology.h"

namespace saddleback {
namespace {

// A middle is no nearer than this share of the boundary's length to its ends: quads would have sides of no length.
constexpr double k_least_share = 0.1;

using Edge = std::pair<Index, Index>;

/// The mesh's edge on whose line a point of a face lies, if any: at a vertex one of them.
std::optional<Edge> edge_at(const Mesh& mesh, const SurfacePoint& point) {
  for (int i = 0; i < 3; ++i) {
    if (point.barycentric[i] != 0) continue;
    const Triangle& face = mesh.triangles()[point.face];
    return std::minmax(face[(i + 1) % 3], face[(i + 2) % 3]);
  }
  return std::nullopt;
}

/// The mesh's edges along which curves run, and their vertices.
class CurveEdges {
 public:
  CurveEdges(const Mesh& mesh, std::span<const SurfaceCurve* const> curves) : mesh_(mesh) {
    for (const SurfaceCurve* const curve : curves)
      for (const CurveSegment& segment : curve->segments()) add(segment);
  }
  bool any() const { return !edges_.empty(); }
  bool has(const SurfacePoint& point) const {
    if (const Index vertex = vertex_at(mesh_, point); vertex != k_none) return vertices_.contains(vertex);
    const std::optional<Edge> edge = edge_at(mesh_, point);
    return edge && edges_.contains(*edge);
  }

 private:
  void add(const CurveSegment& segment) {
    for (int i = 0; i < 3; ++i) {
      if (segment.begin[i] != 0 || segment.end[i] != 0) continue;
      const Triangle& face = mesh_.triangles()[segment.face];
      const Edge edge = std::minmax(face[(i + 1) % 3], face[(i + 2) % 3]);
      edges_.insert(edge);
      vertices_.insert({edge.first, edge.second});
    }
  }
  const Mesh& mesh_;
  std::set<Edge> edges_;
  std::set<Index> vertices_;
};

/// The share [0, 1] of the way along one segment at which it is nearest to another.
double nearest_share(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  const Vec3 along = q - p, other = b - a, between = p - a;
  const double aa = along.squaredNorm(), bb = other.squaredNorm(), ab = along.dot(other);
  const double ap = along.dot(between), bp = other.dot(between), turned = aa * bb - ab * ab;
  double s = turned > 1e-12 * aa * bb ? std::clamp((ab * bp - ap * bb) / turned, 0.0, 1.0) : 0.5;
  const double t = bb > 0 ? std::clamp((ab * s + bp) / bb, 0.0, 1.0) : 0.0;
  if (aa > 0) s = std::clamp((ab * t - ap) / aa, 0.0, 1.0);
  return s;
}

double distance_to(const Vec3& point, const Vec3& a, const Vec3& b) {
  const Vec3 way = b - a;
  const double square = way.squaredNorm();
  return (point - a - (square > 0 ? std::clamp((point - a).dot(way) / square, 0.0, 1.0) : 0.0) * way).norm();
}

class QuadMaker {
 public:
  QuadMaker(const Mesh& mesh, const GeodesicVoronoi& cells, std::span<const SurfaceCurve* const> curves)
      : mesh_(mesh), cells_(cells), curves_(mesh, curves) {}

  DualQuads make() {
    result_.points = cells_.sites;
    std::vector<Index> middle_of(cells_.edge_cells.size(), k_none);
    for (std::size_t polyline = 0; polyline < middle_of.size(); ++polyline) {
      if (cells_.edge_closed[polyline]) continue;
      middle_of[polyline] = static_cast<Index>(result_.points.size());
      result_.points.push_back(middle(static_cast<Index>(polyline)));
    }
    const PointStars stars(cells_);
    for (const Index branch : cells_.branch_points) {
      const auto center = static_cast<Index>(result_.points.size());
      result_.points.push_back(cells_.points[branch]);
      for (const PointStars::Ray& ray : stars.rays(branch)) {
        const auto next = std::ranges::find(stars.rays(branch), ray.left, &PointStars::Ray::right);
        if (next == stars.rays(branch).end()) continue;  // at the mesh's boundary
        result_.quads.push_back({center, middle_of[ray.polyline], ray.left, middle_of[next->polyline]});
      }
    }
    for (const SurfacePoint& point : result_.points) result_.vertices.push_back(position(mesh_, point));
    return std::move(result_);
  }

 private:
  SurfacePoint middle(Index polyline) const {
    const std::span way(cells_.edge_points.data() + cells_.edge_offsets[polyline],
                        cells_.edge_points.data() + cells_.edge_offsets[polyline + 1]);
    const auto& [left, right] = cells_.edge_cells[polyline];
    const SurfacePoint &a = cells_.sites[left], &b = cells_.sites[right];
    if (is_on_boundary(mesh_, a) && is_on_boundary(mesh_, b))
      for (const Index end : {way.front(), way.back()})
        if (is_on_boundary(mesh_, cells_.points[end])) return cells_.points[end];
    const Vec3 first = position(mesh_, a), second = position(mesh_, b);
    const Index crossing = curves_.any() && curves_.has(a) && curves_.has(b) ? crossing_of(way, first, second) : k_none;
    return crossing != k_none ? cells_.points[crossing] : nearest(way, first, second);
  }

  /// The point of a boundary on a curve, of several the one nearest to the edge.
  Index crossing_of(std::span<const Index> way, const Vec3& a, const Vec3& b) const {
    Index best = k_none;
    for (const Index point : way.subspan(1, way.size() - 2)) {
      if (!curves_.has(cells_.points[point])) continue;
      const auto off = [&](Index i) { return distance_to(cells_.positions[i], a, b); };
      if (best == k_none || off(point) < off(best)) best = point;
    }
    return best;
  }

  SurfacePoint nearest(std::span<const Index> way, const Vec3& a, const Vec3& b) const {
    std::vector<double> length{0};
    for (std::size_t i = 1; i < way.size(); ++i)
      length.push_back(length.back() + (cells_.positions[way[i]] - cells_.positions[way[i - 1]]).norm());
    const double begin = k_least_share * length.back(), end = length.back() - begin;
    SurfacePoint best = cells_.points[way[way.size() / 2]];
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < way.size(); ++i) {
      const double step = length[i] - length[i - 1];
      if (step <= 0 || length[i] < begin || length[i - 1] > end) continue;
      const Vec3 &p = cells_.positions[way[i - 1]], &q = cells_.positions[way[i]];
      const double share = std::clamp(nearest_share(p, q, a, b), std::max(0.0, (begin - length[i - 1]) / step),
                                      std::min(1.0, (end - length[i - 1]) / step));
      const double off = distance_to(p + share * (q - p), a, b);
      if (off >= least) continue;
      least = off;
      best = between(cells_.points[way[i - 1]], cells_.points[way[i]], share);
    }
    return best;
  }

  SurfacePoint between(const SurfacePoint& p, const SurfacePoint& q, double share) const {
    const Index face = shared_face(mesh_, p, q, k_barycentric_tolerance);
    const Vec3 begin = *barycentric_in(mesh_, p, face, k_barycentric_tolerance);
    const Vec3 end = *barycentric_in(mesh_, q, face, k_barycentric_tolerance);
    return {face, normalized_barycentric((1 - share) * begin + share * end)};
  }

  const Mesh& mesh_;
  const GeodesicVoronoi& cells_;
  const CurveEdges curves_;
  DualQuads result_;
};

}  // namespace

DualQuads dual_quads(const Mesh& mesh, const GeodesicVoronoi& cells, std::span<const SurfaceCurve* const> curves) {
  for (const SurfaceCurve* const curve : curves)
    if (curve->mesh().fingerprint() != mesh.fingerprint())
      throw InputError("curves: wanted curves of the mesh of the cells");
  return QuadMaker(mesh, cells, curves).make();
}

}  // namespace saddleback
