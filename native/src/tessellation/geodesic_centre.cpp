#include "saddleback/geodesic_centre.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "saddleback/error.h"
#include "saddleback/polar_coordinates.h"

#include "tessellation/tangent_moves.h"

namespace saddleback {
namespace {

// A step is done when it is this short, relative to the spread of the points.
constexpr double k_tolerance = 1e-9;
// Positive curvature makes steps fall short by less than a half where a centre is unique; far fewer are made.
constexpr int k_most_steps = 100;

std::vector<double> checked_weights(std::span<const double> weights, std::size_t count) {
  if (weights.empty()) return std::vector<double>(count, 1.0);
  if (weights.size() != count)
    throw InputError(message("weights: wanted one for each of the ", count, " points, got ", weights.size()));
  const auto bad = std::ranges::find_if(weights, [](double w) { return !(w >= 0) || std::isinf(w); });
  if (bad != weights.end()) {
    throw InputError(
        message("weights: wanted finite numbers of 0 or more, got ", *bad, " for point ", bad - weights.begin()));
  }
  if (std::ranges::all_of(weights, [](double w) { return w == 0; })) throw InputError("weights: all are 0");
  return {weights.begin(), weights.end()};
}

/// Points with their logarithms about a centre that moves.
class Gathering {
 public:
  Gathering(const SaddleVertexGraph& graph, const SurfacePoints& points, std::vector<double> weights)
      : graph_(graph), mesh_(graph.mesh()), points_(points), weights_(std::move(weights)) {
    for (const SurfacePoint& point : points_) {
      const Triangle& t = mesh_.triangles()[point.face];
      corners_.insert(corners_.end(), t.begin(), t.end());
    }
    std::ranges::sort(corners_);
    corners_.erase(std::unique(corners_.begin(), corners_.end()), corners_.end());
  }

  /// The given point nearest in space to the weighted mean.
  SurfacePoint start() {
    Vec3 mean = Vec3::Zero();
    double sum = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      mean += weights_[i] * position(mesh_, points_[i]);
      sum += weights_[i];
    }
    mean /= sum;
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double distance = (position(mesh_, points_[i]) - mean).norm();
      if (distance < least) least = distance, best = i;
    }
    for (const SurfacePoint& point : points_)
      radius_ = std::max(radius_, 2 * (position(mesh_, point) - position(mesh_, points_[best])).norm());
    for (const SurfacePoint& point : points_)
      for (int i = 0; i < 3; ++i) radius_ = std::max(radius_, 2 * mesh_.length(3 * point.face + i));
    return points_[best];
  }

  /// Towards the centre, in the tangent plane of a place; and how far the farthest point is.
  Vec2 step_at(const SurfacePoint& place) {
    const LogMap map = log_of_corners(place);
    const auto log_of = [&](Index vertex) {
      return map.uv[std::ranges::lower_bound(map.vertices, vertex) - map.vertices.begin()];
    };
    Vec2 sum = Vec2::Zero();
    double mass = 0;
    spread_ = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Triangle& t = mesh_.triangles()[points_[i].face];
      const Vec3& b = points_[i].barycentric;
      const Vec2 log = b[0] * log_of(t[0]) + b[1] * log_of(t[1]) + b[2] * log_of(t[2]);
      spread_ = std::max(spread_, log.norm());
      sum += weights_[i] * log;
      mass += weights_[i];
    }
    return sum / mass;
  }
  double spread() const { return spread_; }

 private:
  /// Wider and wider, until the map holds every corner.
  LogMap log_of_corners(const SurfacePoint& place) {
    while (true) {
      LogMap map = log_map(graph_, place, radius_);
      if (std::ranges::includes(map.vertices, corners_)) return map;
      radius_ *= 1.5;
    }
  }

  const SaddleVertexGraph& graph_;
  const Mesh& mesh_;
  const SurfacePoints& points_;
  const std::vector<double> weights_;
  std::vector<Index> corners_;
  double radius_ = 0, spread_ = 0;
};

void check_points(const Mesh& mesh, const SurfacePoints& points) {
  if (points.empty()) throw InputError("points: wanted at least one, got none");
  check_surface_points(mesh, points, "points");
  const auto component = [&](const SurfacePoint& point) { return mesh.component_of(mesh.triangles()[point.face][0]); };
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (component(points[i]) != component(points[0]))
      throw InputError(message("points: 0 and ", i, " lie on separate parts of the mesh, between which no way leads"));
  }
}

}  // namespace

SurfacePoint geodesic_centre(const SaddleVertexGraph& graph, const SurfacePoints& points,
                             std::span<const double> weights, Job* job) {
  const Mesh& mesh = graph.mesh();
  check_points(mesh, points);
  Gathering gathering(graph, points, checked_weights(weights, points.size()));
  const JobStage stage(job, "Finding a centre");
  SurfacePoint centre = gathering.start();
  for (int i = 0; i < k_most_steps; ++i) {
    stage.update(1 - 1.0 / (i + 1));
    const Vec2 step = gathering.step_at(centre);
    if (step.norm() <= k_tolerance * gathering.spread()) break;
    centre = move_sites(mesh, {centre}, {step}, 1).sites.front();
  }
  stage.update(1);
  return centre;
}

}  // namespace saddleback
