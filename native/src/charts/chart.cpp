#include "saddleback/charts/chart.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saddleback/error.h"

#include "charts/turn.h"
#include "support/box_tree.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

using charts::turn;
using predicates::Sign;

double twice_area(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Two triangles are apart if and only if the line of one of their sides parts them (exact). Otherwise tells how deep
/// the one is in the other, along the side where that is least.
double overlap(const Vec2* a, const Vec2* b) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [mine, other] : {std::pair(a, b), std::pair(b, a)}) {
    for (int i = 0; i < 3; ++i) {
      const Vec2 &p = mine[i], &q = mine[(i + 1) % 3];
      const auto is_beyond = [&](const Vec2& v) { return turn(p, q, v) != Sign::positive; };
      if (std::all_of(other, other + 3, is_beyond)) return 0;
      double depth = 0;
      for (int k = 0; k < 3; ++k) depth = std::max(depth, twice_area(p, q, other[k]));
      least = std::min(least, depth / (q - p).norm());
    }
  }
  return least;
}

std::vector<Vec2> as_corners(const Mesh& mesh, std::span<const Vec2> uv) {
  const auto count = static_cast<Index>(uv.size());
  if (count == mesh.halfedge_count()) return {uv.begin(), uv.end()};
  if (count != mesh.vertex_count())
    throw InputError(message("uv: wanted one place for each of the ", mesh.vertex_count(), " vertices or the ",
                             mesh.halfedge_count(), " corners of faces, got ", count));
  std::vector<Vec2> corners(mesh.halfedge_count());
  for (Index h = 0; h < mesh.halfedge_count(); ++h) corners[h] = uv[mesh.from(h)];
  return corners;
}

}  // namespace

struct Chart::Finder {
  Finder(const std::vector<Box<Vec2>>& boxes, const JobStage& stage) : tree(boxes, stage) {}
  BoxTree<Vec2> tree;
};

Chart::Chart(const Mesh& mesh, std::span<const Vec2> uv, Job* job) : mesh_(&mesh), corners_(as_corners(mesh, uv)) {
  const JobStage stage(job, "Checking the map");
  check_faces(stage);
  std::vector<Box<Vec2>> boxes;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const Vec2 *corner = &corners_[3 * f], &a = corner[0], &b = corner[1], &c = corner[2];
    boxes.push_back({a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)});
    area_ += 0.5 * twice_area(a, b, c);
  }
  stage.update(0.1);
  finder_ = std::make_unique<Finder>(boxes, stage);
  check_overlaps(stage.part(0.3, 1));
}

Chart::~Chart() = default;
Chart::Chart(Chart&&) noexcept = default;
Chart& Chart::operator=(Chart&&) noexcept = default;

void Chart::check_faces(const JobStage& stage) const {
  for (Index h = 0; h < mesh_->halfedge_count(); ++h)
    if (!(corners_[h].array().abs() <= 1e60).all())  // products of four stay among the doubles
      throw InputError(message("uv: corner ", h % 3, " of face ", h / 3, " is at (", corners_[h].x(), ", ",
                               corners_[h].y(), "), wanted numbers up to 1e60"));
  for (Index f = 0; f < mesh_->face_count(); ++f) {
    stage.check();
    const Sign sign = turn(corners_[3 * f], corners_[3 * f + 1], corners_[3 * f + 2]);
    if (sign != Sign::positive)
      throw InputError(message("uv: face ", f,
                               sign == Sign::zero ? " has no area in the map" : " is flipped in the map",
                               "; unwrap the surface again"));
  }
}

void Chart::check_overlaps(const JobStage& stage) const {
  double largest = 0;
  for (const Vec2& place : corners_) largest = std::max(largest, place.cwiseAbs().maxCoeff());
  const double rounding = k_rounding * largest;
  std::vector<Index> other(mesh_->face_count(), std::numeric_limits<Index>::max());
  constexpr Index k_block = 512;
  parallel_for(mesh_->face_count(), 0, k_block, [&](Index f, int) {
    if (f % k_block == 0) stage.check();
    const Vec2 *corner = &corners_[3 * f], &a = corner[0], &b = corner[1], &c = corner[2];
    finder_->tree.visit({a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)}, [&](Index g) {
      if (g > f && g < other[f] && overlap(corner, &corners_[3 * g]) > rounding) other[f] = g;
    });
  });
  for (Index f = 0; f < mesh_->face_count(); ++f)
    if (other[f] != std::numeric_limits<Index>::max())
      throw InputError(message("uv: faces ", f, " and ", other[f], " overlap in the map; unwrap the surface again, ",
                               "each part of it at a place of its own"));
  stage.update(1);
}

SurfacePoint point_at(const Chart& chart, Index face, const Vec2& place) {
  const Vec2* corner = &chart.corners()[3 * face];
  Vec3 barycentric;
  for (int i = 0; i < 3; ++i) barycentric[i] = twice_area(place, corner[(i + 1) % 3], corner[(i + 2) % 3]);
  const double sum = barycentric.cwiseMax(0).sum();
  if (!(sum > 0)) return {face, Vec3::Constant(1.0 / 3)};
  return {face, normalized_barycentric(barycentric / sum)};
}

SurfacePoints Chart::locate(std::span<const Vec2> places, int threads, Job* job) const {
  for (std::size_t i = 0; i < places.size(); ++i)
    if (!places[i].allFinite())
      throw InputError(message("places: coordinates of place ", i, " are ", places[i].x(), ", ", places[i].y(),
                               ", wanted finite numbers"));
  const JobStage stage(job, "Finding faces");
  SurfacePoints points(places.size());
  constexpr Index k_block = 1024;
  parallel_for(static_cast<Index>(places.size()), threads, k_block, [&](Index i, int) {
    if (i % k_block == 0) stage.check();
    const Vec2& place = places[i];
    Index found = std::numeric_limits<Index>::max();
    finder_->tree.visit({place, place}, [&](Index f) {
      const Vec2* corner = &corners_[3 * f];
      if (f > found) return;
      for (int k = 0; k < 3; ++k)
        if (turn(corner[k], corner[(k + 1) % 3], place) == Sign::negative) return;
      found = f;
    });
    points[i] =
        found == std::numeric_limits<Index>::max() ? SurfacePoint{k_none, Vec3::Zero()} : point_at(*this, found, place);
  });
  stage.update(1);
  return points;
}

std::vector<Vec2> Chart::places(const SurfacePoints& points) const {
  check_surface_points(*mesh_, points, "points");
  std::vector<Vec2> result;
  result.reserve(points.size());
  for (const SurfacePoint& point : points) {
    const Vec2* corner = &corners_[3 * point.face];
    const Vec3& b = point.barycentric;
    result.push_back(b[0] * corner[0] + b[1] * corner[1] + b[2] * corner[2]);
  }
  return result;
}

}  // namespace saddleback
