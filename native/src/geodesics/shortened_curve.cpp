#include "saddleback/geodesics/shortened_curve.h"

#include <vector>

#include "geodesics/unfolding/chain_points.h"
#include "geodesics/unfolding/face_strip.h"
#include "geodesics/unfolding/loop_shortening.h"
#include "geodesics/unfolding/path_shortening.h"

namespace saddleback {
namespace {

/// Appends the half-edges entered about a vertex from a face to another one, on the way over fewer faces. Both ways are
/// of one class, and at the boundary one of them leads there.
void append_about(const Mesh& mesh, Index vertex, Index from, Index to, std::vector<Index>& entered) {
  std::vector<Index> left, right;
  Index at_left = leaving(mesh, vertex, from), at_right = at_left;
  for (;;) {
    if (at_left != k_none) {
      at_left = mesh.rotate(at_left);
      left.push_back(at_left);
      if (at_left != k_none && Mesh::face_of(at_left) == to)
        return void(entered.insert(entered.end(), left.begin(), left.end()));
    }
    if (at_right != k_none) {
      right.push_back(mesh.twin(at_right));
      at_right = right.back() == k_none ? k_none : Mesh::next(right.back());
      if (at_right != k_none && Mesh::face_of(at_right) == to)
        return void(entered.insert(entered.end(), right.begin(), right.end()));
    }
  }
}

/// Appends the half-edges entered where a curve goes from a face to another one at a point of both.
void append_between(const Mesh& mesh, const SurfacePoint& point, Index from, Index to, std::vector<Index>& entered) {
  if (from == to) return;
  const Vec3 b = *barycentric_in(mesh, point, from, k_barycentric_tolerance);
  for (int i = 0; i < 3; ++i) {
    const Index twin = mesh.twin(3 * from + i);
    if (twin == k_none || Mesh::face_of(twin) != to || b[(i + 2) % 3] > k_barycentric_tolerance) continue;
    entered.push_back(twin);
    return;
  }
  Index corner = 0;
  b.maxCoeff(&corner);
  append_about(mesh, mesh.triangles()[from][corner], from, to, entered);
}

/// Returns the half-edges that a curve enters; an open one on its way from the face of its first point to that of its
/// last.
std::vector<Index> strip_of(const SurfaceCurve& curve) {
  const Mesh& mesh = curve.mesh();
  const SurfacePoints& points = curve.points();
  const std::size_t count = points.size(), pieces = curve.closed() ? count : count - 1;
  std::vector<Index> faces;
  for (std::size_t i = 0; i < pieces; ++i) {
    faces.push_back(shared_face(mesh, points[i], points[(i + 1) % count], k_barycentric_tolerance));
  }
  std::vector<Index> entered;
  if (!curve.closed()) append_between(mesh, points.front(), points.front().face, faces.front(), entered);
  for (std::size_t i = 1; i < pieces; ++i) append_between(mesh, points[i], faces[i - 1], faces[i], entered);
  append_between(mesh, points[pieces % count], faces.back(), curve.closed() ? faces.front() : points.back().face,
                 entered);
  return entered;
}

}  // namespace

GeodesicPath shortened_curve(const SurfaceCurve& curve, Job* job) {
  const Mesh& mesh = curve.mesh();
  const JobStage stage(job, "Tightening a curve");
  const Unfolding unfolding(mesh);
  const std::vector<Index> strip = strip_of(curve);
  LegChain chain;
  GeodesicPath path;
  if (curve.closed()) {
    const SurfacePoint& first = curve.points().front();
    if (LoopShortener(unfolding, stage).shorten(strip, chain) == LoopShortener::Result::point)
      return {{position(mesh, first)}, {first}, 0};
    append_points(mesh, chain, path.points, path.surface);
    path.points.pop_back();
    path.surface.pop_back();
  } else {
    PathShortener shortener(unfolding);
    shortener.lay_along(leg_end(mesh, curve.points().front()), leg_end(mesh, curve.points().back()), strip, chain);
    shortener.shorten(chain, [&] { stage.check(); });
    append_points(mesh, chain, path.points, path.surface);
  }
  path.length = chain.length();
  stage.update(1);
  return path;
}

}  // namespace saddleback
